# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""What one way, or one speed, tells of friction: it sticks before it slides, and no more."""

from __future__ import annotations

from functools import lru_cache

from concealed_worlds import nominal
from contact_estimation.diagnosis.conclude.diagnose import diagnose
from contact_estimation.diagnosis.conclude.result import Diagnosis
from contact_estimation.diagnosis.observe.signals import Recording, Signals
from contact_estimation.plant.plant_parameters import PlantParameters
import numpy as np
from numpy.typing import NDArray
import pytest

Array = NDArray[np.float64]

F_C, SIGMA, K_E, B_E = 12.0, 30000.0, 60.0, 20.0
T = np.arange(0.0, 30.0, 0.02)


def joint(stiffness: float = K_E) -> PlantParameters:
    """Describe a joint that is attached for good."""
    return nominal(environment__unilateral=False, environment__stiffness=stiffness,
                   environment__damping=B_E)


def signals(t: Array, x: Array, force: Array, noise: float = 0.05) -> Signals:
    """Measure a motion and the force of what is moved."""
    force = force + np.random.default_rng(5).normal(0.0, noise, len(t))
    return Signals(t, force, t, x, t[:0], np.empty((4, 0)))


def breaking_away() -> tuple[Array, Array]:
    """Push a joint that sticks, creeps and then slides, all one way, at several speeds."""
    x = np.asarray(np.interp(T, [0.0, 6.0, 12.0, 20.0, 26.0, 30.0],
                             [0.0, 4e-4, 1.2e-3, 0.03, 0.045, 0.1]))
    friction = F_C * (1.0 - np.exp(-SIGMA * x / F_C))
    return x, -K_E * x - B_E * np.gradient(x, T) - friction


@lru_cache(maxsize=None)
def diagnosed(kind: str) -> Diagnosis:
    """Diagnose a joint that breaks away, or one whose sensor has a bias alone."""
    x, force = breaking_away()
    if kind == 'biased':
        x = np.asarray(0.1 * T / 30.0 + 0.002 * np.sin(T))
        force = -K_E * x - B_E * np.gradient(x, T) - F_C
    return diagnose(Recording(f'{kind}.mcap', signals(T, x, force)), joint())


def test_one_way_tells_no_friction_from_a_bias() -> None:
    found = diagnosed('biased')
    first = found.effects[0]
    assert first.name == 'force_bias'
    assert 'coulomb_friction' in first.indistinguishable_from or 'friction' in dict(found.untried)


@pytest.mark.parametrize('speeds', [(1.0, 1.0), (1.0, 2.0)])
def test_a_damper_at_one_speed_is_no_dry_friction(speeds: tuple[float, float]) -> None:
    first, second = (0.01 * speed * np.abs((np.arange(0.0, 15.0, 0.02) / 3.0) % 2.0 - 1.0)
                     for speed in speeds)
    x = np.concatenate((first, second))
    recorded = signals(T, x, -900.0 * np.gradient(x, T))
    found = diagnose(Recording('damper.mcap', recorded), nominal(
        environment__unilateral=False, environment__stiffness=0.0, environment__damping=800.0))
    assert found.effects == [] and found.verdict == 'recalibrate'
