# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Laws that are not credible whatever they fit."""

from __future__ import annotations


from concealed_worlds import nominal, physics, prepared_from, recorded
from contact_estimation.diagnosis.fit.credible import is_credible
from contact_estimation.diagnosis.fit.fitting import Fit, fit
from contact_estimation.diagnosis.observe.prepared_recording import PreparedRecording
from contact_estimation.diagnosis.observe.signals import Signals
import numpy as np
from numpy.typing import NDArray
import pytest

Array = NDArray[np.float64]

SPRING = nominal(environment__stiffness=1000.0, environment__damping=20.0,
                 environment__unilateral=False)
T = np.arange(3000) / 200.0
TO_AND_FRO = 0.005 * np.sin(1.9 * T) + 0.004 * np.sin(4.4 * T)


def specimen(x: Array, stray: Array | float) -> Signals:
    """Record an attached specimen whose force also strays [N]."""
    force = 1000.0 * x + 5.0 * np.gradient(x, T) + stray
    noise = np.random.default_rng(4).normal(0.0, 0.01, len(T))
    return Signals(T, noise - force, T, x, np.empty(0), np.empty((4, 0)))


def prepared(signals: Signals) -> tuple[PreparedRecording, Fit]:
    """Recalibrate the spring."""
    recording, model = prepared_from(signals, SPRING)
    return recording, fit([recording], model)


@pytest.mark.parametrize('frequency, credible', [
    (0.06, False), (0.07, True), (24.0, True), (26.0, False)])
def test_a_resonance_needs_one_period_and_eight_samples_in_it(
    frequency: float, credible: bool
) -> None:
    recording, found = prepared(specimen(TO_AND_FRO, 0.0))
    model = found.model.with_effect('environment_resonance', (0.1, frequency, 0.05))
    assert is_credible([recording], model) is credible


@pytest.mark.parametrize('effect, values, credible', [
    ('free_play', (0.002, 0.0005, 1.0), True),
    ('free_play', (0.002, -0.0095, 1.0), False),
    ('free_play', (161.0, -80.0, 1.0), False),
    ('bilinear_stiffness', (500.0, 0.003), True),
    ('bilinear_stiffness', (500.0, 0.03), False),
])
def test_the_motion_passes_every_depth_at_which_a_law_bends(
    effect: str, values: tuple[float, ...], credible: bool
) -> None:
    recording, model = prepared_from(recorded(environment__unilateral=False),
                                     nominal(environment__unilateral=False))
    least, most = np.quantile(recording.observed.x, (0.01, 0.99))
    assert -0.0105 < least < -0.001 and 0.004 < most < 0.03
    assert is_credible([recording], model.with_effect(effect, values)) is credible


@pytest.mark.parametrize('name, values, clips', [
    ('force_saturation', (25.0,), True), ('bilinear_stiffness', (-4500.0, 0.003), False)])
def test_a_saturating_sensor_leaves_the_force_level_and_a_soft_wall_does_not(
    name: str, values: tuple[float, ...], clips: bool
) -> None:
    recording, model = prepared_from(recorded(**physics(name, *values)))
    base = fit([recording], model)
    found = fit([recording], base.model.with_effect('force_saturation', (25.0,)))
    assert is_credible([recording], found.model) is clips
