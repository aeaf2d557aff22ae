# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The frequency of a cyclic test, with which a wall does not move in step."""

from __future__ import annotations

from concealed_worlds import ATTACHED, nominal, prepared_from
from contact_estimation.diagnosis.fit.credible import may_show
from contact_estimation.diagnosis.observe.pace import cycle_frequency
from contact_estimation.diagnosis.observe.signals import Signals
import numpy as np
import pytest
from scipy.signal import sawtooth

T = np.arange(6000) / 500.0


@pytest.mark.parametrize('frequency', [0.4, 0.998, 3.17])
def test_cycle_of_a_triangular_motion_is_found(frequency: float) -> None:
    x = 0.003 * sawtooth(2.0 * np.pi * frequency * T + 0.7, 0.5) + 0.05
    assert cycle_frequency(T, x) == pytest.approx(frequency, abs=2e-3)


@pytest.mark.parametrize('frequency, shown', [(1.0, False), (2.0, False), (1.37, True)])
def test_a_wall_in_step_with_a_cyclic_test_is_none(frequency: float, shown: bool) -> None:
    x = 0.003 * np.sin(2.0 * np.pi * T)
    recording, model = prepared_from(
        Signals(T, -5000.0 * x, T, x, np.empty(0), np.empty((4, 0))),
        nominal(**{**ATTACHED, 'environment__inertia': 0.0}))
    moving = model.with_effect('moving_environment', (1e-4, frequency, 0.0))
    assert may_show([recording], moving, 'moving_environment') is shown
