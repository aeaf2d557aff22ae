# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Starting wrongly ends with exit code 1 and one line on stderr; --help explains."""

from pathlib import Path
from typing import Any

from contact_estimation.parameters import specifications
from contact_estimation.pipeline.parameters import EstimationParameters
import pytest
from ros_processes import Finished, parameter_arguments, run_executable

pytestmark = pytest.mark.slow

WRONG: list[tuple[str, dict[str, Any], list[str]]] = [
    ('estimator_node', {'conditioning.cutoff_frequenzy': 30.0},
     ["did you mean 'conditioning.cutoff_frequency'"]),
    ('plant_node', {'experiment': 'missing.yaml'}, ['missing.yaml', 'cannot be read']),
    ('recorder_node', {}, ['output']),
]


def assert_one_line(finished: Finished, *parts: str) -> None:
    """Check that a process has failed with one line and exit code 1."""
    assert 'Traceback' not in finished.stderr
    lines = finished.stderr.strip().splitlines()
    assert len(lines) == 1, finished.stderr
    assert all(part in lines[0] for part in parts), lines[0]
    assert finished.code == 1


@pytest.mark.parametrize('node, parameters, parts', WRONG, ids=[str(w[1]) for w in WRONG])
def test_wrong_parameter_ends_a_node_with_one_line(
    tmp_path: Path, node: str, parameters: dict[str, Any], parts: list[str]
) -> None:
    finished = run_executable(tmp_path, node, *parameter_arguments(parameters))
    assert_one_line(finished, *parts)


def test_unknown_parameter_in_a_file_names_the_nearest(tmp_path: Path) -> None:
    file = tmp_path / 'parameters.yaml'
    file.write_text('estimator_node: {ros__parameters: {tuning: {rls: {forgeting_factor: 0.9}}}}')
    finished = run_executable(tmp_path, 'estimator_node', '--ros-args', '--params-file', str(file))
    assert_one_line(finished, "did you mean 'tuning.rls.forgetting_factor'")


def test_help_of_the_estimator_node_lists_every_parameter(tmp_path: Path) -> None:
    finished = run_executable(tmp_path, 'estimator_node', '--help')
    assert (finished.code, finished.stderr) == (0, '')
    for spec in specifications(EstimationParameters):
        assert f'  {spec.name} = ' in finished.stdout
        assert spec.description in finished.stdout
    assert 'usage: estimator_node [--ros-args ' in finished.stdout
    assert '-r wrench:=/my/wrench' in finished.stdout


@pytest.mark.parametrize('node', ['plant_node', 'recorder_node'])
def test_help_of_a_node_succeeds(tmp_path: Path, node: str) -> None:
    finished = run_executable(tmp_path, node, '--help')
    assert (finished.code, finished.stderr) == (0, '')
    assert finished.stdout.startswith(f'{node}: ')
    assert f'usage: {node} [--ros-args ' in finished.stdout
    assert ('-r wrench:=' in finished.stdout) == (node == 'recorder_node')
