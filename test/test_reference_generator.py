# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The reference x_r: continuous, slew-limited, with the feed-forward of a smooth force."""

from __future__ import annotations

from math import nan
from typing import Any, Callable

from contact_estimation.exceptions import ParameterRangeError
from contact_estimation.reference.experiment import PseudoRandomBinary
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


def test_force_is_published_while_a_law_is_active() -> None:
    of = generator()
    assert [play(of, 0, 1)[0].force, play(of, 1, 2, contact=False)[0].force] == [50.0, 0.0]


@pytest.mark.parametrize('contact, force', [(False, 50.0), (True, nan)])
def test_x_d_passes_through_without_contact_or_wanted_force(contact: bool, force: float) -> None:
    desired = Desired(0.01, 0.2, 0.3, force)
    assert generator().step(0.0, T, desired, contact, 0.0, K) == (0.01, 0.2, 0.3, 0.0)


def test_pass_through_ignores_the_wanted_force() -> None:
    point = play(generator('pass_through'), 0, 10)[-1]
    assert point == (0.0204, 0.0, 0.0, 0.0)


def test_reference_at_rest_retreats_when_its_depth_is_allowed_no_longer() -> None:
    of, desired = generator(), Desired(0.01, 0.0, 0.0, nan)
    resting = [of.step(T * k, T, desired, True, 0.0, K, 0.02) for k in range(3)]
    assert resting == [(0.01, 0.0, 0.0, 0.0)] * 3
    assert of.step(3 * T, T, desired, True, 0.0, K, 0.009).position == 0.01 - MOST * T
    assert of.limited


def test_feed_forward_of_a_sine_is_its_first_derivative() -> None:
    points = play(generator(), 0, 2000)[1000:]
    expected = [160.0 * np.cos(20.0 * T * k) / K for k in range(1000, 2000)]
    np.testing.assert_allclose([p.velocity for p in points], expected, atol=0.03 * 160.0 / K)


def test_feed_forward_of_a_sine_is_its_second_derivative() -> None:
    points = play(generator(), 0, 2000)[1000:]
    expected = [-3200.0 * np.sin(20.0 * T * k) / K for k in range(1000, 2000)]
    np.testing.assert_allclose([p.acceleration for p in points], expected, atol=0.06 * 3200.0 / K)


def test_steps_of_the_force_have_no_feed_forward() -> None:
    prbs = PseudoRandomBinary(8.0)
    points = play(generator(), 0, 2000, lambda t: 50.0 + prbs.value(t))[1000:]
    limited = [a != b for a, b in zip(points, points[1:])]
    rates = {p.velocity for p, moved in zip(points[1:], limited) if not moved}
    assert rates == {0.0}


def test_published_rate_is_that_of_the_limited_reference() -> None:
    prbs = PseudoRandomBinary(8.0)
    points = play(generator(), 0, 2000, lambda t: 50.0 + prbs.value(t))[1000:]
    differences = np.diff([p.position for p in points]) / T
    moving = np.abs(differences) > 0.9 * MOST
    rates = np.array([p.velocity for p in points[1:]])
    np.testing.assert_allclose(rates[moving], differences[moving], rtol=1e-6)


def test_contact_loss_keeps_the_reference_slew_limited() -> None:
    of = generator()
    points = play(of, 0, 1000) + play(of, 1000, 1400, contact=False)
    assert largest_rate(points[500:]) <= MOST * (1.0 + 1e-9)


def test_offset_after_contact_loss_fades_out_within_its_time() -> None:
    of = generator()
    play(of, 0, 1000)
    points = play(of, 1000, 1110, contact=False)
    assert abs(points[90].position - 0.0204) > 1e-6
    assert points[102].position == 0.0204


@pytest.mark.parametrize('law', ['series', 'pass_through'])
def test_switch_of_the_law_keeps_the_reference_slew_limited(law: str) -> None:
    of = generator()
    points = play(of, 0, 1000)
    of.configure(law, ReferenceParameters())
    points += play(of, 1000, 1400)
    assert largest_rate(points[500:]) <= MOST * (1.0 + 1e-9)


@pytest.mark.parametrize('K_hat', [600.0, 2400.0, 1e5])
def test_jump_of_the_estimate_keeps_the_reference_slew_limited(K_hat: float) -> None:
    of = generator()
    points = play(of, 0, 1000) + play(of, 1000, 1600, K_hat=K_hat)
    assert largest_rate(points[500:]) <= MOST * (1.0 + 1e-9)


@pytest.mark.parametrize('K_hat', [1e-3, 1.0, 499.0, 500.0])
def test_law_uses_no_stiffness_below_the_floor(K_hat: float) -> None:
    point = play(generator(), 0, 3000, lambda t: 10.0, K_hat=K_hat)[-1]
    assert point.position == pytest.approx(10.0 / 500.0)


def test_reference_stays_slew_limited_when_a_large_offset_has_faded() -> None:
    of = generator()  # 50 N on the softest wall: 0.1 m deep, then contact is lost
    points = play(of, 0, 1000, lambda t: 50.0, K_hat=500.0)
    points += play(of, 1000, 2000, contact=False)
    assert largest_rate(points[900:]) <= MOST * (1.0 + 1e-9)


def test_contact_that_comes_and_goes_keeps_the_reference_slew_limited() -> None:
    of = generator()
    points = play(of, 0, 500)
    for k in range(10):
        points += play(of, 500 + 20 * k, 520 + 20 * k, contact=bool(k % 2))
    assert largest_rate(points[400:]) <= MOST * (1.0 + 1e-9)


def test_change_of_limits_keeps_the_reference_slew_limited() -> None:
    of = generator()
    points = play(of, 0, 1000)
    of.configure('eq20', ReferenceParameters(stiffness_floor=9600.0))
    points += play(of, 1000, 1400)
    assert largest_rate(points[500:]) <= MOST * (1.0 + 1e-9)


def test_reset_takes_the_next_reference_as_it_comes() -> None:
    of = generator()
    play(of, 0, 1000)
    of.reset()
    assert play(of, 1000, 1001, contact=False)[0].position == 0.0204


def test_double_tracking_is_refused_live_and_changes_nothing() -> None:
    of, same = generator(), generator()
    with pytest.raises(ParameterRangeError, match='force_tracking'):
        of.configure('series', ReferenceParameters(robot_force_tracking=True))
    assert play(of, 0, 100) == play(same, 0, 100)


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
