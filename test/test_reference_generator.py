# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The reference x_r: continuous, slew-limited, with the feed-forward of a smooth force."""

from __future__ import annotations

from math import nan
from typing import Any, Callable

from contact_estimation.reference.parameters import ReferenceParameters
from contact_estimation.reference.reference_generator import ReferenceGenerator
from contact_estimation.reference.setpoints import Desired, Reference
from core_runs import closed_loop, PAPER_SENSORS
import numpy as np
import pytest

T, MOST = 0.002, 0.25
K = 4800.0


def sine_force(t: float) -> float:
    """Eq. (40) [N]."""
    return float(50.0 + 8.0 * np.sin(20.0 * t))


def play(
    of: ReferenceGenerator,
    begin: int,
    end: int,
    force: Callable[[float], float] = sine_force,
    contact: bool = True,
    K_hat: float = K,
    x_d: float = 0.0204,
) -> list[Reference]:
    """Step a generator through samples `begin` to `end`, with a resting x_d."""
    return [
        of.step(T * k, T, Desired(x_d, 0.0, 0.0, force(T * k)), contact, 0.0, K_hat)
        for k in range(begin, end)
    ]


def generator(law: str = 'eq20', **parameters: float) -> ReferenceGenerator:
    """Make a generator."""
    return ReferenceGenerator(law, ReferenceParameters(**parameters))  # type: ignore[arg-type]


def largest_rate(points: list[Reference]) -> float:
    """Largest rate of x_r between samples [m/s]."""
    return float(np.max(np.abs(np.diff([p.position for p in points]))) / T)


def test_wanted_force_in_contact_becomes_depth() -> None:
    point = play(generator(), 0, 2000)[-1]
    assert point.position == pytest.approx(sine_force(T * 1999) / K, rel=1e-9)


@pytest.mark.parametrize('contact, force', [(False, 50.0), (True, nan)])
def test_x_d_passes_through_without_contact_or_wanted_force(contact: bool, force: float) -> None:
    desired = Desired(0.01, 0.2, 0.3, force)
    assert generator().step(0.0, T, desired, contact, 0.0, K) == (0.01, 0.2, 0.3, 0.0)


def test_feed_forward_of_a_sine_is_its_first_derivative() -> None:
    points = play(generator(), 0, 2000)[1000:]
    expected = [160.0 * np.cos(20.0 * T * k) / K for k in range(1000, 2000)]
    np.testing.assert_allclose([p.velocity for p in points], expected, atol=0.03 * 160.0 / K)


@pytest.mark.slow
@pytest.mark.parametrize('estimation, plant', [
    ({'estimator': 'indirect_adaptive'}, PAPER_SENSORS), ({'reference_law': 'series'}, {}),
], ids=['eq20', 'series'])
def test_reference_of_a_closed_loop_run_is_continuous(
    estimation: dict[str, Any], plant: dict[str, Any]
) -> None:
    run = closed_loop(estimation, plant)
    points = [r.reference for r in run.results if r.reference is not None]
    assert largest_rate(points) <= MOST * (1.0 + 1e-9)
