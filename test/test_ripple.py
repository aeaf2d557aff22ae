# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""A drive whose encoder has an error that repeats with the angle."""

from __future__ import annotations

from functools import lru_cache

from concealed_worlds import diagnosed, named, nominal
from contact_estimation.diagnosis.observe.signals import Signals
import numpy as np
import pytest

MASS, DRAG, DRY, RATE = 0.085, 0.05, 0.5, 500
LINEAR = nominal(environment__stiffness=0.0, environment__damping=0.12,
                 environment__inertia=0.12, environment__unilateral=False)


@lru_cache(maxsize=None)
def recorded(ripple: float) -> Signals:
    """Record a drive with dry friction; the error of its encoder is a sawtooth."""
    t = np.arange(24 * RATE) / RATE
    v = 16.0 * np.sin(0.9 * t) + 10.0 * np.sin(2.3 * t + 1.0)
    x = -16.0 / 0.9 * np.cos(0.9 * t) - 10.0 / 2.3 * np.cos(2.3 * t + 1.0)
    a = 14.4 * np.cos(0.9 * t) + 23.0 * np.cos(2.3 * t + 1.0)
    rng = np.random.default_rng(3)
    push = MASS * a + DRAG * v + DRY * np.tanh(v / 4e-4)
    force = -push + 0.3 * rng.normal(size=len(t))
    return Signals(t, force, t, x + ripple * (2.0 * x % 1.0 - 0.5), np.empty(0), np.empty((4, 0)))


@pytest.mark.slow
def test_friction_under_ripple_is_named() -> None:
    found = diagnosed(recorded(0.02), LINEAR)
    assert named(found) == ['coulomb_friction']
    assert found.effects[0].parameters['F_c'].value == pytest.approx(DRY, rel=0.05)
    assert found.damping.value == pytest.approx(DRAG, rel=0.1)
