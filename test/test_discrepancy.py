# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""What a channel counts as noise, and what beyond it as a discrepancy."""

from __future__ import annotations

from dataclasses import replace

from concealed_worlds import ATTACHED, nominal, physics, prepared_from, recorded
from contact_estimation.diagnosis.fit.discrepancy import (
    correlation_time,
    least_material,
    material,
    std_beyond_noise,
    with_discrepancy,
    without_discrepancy,
)
from contact_estimation.diagnosis.fit.fitting import fit, residual_function
from contact_estimation.diagnosis.observe.channel import Channel
from contact_estimation.diagnosis.observe.model import Model
from contact_estimation.diagnosis.observe.prepared_recording import PreparedRecording
from contact_estimation.diagnosis.observe.signals import Signals
from contact_estimation.plant.driven_wall import run_driven_wall
import numpy as np
from numpy.typing import NDArray
import pytest
from scipy.signal import lfilter

COUNT, NOISE, UNKNOWN = 24_000, 0.02, 0.5
T = np.arange(6000) / 250.0


def channel(spread: NDArray[np.float64], block: int, discrepancy: float = 0.0) -> Channel:
    """Make a channel of which a tenth of the samples do not count."""
    use = np.random.default_rng(2).random(COUNT) > 0.1
    return Channel(NOISE, spread, use, block, discrepancy)


def errors(spread: NDArray[np.float64], block: int, unknown: float) -> NDArray[np.float64]:
    """Draw noise, and a discrepancy that is the same throughout a block."""
    rng = np.random.default_rng(1)
    same = np.repeat(rng.normal(size=COUNT // block), block)
    return NOISE * spread * rng.normal(size=COUNT) + unknown * same


@pytest.mark.parametrize('block', [1, 8])
@pytest.mark.parametrize('widest', [1.0, 150.0])
@pytest.mark.parametrize('unknown', [0.0, UNKNOWN])
def test_residuals_have_variance_one(block: int, widest: float, unknown: float) -> None:
    spread = np.repeat(np.geomspace(1.0, widest, COUNT // block), block)
    found = channel(spread, block, unknown)
    left = found.average(errors(spread, block, unknown))[found.filled]
    assert np.mean(left**2) == pytest.approx(1.0, abs=0.06)


@pytest.mark.parametrize('block', [1, 8])
@pytest.mark.parametrize('widest', [1.0, 150.0])
def test_discrepancy_is_found_beside_noise_of_any_spread(block: int, widest: float) -> None:
    spread = np.repeat(np.geomspace(1.0, widest, COUNT // block), block)
    plain = channel(spread, block)
    assert std_beyond_noise(
        plain.average(errors(spread, block, UNKNOWN)), plain) == pytest.approx(UNKNOWN, rel=0.06)
    assert std_beyond_noise(
        plain.average(errors(spread, block, 0.0)), plain) < 0.3 * NOISE


def test_jitter_does_not_hide_samples_whose_error_is_not_noise() -> None:
    spread = np.where(np.arange(COUNT) % 2, 100.0, 1.0)  # noise of 2 and of 0.02
    gross = replace(channel(spread, 1), use=np.ones(COUNT, dtype=bool), discrepancy=50.0)
    even, odd = gross.average(np.ones(COUNT))[:2]
    assert odd == pytest.approx(even, rel=1e-3)
    assert gross.noise_share[:2] == pytest.approx([1.6e-7, 1.6e-3], rel=0.01)


def test_empty_blocks_have_no_residual() -> None:
    nothing = replace(channel(np.ones(COUNT), 8), use=np.zeros(COUNT, dtype=bool))
    assert not nothing.average(np.ones(COUNT)).any()
    assert not nothing.noise_share.any()
    assert std_beyond_noise(np.zeros(COUNT // 8), nothing) == 0.0


def driven_wall(
    unknown: NDArray[np.float64], position_error: NDArray[np.float64]
) -> tuple[PreparedRecording, Model]:
    """Record an attached wall that an unknown force moves, too, with errors of its position."""
    rng, model = np.random.default_rng(5), nominal(**ATTACHED)
    known = 25.0 * np.sin(3.0 * T) + 10.0 * np.cos(41.0 * T) + 1e-3 * rng.normal(size=len(T))
    x = run_driven_wall(model, T, known + unknown, 0.0) + position_error
    return prepared_from(Signals(T, known, T, x, np.empty(0), np.empty((4, 0))), model)


@pytest.mark.parametrize('position_noise', [1e-7, 1e-5, 2e-4])
def test_unknown_force_of_a_driven_wall_is_found_behind_any_noise_of_the_position(
    position_noise: float
) -> None:
    rng = np.random.default_rng(6)
    unknown, noise = rng.normal(size=(2, len(T)))
    prepared, start = driven_wall(UNKNOWN * unknown, position_noise * noise)
    found = with_discrepancy(prepared, start)
    assert prepared.force_noise < 0.02 * UNKNOWN
    assert found.force_discrepancy == pytest.approx(UNKNOWN, rel=0.12)


def test_an_error_of_the_position_is_not_taken_for_a_force_on_a_driven_wall() -> None:
    noise = np.random.default_rng(7).normal(size=len(T))
    wandering = lfilter([1e-5], [1.0, -0.7], noise)  # most of it below the top of the spectrum
    prepared, start = driven_wall(0.0 * T, wandering)
    found = with_discrepancy(prepared, start)
    assert found.motion_discrepancy > 2.0 * prepared.observed.position_noise
    assert found.force_discrepancy < least_material(prepared)


def test_discrepancy_brings_every_channel_to_variance_one() -> None:
    recording, model = prepared_from(recorded(**physics('coulomb_friction', 6.0)))
    base = fit([recording], model)
    weighed = with_discrepancy(recording, base.model)
    function = residual_function([weighed], base.model, robust=False)
    left = weighed.split(function(base.model.coordinates))
    powers = [float(np.mean(part[channel.filled] ** 2))
              for part, channel in zip(left, weighed.channels(base.model))]
    assert powers == pytest.approx([1.0, 1.0], abs=0.2)
    plain = without_discrepancy(weighed)
    assert weighed.force_discrepancy > 0.0 and weighed.motion_discrepancy > 0.0
    assert plain.force_discrepancy == plain.motion_discrepancy == 0.0


def test_exact_model_leaves_no_discrepancy_worth_a_name() -> None:
    recording, model = prepared_from(recorded())
    assert not material([with_discrepancy(recording, model)], model)


def test_correlation_time_is_that_of_an_autoregressive_process() -> None:
    rng, phi = np.random.default_rng(3), 0.8
    values = np.zeros(20_000)
    for k, push in enumerate(rng.normal(size=len(values) - 1)):
        values[k + 1] = phi * values[k] + push
    assert correlation_time(values) == pytest.approx((1.0 + phi) / (1.0 - phi), rel=0.15)
    assert correlation_time(rng.normal(size=5000)) == pytest.approx(1.0, abs=0.15)
