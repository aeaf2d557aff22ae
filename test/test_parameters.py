# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Parameters: declared once, checked whenever they are made."""

from __future__ import annotations

from dataclasses import dataclass, FrozenInstanceError
from math import inf, isnan, nan
from typing import Any

from contact_estimation.exceptions import (
    ParameterRangeError, ParameterReadOnlyError, UnknownNameError)
from contact_estimation.parameters.specification import (
    group, of_valid, parameter, ParameterGroup, ParameterSpecification, specifications, value_text)
from contact_estimation.parameters.values import build, changed, flatten, flatten_mapping
from contact_estimation.pipeline.parameters import EstimationParameters
from contact_estimation.plant.plant_parameters import PlantParameters
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


def test_changed_values_survive_the_dotted_names() -> None:
    values = build(Outer, {'mode': 'fast', 'count': 7, 'inner.gain': 4.5, 'inner.optional': 1.0})
    assert build(Outer, flatten(values)) == values


def test_nested_mappings_become_dotted_names() -> None:
    flat = flatten_mapping({'mode': 'fast', 'inner': {'gain': 3.0}})
    assert flat == {'mode': 'fast', 'inner.gain': 3.0}


def test_a_vector_is_any_sequence_of_as_many_numbers() -> None:
    for given in ([0, 1, '1e-1'], (0.0, 1.0, 0.1), np.array([0.0, 1.0, 0.1])):
        assert build(Outer, {'place': given}).place == (0.0, 1.0, 0.1)
    assert changed(Outer(), {'place': [0, 0, 1], 'count': 4}).count == 4


@pytest.mark.parametrize('given', [[0.0, 1.0], 'abc', 1.0, [0, 0, inf], [0, 0, 2], [0, 0, True]])
def test_a_vector_of_other_kind_is_refused(given: Any) -> None:
    with pytest.raises(ParameterRangeError, match=r'place must be 3 numbers <= 1 \[m\]'):
        build(Outer, {'place': given})


@ROOTS
def test_names_are_declared_once(cls: type[ParameterGroup]) -> None:
    names = [spec.name for spec in specifications(cls)]
    assert len(names) == len(set(names)) and names == list(flatten(cls()))


@ROOTS
def test_every_parameter_says_what_it_means(cls: type[ParameterGroup]) -> None:
    assert not [spec.name for spec in specifications(cls) if len(spec.description) < 3]


@ROOTS
def test_every_default_is_valid(cls: type[ParameterGroup]) -> None:
    for spec in specifications(cls):
        value = spec.check(spec.default)
        assert repr(value) == repr(spec.default)


def test_missing_names_take_their_defaults() -> None:
    assert build(Outer, {'count': 9}).inner.gain == 2.0


def test_integer_is_taken_for_a_number() -> None:
    gain = build(Outer, {'inner.gain': 4}).inner.gain
    assert (gain, type(gain)) == (4.0, float)


@pytest.mark.parametrize('name, nearest', [
    ('inner.gian', 'inner.gain'), ('cuont', 'count'), ('inner.optionl', 'inner.optional'),
])
def test_unknown_name_suggests_the_nearest(name: str, nearest: str) -> None:
    with pytest.raises(UnknownNameError, match=f"unknown parameter '{name}'; .*'{nearest}'"):
        build(Outer, {name: 1.0})


@pytest.mark.parametrize('name, said', [
    ('inner.zzz', 'known in inner: gain, '), ('inner.gian', "did you mean 'inner.gain'"),
    ('innner.gain', "did you mean 'inner.gain'"), ('inner.gain.x', "did you mean 'inner.gain'"),
    ('inner.zzz', "'inner.zzz'; known"), ('zzz.gain', 'known: count, fixed, inner, '),
])
def test_unknown_dotted_name_is_told_the_group_in_which_it_is_wrong(
    name: str, said: str
) -> None:
    with pytest.raises(UnknownNameError) as caught:
        build(Outer, {name: 1.0})
    assert said in str(caught.value)


def test_unknown_name_lists_the_known_ones() -> None:
    with pytest.raises(UnknownNameError, match='known: count, fixed, inner.gain'):
        build(Outer, {'zzz': 1.0})


@pytest.mark.parametrize('name, value, expected', [
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
])
def test_invalid_value_is_refused_with_what_was_expected(
    name: str, value: Any, expected: str
) -> None:
    with pytest.raises(ParameterRangeError, match=f'{name} must be {expected}.*, got .*default'):
        build(Outer, {name: value})


@pytest.mark.parametrize('value, text', [
    (True, 'true'), (3, '3'), (1.0, '1.0'), (1e10, '1e10'), (1234567.5, '1234567.5'),
    (1e-6, '1e-6'), (nan, 'NaN'), ((0.0, 1e6, -0.5), '[0.0, 1e6, -0.5]'), ('off', "'off'"),
])
def test_default_is_shown_as_people_write_it(value: Any, text: str) -> None:
    assert value_text(value) == text


def test_limits_are_shown_with_short_exponents_and_without_the_unit_of_a_ratio() -> None:
    spec = ParameterSpecification('ratio', 0.5, 'a ratio', '1', 1e-6, 1e10)
    assert spec.expectation == 'a number >= 1e-6 and <= 1e10'
    assert spec.valid_range == '1e-6 to 1e10'


def test_unknown_choice_suggests_the_nearest() -> None:
    with pytest.raises(UnknownNameError, match="unknown mode 'fats'; did you mean 'fast'"):
        build(Outer, {'mode': 'fats'})


def test_choice_is_checked_in_the_constructor_too() -> None:
    with pytest.raises(UnknownNameError, match='known: fast, slow'):
        Outer(mode='medium')


def test_range_is_checked_in_the_constructor_too() -> None:
    with pytest.raises(ParameterRangeError, match='gain must be'):
        Inner(gain=-1.0)


def test_values_known_to_be_valid_make_an_equal_group() -> None:
    made = of_valid(Inner, (3.0, 1.5))
    assert made == Inner(gain=3.0, optional=1.5) and hash(made) == hash(Inner(3.0, 1.5))
    with pytest.raises(FrozenInstanceError):
        made.gain = 4.0  # type: ignore[misc]


def test_nan_means_off_where_it_is_allowed() -> None:
    assert isnan(build(Outer, {'inner.optional': nan}).inner.optional)


@pytest.mark.parametrize('value', [0.0, 10.0])
def test_ends_of_the_range_belong_to_it(value: float) -> None:
    assert build(Outer, {'inner.gain': value}).inner.gain == value


def test_values_cannot_be_set() -> None:
    with pytest.raises(FrozenInstanceError):
        Outer().count = 5  # type: ignore[misc]


def test_change_keeps_the_other_values() -> None:
    before = build(Outer, {'count': 7, 'inner.gain': 3.0})
    after = changed(before, {'inner.gain': 4.0})
    assert (after.count, after.inner.gain, before.inner.gain) == (7, 4.0, 3.0)


def test_read_only_parameter_cannot_change() -> None:
    with pytest.raises(ParameterReadOnlyError, match='fixed is fixed at start .5.0., got 6.0'):
        changed(Outer(), {'fixed': 6.0})


def test_read_only_parameter_may_be_given_as_it_is() -> None:
    assert changed(Outer(), {'fixed': 5.0, 'count': 4}).count == 4


def test_read_only_parameter_can_be_given_at_start() -> None:
    assert build(Outer, {'fixed': 6.0}).fixed == 6.0


def test_change_to_an_unknown_name_is_refused() -> None:
    with pytest.raises(UnknownNameError, match="did you mean 'count'"):
        changed(Outer(), {'counts': 1})


@pytest.mark.parametrize('cutoff', [250.0, 400.0])
def test_cutoff_must_fit_the_sample_rate(cutoff: float) -> None:
    with pytest.raises(ParameterRangeError, match='cutoff_frequency must be .* < half of sample'):
        build(EstimationParameters, {'conditioning.cutoff_frequency': cutoff})


def test_unknown_estimator_names_the_nearest() -> None:
    with pytest.raises(UnknownNameError, match="unknown estimator 'kalmann'; did you mean 'kalm"):
        build(EstimationParameters, {'estimator': 'kalmann'})


def test_axis_y_is_taken_as_meant_where_yaml_made_it_true() -> None:
    assert build(EstimationParameters, {'axis': True}).axis == 'y'


def test_number_that_yaml_left_a_text_is_taken_as_meant() -> None:
    given = build(EstimationParameters, {'tuning.kalman.stiffness_std': '1e5'})
    assert flatten(given)['tuning.kalman.stiffness_std'] == 1e5
