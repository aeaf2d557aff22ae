# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Repeated values, rounding and order decide nothing that a diagnosis says."""

from __future__ import annotations

from typing import Any, NamedTuple

from concealed_worlds import diagnosed, nominal, recorded
from contact_estimation.diagnosis.diagnose import diagnose
from contact_estimation.diagnosis.fit.evidence import ranked
from contact_estimation.diagnosis.observe.signals import Recording, Signals
from contact_estimation.diagnosis.observe.usable_samples import updates
from contact_estimation.exceptions import ContactEstimationError, RecordingError
from contact_estimation.physics import EFFECTS
import numpy as np
from numpy.typing import NDArray
import pytest

ATTACHED = nominal(environment__unilateral=False, environment__stiffness=60.0,
                   environment__damping=20.0)


class Scored(NamedTuple):
    """A candidate with its score."""

    name: str
    score: float


def score_of(one: Scored) -> float:
    return one.score


def names(*given: tuple[str, float]) -> list[str]:
    return [one.name for one in ranked((Scored(*each) for each in given), score_of)]


def test_of_equal_scores_the_zero_of_the_sensor_goes_before_that_of_the_surface() -> None:
    for score in (1e-30, 0.2, 1e6):
        given = ('contact_offset', score), ('force_bias', score * (1.0 - 1e-9))
        assert names(*given) == names(*reversed(given)) == ['force_bias', 'contact_offset'], score


def test_of_equal_scores_fewest_parameters_go_first_then_the_order_of_effects() -> None:
    order = ['force_bias', 'coulomb_friction', 'force_gain', 'presliding_friction']
    assert names(*((name, 1.0) for name in sorted(order, reverse=True))) == order
    assert len(set(names(*((name, 1.0) for name in EFFECTS)))) == len(EFFECTS)


def told(perturbation: float) -> list[tuple[str, list[str], float]]:
    """Diagnose a biased sensor on an attached wall, pushed one way, with data rounded anew."""
    t, draw = np.arange(0.0, 30.0, 0.02), np.random.default_rng(5)
    x = 0.1 * t / 30.0 + 0.002 * np.sin(t)
    force = -60.0 * x - 20.0 * np.gradient(x, t) - 12.0 + draw.normal(0.0, 0.05, len(t))
    x, force = (each * (1.0 + perturbation * draw.uniform(-1.0, 1.0, len(t)))
                for each in (x, force))
    found = diagnose(Recording('', Signals(t, force, t, x, t[:0], np.empty((4, 0)))), ATTACHED)
    return [(one.name, one.indistinguishable_from, round(one.probability, 2))
            for one in found.effects]


@pytest.mark.slow
def test_rounding_of_the_data_changes_neither_names_nor_their_order() -> None:
    first = told(0.0)
    assert [name for name, _, _ in first] == ['force_bias']
    assert told(2e-12) == told(3e-12) == first


Array = NDArray[np.float64]


def held(values: Array, count: int) -> Array:
    """Repeat every so manieth value until the next."""
    return np.repeat(values[::count], count)[:len(values)]


@pytest.mark.parametrize('count', [2, 3, 10])
def test_of_repeated_values_the_first_is_kept(count: int) -> None:
    long = np.cumsum(np.random.default_rng(0).uniform(0.5, 1.5, 100 * count))
    assert updates(held(long, count)).tolist() == list(range(0, len(long), count))


def changed(**rows: Any) -> Signals:
    """Change some of a recording's signals."""
    return recorded()._replace(**rows)


def refused(signals: Signals, match: str) -> None:
    """Require an error with a text."""
    with pytest.raises(RecordingError, match=match):
        diagnosed(signals)


@pytest.mark.slow
def test_constant_force_is_refused() -> None:
    refused(changed(force=np.full(1825, -3.0)), 'wrench is constant at -3.*topic, axis')


@pytest.mark.parametrize('row', ['force', 'position'])
@pytest.mark.parametrize('value', [np.nan, np.inf])
def test_signals_that_are_no_numbers_are_refused(row: str, value: float) -> None:
    values: Array = getattr(recorded(), row).copy()
    values[700] = value
    with pytest.raises(ContactEstimationError, match='finite'):
        diagnosed(changed(**{row: values}))
