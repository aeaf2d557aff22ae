# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Values that are published more often than they are measured."""

from __future__ import annotations

from concealed_worlds import diagnosed, nominal
from contact_estimation.diagnosis.observe.signals import Signals
from contact_estimation.diagnosis.observe.usable_samples import updates
import numpy as np
from numpy.typing import NDArray
import pytest

Array = NDArray[np.float64]

MOTION: Array = np.cumsum(np.random.default_rng(0).uniform(0.5, 1.5, 300))


def held(values: Array, count: int) -> Array:
    """Repeat every so manieth value until the next."""
    return np.repeat(values[::count], count)[:len(values)]


@pytest.mark.parametrize('count', [2, 3, 10])
def test_of_repeated_values_the_first_is_kept(count: int) -> None:
    long = np.cumsum(np.random.default_rng(0).uniform(0.5, 1.5, 100 * count))
    assert updates(held(long, count)).tolist() == list(range(0, len(long), count))


@pytest.mark.parametrize('values', [
    MOTION, np.repeat(MOTION, np.random.default_rng(2).integers(1, 30, len(MOTION))),
    np.floor(np.linspace(0.0, 60.0, 300)), np.zeros(300),
], ids=['every value new', 'irregular', 'rounded', 'constant'])
def test_other_signals_keep_all_samples(values: Array) -> None:
    assert len(updates(values)) == len(values)


def joint(count: int) -> Signals:
    """Record a joint with dry friction whose position is published several times."""
    t = np.arange(6000) / 500.0
    v = 1.2 * np.cos(1.9 * t)
    random = np.random.default_rng(3)
    force = -(8.0 * v + 12.0 * np.tanh(v / 0.01)) + random.normal(0.0, 0.3, len(t))
    x = 1.2 / 1.9 * np.sin(1.9 * t) + random.normal(0.0, 1e-5, len(t))
    return Signals(t, force, t, held(x, count), np.empty(0), np.empty((4, 0)))


def test_friction_is_named_though_positions_are_repeated() -> None:
    drive = nominal(environment__stiffness=0.0, environment__damping=20.0,
                    environment__inertia=0.5, environment__unilateral=False)
    found = diagnosed(joint(3), drive)
    assert [effect.family for effect in found.effects] == ['friction']
    assert found.effects[0].parameters['F_c'].value == pytest.approx(12.0, rel=0.05)
