# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Parameters: declared once, read from files, generated as configuration, and launched."""

from dataclasses import dataclass
from math import inf, nan
from pathlib import Path
import re
import runpy
import sys
from typing import Any
from unittest.mock import MagicMock

from contact_estimation.commands.write_config import config_files
from contact_estimation.exceptions import (
    ParameterRangeError, ParameterReadOnlyError, UnknownNameError)
from contact_estimation.parameter_files import read_parameter_file
from contact_estimation.parameters import (
    build, changed, flatten, group, parameter, ParameterGroup, specifications, without)
from contact_estimation.pipeline.parameters import EstimationParameters
from contact_estimation.plant.plant_parameters import PlantNodeParameters, PlantParameters
import numpy as np
import pytest

ROOTS = pytest.mark.parametrize('cls', [EstimationParameters, PlantParameters])


@dataclass(frozen=True)
class Inner(ParameterGroup):
    """A group within a group."""

    gain: float = parameter(2.0, 'A gain', 'N/m', minimum=0.0, maximum=10.0)
    optional: float = parameter(nan, 'A feature', 'N', minimum=0.0, nan_is_off=True)


@dataclass(frozen=True)
class Outer(ParameterGroup):
    """A group with every kind of parameter."""

    mode: str = parameter('slow', 'How', choices=('slow', 'fast'))
    label: str = parameter('', 'Any text')
    count: int = parameter(3, 'How many', minimum=1)
    on: bool = parameter(False, 'Whether')
    fixed: float = parameter(5.0, 'Fixed at start', read_only=True)
    place: tuple[float, ...] = parameter(
        (0.0, 0.0, 1.0), 'A vector', 'm', maximum=1.0, read_only=True)
    inner: Inner = group(Inner)


@ROOTS
def test_values_survive_the_dotted_names(cls: type[ParameterGroup]) -> None:
    values = cls()
    again = build(cls, flatten(values))
    assert repr(again) == repr(values)


def test_a_vector_is_any_sequence_of_as_many_numbers() -> None:
    for given in ([0, 1, '1e-1'], (0.0, 1.0, 0.1), np.array([0.0, 1.0, 0.1])):
        assert build(Outer, {'place': given}).place == (0.0, 1.0, 0.1)
    assert changed(Outer(), {'place': [0, 0, 1], 'count': 4}).count == 4


@pytest.mark.parametrize('given', [[0.0, 1.0], 'abc', 1.0, [0, 0, inf], [0, 0, 2], [0, 0, True]])
def test_a_vector_of_other_kind_is_refused(given: Any) -> None:
    with pytest.raises(ParameterRangeError, match=r'place must be 3 numbers <= 1 \[m\]'):
        build(Outer, {'place': given})


@ROOTS
def test_parameters_are_declared_once_with_a_meaning_and_a_valid_default(
    cls: type[ParameterGroup]
) -> None:
    names = [spec.name for spec in specifications(cls)]
    assert len(names) == len(set(names)) and names == list(flatten(cls()))
    for spec in specifications(cls):
        assert len(spec.description) > 2, spec.name
        assert repr(spec.check(spec.default)) == repr(spec.default), spec.name


@pytest.mark.parametrize('name, said', [
    ('cuont', "unknown parameter 'cuont'; did you mean 'count'"),
    ('inner.gian', "did you mean 'inner.gain'"), ('inner.optionl', "'inner.optional'"),
    ('innner.gain', "did you mean 'inner.gain'"), ('inner.gain.x', "did you mean 'inner.gain'"),
    ('inner.zzz', "'inner.zzz'; known in inner: gain, "),
    ('zzz.gain', 'known: count, fixed, inner, ')])
def test_unknown_name_suggests_the_nearest_or_lists_the_group_in_which_it_is_wrong(
    name: str, said: str
) -> None:
    with pytest.raises(UnknownNameError) as caught:
        build(Outer, {name: 1.0})
    assert said in str(caught.value)


def test_invalid_value_is_refused_with_what_was_expected() -> None:
    for name, value, expected in [
        ('inner.gain', -0.1, r'a number >= 0 and <= 10 \[N/m\]'),
        ('inner.gain', 10.1, r'a number >= 0 and <= 10 \[N/m\]'),
        ('inner.gain', nan, r'a number >= 0 and <= 10 \[N/m\]'),
        ('inner.gain', inf, r'a number >= 0 and <= 10 \[N/m\]'),
        ('inner.gain', 'two', 'a number'),
        ('inner.gain', True, 'a number'),
        ('inner.gain', None, 'a number'),
        ('inner.gain', [1.0], 'a number'),
        ('inner.optional', -1.0, r'a number >= 0 \[N\] or NaN \(off\)'),
        ('inner.optional', inf, r'a number >= 0 \[N\] or NaN \(off\)'),
        ('fixed', inf, 'a number'),
        ('count', 0, 'an integer >= 1'),
        ('count', 2.0, 'an integer'),
        ('count', True, 'an integer'),
        ('on', 1, 'true or false'),
        ('on', 'yes', 'true or false'),
        ('label', 3, 'text'),
        ('mode', 3, 'one of slow, fast'),
    ]:
        said = f'{name} must be {expected}.*, got .*default'
        with pytest.raises(ParameterRangeError, match=said):
            build(Outer, {name: value})


def test_read_only_parameter_cannot_change() -> None:
    with pytest.raises(ParameterReadOnlyError, match='fixed is fixed at start .5.0., got 6.0'):
        changed(Outer(), {'fixed': 6.0})


def test_axis_y_is_taken_as_meant_where_yaml_made_it_true() -> None:
    assert build(EstimationParameters, {'axis': True}).axis == 'y'


def test_number_that_yaml_left_a_text_is_taken_as_meant() -> None:
    given = build(EstimationParameters, {'tuning.kalman.stiffness_std': '1e5'})
    assert flatten(given)['tuning.kalman.stiffness_std'] == 1e5


CONFIG = Path(__file__).resolve().parent.parent / 'config'


@pytest.mark.parametrize('name', config_files())
def test_file_is_up_to_date(name: str) -> None:
    assert (CONFIG / name).read_text() == config_files()[name], (
        f'config/{name} is stale; run `python -m contact_estimation.commands.write_config` in the '
        'root of the repository to update')


def test_every_value_has_a_comment_with_meaning_unit_and_range() -> None:
    text = config_files()['estimator_node.yaml']
    assert (
        '    # Nominal rate of the wrench, for which filters and relations are designed [Hz]; '
        '1 to 100000\n    sample_rate: 500.0\n') in text
    for file in config_files().values():
        lines = file.splitlines()
        for before, line in zip(lines, lines[1:]):
            if re.match(r' +\w+: .', line):
                assert before.lstrip().startswith('#'), line


def test_plant_file_is_the_paper_s_world() -> None:
    values = read_parameter_file(CONFIG / 'plant_node.yaml', 'plant_node')
    plant = build(PlantParameters, without(PlantNodeParameters, values))
    noise = {'force_noise': 1.0, 'distribution': 'uniform'}
    expected = build(PlantParameters, {f'sensors.{k}': v for k, v in noise.items()})
    assert repr(plant) == repr(expected)


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
