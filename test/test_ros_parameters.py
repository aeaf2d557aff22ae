# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The parameter services of the running node, over all parameters that the dataclasses have."""

from math import isfinite, isnan, nan
from typing import Any, Iterator

from contact_estimation.parameters import ParameterSpecification, specifications
from contact_estimation.pipeline.parameters import EstimationParameters
from contact_estimation.ros.estimator_node_parameters import EstimatorNodeParameters
from effect_examples import switched_on
import pytest
from ros_peer import estimator_and_peer, Peer

pytestmark = pytest.mark.slow

SPECIFICATIONS = [*specifications(EstimationParameters), *specifications(EstimatorNodeParameters)]
# Tool and target pose need an arm: see test_ros_arm.py.
CHANGEABLE = [spec for spec in SPECIFICATIONS if not spec.read_only
              and not spec.name.startswith(('tool.', 'publish_target_pose'))]
LOWEST = {spec.name: spec.minimum for spec in CHANGEABLE if spec.minimum is not None}
HIGHEST = {spec.name: spec.maximum for spec in CHANGEABLE if spec.maximum is not None}
OFF = {spec.name for spec in SPECIFICATIONS if spec.nan_is_off}
DEFAULTS = {spec.name: spec.default for spec in SPECIFICATIONS}


def group_of(name: str) -> str:
    """Name the group of a parameter."""
    return name.rpartition('.')[0]


EFFECT_GROUPS = [group_of(spec.name) for spec in CHANGEABLE if spec.name.startswith('physics.')]
TOGETHER = sorted({group for group in EFFECT_GROUPS if EFFECT_GROUPS.count(group) > 1})
"""Effects that need several parameters, which cannot be set one by one."""


@pytest.fixture(scope='module')
def shared(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Peer]:
    yield from estimator_and_peer(tmp_path_factory.mktemp('parameters'))


def other_value(spec: ParameterSpecification) -> Any:
    """Pick a valid value that is not the default."""
    default = spec.default
    if spec.choices:
        return next(choice for choice in spec.choices if choice != default)
    if isinstance(default, str):
        return 'other'
    if isinstance(default, bool):
        return not default
    if isinstance(default, int):
        return default + 1
    if isinstance(default, tuple):
        return [value + 0.5 for value in default]
    return within(spec, 1.5 * default if isfinite(default) and default else 1e-3)


def within(spec: ParameterSpecification, value: float) -> float:
    """Bring a number into the range of its parameter."""
    low = value if spec.minimum is None else max(value, spec.minimum)
    return low if spec.maximum is None else min(low, spec.maximum)


def beyond(name: str, limit: float, step: float) -> Any:
    """Step over a limit, in the type of the parameter."""
    value = limit + step * max(1.0, abs(limit))
    return int(value) if isinstance(DEFAULTS[name], int) else value


def same(one: Any, other: Any) -> bool:
    """Compare values, NaN being equal to itself, and vectors whatever holds them."""
    if isinstance(other, (list, tuple)):
        return list(one) == list(other)
    return one == other or (isinstance(one, float) and isnan(one) and isnan(other))


def test_every_parameter_is_listed_with_its_description(peer: Peer) -> None:
    names = [spec.name for spec in SPECIFICATIONS]
    assert set(names) <= set(peer.names())
    for spec, descriptor in zip(SPECIFICATIONS, peer.describe(names)):
        assert descriptor.description.startswith(spec.description), spec.name
        assert descriptor.description.endswith(f'[{spec.unit}]' if spec.unit else '')
        assert descriptor.additional_constraints == spec.expectation
        assert descriptor.read_only == spec.read_only


def test_ranges_are_in_the_descriptors(peer: Peer) -> None:
    for descriptor in peer.describe(list(LOWEST)):
        ranges = [*descriptor.floating_point_range, *descriptor.integer_range]
        assert all(r.from_value == LOWEST[descriptor.name] for r in ranges)
        # rclpy's own check of a range would refuse NaN, which means off.
        assert len(ranges) == (0 if descriptor.name in OFF else 1), descriptor.name


def test_every_changeable_parameter_takes_another_value(peer: Peer) -> None:
    for spec in CHANGEABLE:
        if group_of(spec.name) in TOGETHER:
            continue
        value = other_value(spec)
        results = peer.set({spec.name: value})
        assert results[0].successful, f'{spec.name} = {value!r}: {results[0].reason}'
        assert same(peer.get([spec.name])[spec.name], value)
        default = list(spec.default) if isinstance(spec.default, tuple) else spec.default
        assert peer.set({spec.name: default})[0].successful


def test_effect_of_several_parameters_is_switched_on_and_off_at_once(peer: Peer) -> None:
    for group in TOGETHER:
        values = switched_on(group.split('.')[1])
        *_, one = values.items()  # the last: a yield depth is 0 if not given
        assert 'needs all of' in peer.set(dict([one]))[0].reason
        for wanted in (values, dict.fromkeys(values, nan)):
            result = peer.set_together(wanted)
            assert result.successful, f'{group}: {result.reason}'
            assert all(same(v, wanted[n]) for n, v in peer.get(list(wanted)).items())


def test_read_only_parameters_refuse(peer: Peer) -> None:
    fixed = [spec for spec in SPECIFICATIONS if spec.read_only]
    assert fixed
    for spec in fixed:
        result = peer.set({spec.name: other_value(spec)})[0]
        assert not result.successful
        assert 'read-only' in result.reason
        assert same(peer.get([spec.name])[spec.name], spec.default)


@pytest.mark.parametrize('limits, step', [(LOWEST, -1.0), (HIGHEST, 1.0)])
def test_values_out_of_range_are_refused_by_name(
    peer: Peer, limits: dict[str, float], step: float
) -> None:
    values = {name: beyond(name, limit, step) for name, limit in limits.items()}
    for name, result in zip(values, peer.set(values)):
        assert not result.successful, name
        assert name in result.reason


def test_refused_change_leaves_the_estimation_as_it_was(peer: Peer) -> None:
    peer.change(estimator='kalman', environment__initial_stiffness=2000.0)
    refused = {'estimator': 'nonsense', 'environment.initial_stiffness': -1.0}
    assert not any(result.successful for result in peer.set(refused))
    assert peer.get(list(refused)) == {
        'estimator': 'kalman', 'environment.initial_stiffness': 2000.0,
    }
    peer.diagnosed(lambda _, values: values['estimator'] == 'kalman', 'the estimator in use')
