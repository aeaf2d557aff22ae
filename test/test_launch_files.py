# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""What the launch files give to the nodes; stand-ins for `launch`, which pip cannot install."""

from __future__ import annotations

from pathlib import Path
import runpy
import sys
from typing import Any
from unittest.mock import MagicMock

from contact_estimation.parameter_files import read_parameter_file
import pytest

LAUNCH = Path(__file__).resolve().parents[1] / 'launch/loop.launch.py'


@pytest.fixture
def loop(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Any:
    """Return a function that launches the loop and returns the parameters of a node."""
    modules = {name: MagicMock() for name in (
        'launch', 'launch.actions', 'launch.event_handlers', 'launch.events',
        'launch.substitutions', 'launch_ros', 'launch_ros.actions')}
    for name, module in modules.items():
        monkeypatch.setitem(sys.modules, name, module)
    monkeypatch.setattr('tempfile.tempdir', str(tmp_path))
    modules['launch.substitutions'].LaunchConfiguration = lambda name: MagicMock(
        perform=lambda context: context[name])

    def launched(node: str, **given: str) -> dict[str, Any]:
        launch = runpy.run_path(str(LAUNCH))
        arguments = launch['ARGUMENTS'].items()
        defaults = {name: facts.get('default_value') for name, facts in arguments}
        launch['nodes']({**defaults, 'output': str(tmp_path / 'bag'), **given})
        calls = modules['launch_ros.actions'].Node.call_args_list
        file, = next(call.kwargs['parameters'] for call in calls if call.kwargs['name'] == node)
        return read_parameter_file(file, node)

    return launched


@pytest.fixture
def params(tmp_path: Path) -> str:
    file = tmp_path / 'params.yaml'
    file.write_text(
        'estimator_node: {ros__parameters: {estimator: kalman, reference_law: series}}\n'
        'plant_node: {ros__parameters: {environment: {stiffness: 900.0}, seed: 5}}\n')
    return str(file)


def test_the_loop_gives_each_node_its_section_of_the_parameter_file(
    loop: Any, params: str
) -> None:
    estimator, plant = (loop(f'{name}_node', params=params) for name in ('estimator', 'plant'))
    assert (estimator['estimator'], estimator['reference_law']) == ('kalman', 'series')
    assert (plant['environment.stiffness'], plant['seed'], plant['subscribers']) == (900.0, 5, 2)


def test_arguments_that_are_given_override_the_parameter_file(loop: Any, params: str) -> None:
    given = {'params': params, 'estimator': 'rls', 'reference_law': 'eq20', 'seed': '7'}
    estimator = loop('estimator_node', **given)
    assert (estimator['estimator'], estimator['reference_law']) == ('rls', 'eq20')
    assert loop('plant_node', **given)['seed'] == 7


def test_wrong_arguments_end_the_launch_before_any_node_starts(loop: Any) -> None:
    with pytest.raises(RuntimeError, match="seed must be a number, got 'x'"):
        loop('plant_node', seed='x')
