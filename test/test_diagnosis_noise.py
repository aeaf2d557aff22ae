# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Noise, smoothing, derivatives and discrepancy of a recording against closed forms."""

from __future__ import annotations

from math import pi
from typing import Any

from concealed_worlds import FORCE_NOISE, nominal, physics, prepared_from, recorded
from contact_estimation.diagnosis.fit.discrepancy import (
    correlation_time, material, std_beyond_noise, with_discrepancy)
from contact_estimation.diagnosis.observe.channel import Channel, force_noise
from contact_estimation.diagnosis.observe.model import Model
from contact_estimation.diagnosis.observe.observed import observe
from contact_estimation.diagnosis.observe.signals import Signals
from contact_estimation.diagnosis.observe.smoothing import differentiate, smooth, white_noise_std
import numpy as np
from numpy.typing import NDArray
import pytest


def noise_of(signals: Signals, **changes: Any) -> float:
    """Estimate the noise floor of a recording."""
    model = Model.of(nominal(**changes))
    return force_noise(model, observe(signals, model.nominal))


@pytest.mark.slow
@pytest.mark.parametrize('changes', [
    {},
    physics('force_bias', 2.0),
    physics('force_drift', 0.3),
    physics('tool_inertia', 1.0),
    {**physics('force_bias', -5.0), **physics('force_drift', 1.0),
     **physics('tool_inertia', 1.0)},
], ids=['plain', 'bias', 'drift', 'tool', 'all'])
def test_noise_floor_is_that_of_the_sensor(changes: dict[str, Any]) -> None:
    assert noise_of(recorded(**changes)) == pytest.approx(FORCE_NOISE, rel=0.1)


Array = NDArray[np.float64]

H = 0.004
T = H * np.arange(2000)


def wave(frequency: float) -> Array:
    """Give a sine of 5 mm."""
    return np.asarray(5e-3 * np.sin(2.0 * pi * frequency * T))


@pytest.mark.parametrize('std, quantum', [(3e-6, 0.0), (3e-6, 1e-6), (1e-6, 3e-6)])
def test_noise_std_is_known_under_a_slow_signal(std: float, quantum: float) -> None:
    generator = np.random.default_rng(1)
    signal = wave(3.0) + std * generator.standard_normal(len(T))
    if quantum > 0.0:
        signal = np.round(signal / quantum) * quantum
    # What rounding adds is white and even over a step (Widrow 1956).
    expected = np.sqrt(std**2 + quantum**2 / 12.0)
    assert white_noise_std(signal) == pytest.approx(expected, rel=0.1)


def test_smoothing_solves_the_normal_equations() -> None:
    generator = np.random.default_rng(5)
    signal, weight = generator.standard_normal(40), generator.uniform(0.1, 1.0, 40)
    third = np.diff(np.eye(40), 3, axis=0)
    matrix = np.diag(weight) + (2.0 * pi * 0.1) ** -6 * third.T @ third
    expected = np.linalg.solve(matrix, weight * signal)
    np.testing.assert_allclose(smooth(signal, weight, 0.1), expected, atol=1e-9)


def test_derivatives_are_those_of_a_sine() -> None:
    omega = 2.0 * pi * 3.0
    got = differentiate(np.sin(omega * T), H)
    inner = slice(2, -2)
    # Errors of fourth order: (w h)^4 / 30 and (w h)^4 / 90.
    np.testing.assert_allclose(got.rate[inner], omega * np.cos(omega * T)[inner],
                               atol=1.1 * omega * (omega * H) ** 4 / 30.0)
    np.testing.assert_allclose(got.acceleration[inner], -omega**2 * np.sin(omega * T)[inner],
                               atol=1.1 * omega**2 * (omega * H) ** 4 / 90.0)


COUNT, NOISE, UNKNOWN = 24_000, 0.02, 0.5


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
def test_discrepancy_is_found_beside_noise_of_any_spread(block: int, widest: float) -> None:
    spread = np.repeat(np.geomspace(1.0, widest, COUNT // block), block)
    plain = channel(spread, block)
    assert std_beyond_noise(
        plain.average(errors(spread, block, UNKNOWN)), plain) == pytest.approx(UNKNOWN, rel=0.06)
    assert std_beyond_noise(
        plain.average(errors(spread, block, 0.0)), plain) < 0.3 * NOISE


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
