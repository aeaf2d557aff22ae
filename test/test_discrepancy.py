# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""What a channel counts as noise, and what beyond it as a discrepancy."""

from __future__ import annotations


from concealed_worlds import prepared_from, recorded
from contact_estimation.diagnosis.fit.discrepancy import (
    correlation_time,
    material,
    std_beyond_noise,
    with_discrepancy,
)
from contact_estimation.diagnosis.observe.channel import Channel
import numpy as np
from numpy.typing import NDArray
import pytest

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
