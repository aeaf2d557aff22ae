# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""A sensor that is not tared hides no law behind its bias."""

from __future__ import annotations

from functools import lru_cache

from concealed_worlds import diagnosed, nominal
from contact_estimation.diagnosis.conclude.result import Diagnosis
from contact_estimation.diagnosis.observe.signals import Signals
import numpy as np
import pytest

BIAS, F_C, B_E, PERIOD = 250.0, 6.0, 600.0, 5.0
LAW = 'coulomb_friction'


@lru_cache(maxsize=None)
def piston(bias: float) -> Diagnosis:
    """Push a piston to and fro: a damper that rubs, with a trifle that no law has."""
    t = np.arange(0.0, 60.0, 0.02)
    x = 0.01 * np.sin(2.0 * np.pi * t / PERIOD) + 0.004 * np.sin(2.0 * np.pi * t / 3.7)
    v = np.gradient(x, t)
    force = bias - B_E * v - F_C * np.tanh(v / 1e-4) + 0.8 * np.sin(900.0 * x)
    noise = np.random.default_rng(3).normal(0.0, 0.02, len(t))
    return diagnosed(
        Signals(t, force + noise, t, x, t[:0], np.empty((4, 0))),
        nominal(environment__unilateral=False, environment__stiffness=1000.0,
                environment__damping=B_E))


def test_friction_is_named_tared_or_not() -> None:
    tared, untared = piston(0.0), piston(BIAS)
    assert [one.name for one in tared.effects] == [LAW]
    assert [one.name for one in untared.effects] == ['force_bias', LAW]
    assert untared.effects[0].parameters['bias'].value == pytest.approx(BIAS, rel=0.01)
    for found in (tared, untared):
        assert found.effects[-1].parameters['F_c'].value == pytest.approx(F_C, rel=0.05)
