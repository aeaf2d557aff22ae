# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The reference: its laws, its safety whatever comes, and under storms of messages."""

from math import inf, isfinite, nan, ulp
from typing import Any, Callable

from contact_estimation.exceptions import ParameterRangeError
from contact_estimation.parameters import build
from contact_estimation.pipeline.parameters import EstimationParameters
from contact_estimation.reference.parameters import ReferenceParameters
from contact_estimation.reference.reference_generator import (
    eq20_compliance, LAWS, limited, quintic, ReferenceGenerator, series_compliance)
from contact_estimation.reference.setpoints import Desired, Reference
from contact_estimation.signals.stamp_screen import CONFIRMING
from core_runs import closed_loop, PAPER_SENSORS
from hostile_loop import CHANGES, Event, HostileLoop, TOPICS
from hypothesis import given, Phase, settings, strategies as st
import numpy as np
import pytest


def test_eq20_reaches_as_deep_as_the_estimated_spring_bends() -> None:
    assert 50.0 * eq20_compliance(5000.0, 1e4) == pytest.approx(0.01)


def test_series_compliance_makes_two_springs_carry_the_force() -> None:
    K_e, K_t, F_r = 4800.0, 5000.0, 50.0
    x_r = F_r * series_compliance(K_e, K_t)
    _, F_e = np.linalg.solve([[K_t, -1.0], [K_e, 1.0]], [K_t * x_r, 0.0])
    assert -F_e == pytest.approx(F_r)


@pytest.mark.slow
def test_eq20_settles_at_its_static_formula() -> None:
    run = closed_loop({'reference_law': 'eq20'}, experiment='none', duration=8.6)
    F_r, K_hat, K_e, K_t = 50.0, run.last.stiffness, 4800.0, 5000.0
    # K_t (x - F_r / K_hat) - F_e = 0 and F_e + K_e x = 0, in (x, F_e) with x_e = 0.
    _, F_e = np.linalg.solve([[K_t, -1.0], [K_e, 1.0]], [K_t * F_r / K_hat, 0.0])
    assert run.force_at(8.0, 8.5) == pytest.approx(-F_e, rel=0.01)


def test_series_gives_the_wanted_force() -> None:
    run = closed_loop({'reference_law': 'series'})
    assert run.force_at(7.0, 8.5) == pytest.approx(50.0, rel=0.02)


def test_force_tracking_gives_the_wanted_force() -> None:
    run = closed_loop(
        {'reference.robot_force_tracking': True}, {'robot.force_tracking': True}, duration=8.6)
    assert run.force_at(7.0, 8.5) == pytest.approx(50.0, rel=0.02)


def test_both_together_are_refused_by_the_parameters() -> None:
    with pytest.raises(ParameterRangeError, match='reference_law series.*force_tracking'):
        build(EstimationParameters,
              {'reference_law': 'series', 'reference.robot_force_tracking': True})


T, MOST = 0.002, 0.25
K = 4800.0


def sine_force(t: float) -> float:
    """Eq. (40) [N]."""
    return float(50.0 + 8.0 * np.sin(20.0 * t))


def play(
    of: ReferenceGenerator, begin: int, end: int, force: Callable[[float], float] = sine_force,
    contact: bool = True, K_hat: float = K, x_d: float = 0.0204,
) -> list[Reference]:
    """Step a generator through samples `begin` to `end`, with a resting x_d."""
    return [
        of.step(T * k, T, Desired(x_d, 0.0, 0.0, force(T * k)), contact, 0.0, K_hat)
        for k in range(begin, end)]


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


BEGIN, END, DURATION = -0.1, 0.0204, 2.2


def test_quintic_solves_the_six_end_conditions() -> None:
    rows = []
    for t in (0.0, DURATION):
        powers = np.polynomial.Polynomial.basis
        rows += [[powers(k).deriv(d)(t) if d else powers(k)(t) for k in range(6)]
                 for d in range(3)]
    expected = np.polynomial.Polynomial(np.linalg.solve(rows, [BEGIN, 0, 0, END, 0, 0]))
    for t in np.linspace(0.0, DURATION, 23).tolist():
        values = (expected(t), expected.deriv()(t), expected.deriv(2)(t))
        np.testing.assert_allclose(quintic(BEGIN, END, DURATION, t), values, atol=1e-12)


@pytest.mark.parametrize('order', [1, 2])
def test_derivatives_are_those_of_finite_differences(order: int) -> None:
    h = 1e-5
    for t in np.linspace(0.1, DURATION - 0.1, 20).tolist():
        before, after = (quintic(BEGIN, END, DURATION, t + s * h) for s in (-1, 1))
        difference = (after[order - 1] - before[order - 1]) / (2.0 * h)
        assert quintic(BEGIN, END, DURATION, t)[order] == pytest.approx(difference, abs=1e-8)


DT, PERIOD_NS = 0.002, 2_000_000
ANY = st.floats(width=64) | st.sampled_from([nan, inf, -inf, 0.0, 1e308, -1e308, 5e-324])
COMMON = st.floats(-0.05, 0.05)
HOSTILE = COMMON | ANY
WANTED = st.builds(Desired, HOSTILE, HOSTILE, HOSTILE, st.floats(0.0, 100.0) | ANY)
LIMITS = st.builds(
    ReferenceParameters, stiffness_floor=st.floats(1e-3, 1e4),
    maximum_velocity=st.floats(1e-6, 10.0), fade_s=st.floats(1e-3, 60.0),
    maximum_force_rate=st.floats(0.0, 1e6))
always_the_same = settings(
    derandomize=True, database=None, deadline=None, max_examples=200,
    phases=(Phase.explicit, Phase.generate),  # shrinking takes minutes
)


def assert_safe(
    last: Reference, now: Reference, dt: float, period: float, speed: float, deepest: float
) -> None:
    """Check one step, and the parabola that the robot follows until the next."""
    assert all(map(isfinite, now[:3]))
    rounding = 4.0 * (ulp(now.position) + ulp(last.position))
    assert abs(now.position - last.position) <= speed * max(dt, 0.0) * (1.0 + 1e-9) + rounding
    for tau in (0.0, 0.5 * period, period):
        assert abs(now.velocity + tau * now.acceleration) <= speed * (1.0 + 1e-9)
        reached = now.position + tau * (now.velocity + 0.5 * tau * now.acceleration)
        assert not reached > max(deepest, now.position) + rounding
    assert not now.position > max(deepest, last.position) + rounding


@always_the_same
@given(COMMON, st.builds(Reference, HOSTILE, HOSTILE, HOSTILE), st.floats(0.0, 1.0),
       st.floats(1e-6, 10.0), HOSTILE)
def test_the_limits_hold_for_any_target(
    begin: float, target: Reference, dt: float, speed: float, deepest: float
) -> None:
    last = Reference(begin, 0.0, 0.0)
    assert_safe(last, limited(last, target, dt, DT, speed, deepest), dt, DT, speed, deepest)


STEPS = st.lists(st.tuples(
    WANTED, st.booleans(), HOSTILE, st.floats(1.0, 1e6) | ANY,
    st.floats(0.0, 0.01) | st.sampled_from([DT, 10.0, 1e-12]),
    st.none() | st.tuples(st.sampled_from(list(LAWS)), LIMITS), COMMON | st.just(nan),
), min_size=1, max_size=30)


@always_the_same
@given(STEPS, COMMON)
def test_the_generator_is_safe_with_any_estimates_and_setpoints(
    steps: list[Any], begin: float
) -> None:
    limits = ReferenceParameters()
    generator, t, last = ReferenceGenerator('eq20', limits), 0.0, Reference(begin, 0.0, 0.0)
    generator.start(begin)
    for desired, contact, x_e, K_hat, dt, change, deepest in steps:
        if change:
            limits = change[1]
            generator.configure(*change)
        t += dt
        now = generator.step(t, dt, desired, contact, x_e, K_hat, deepest)
        assert_safe(last, now, dt, DT, limits.maximum_velocity, deepest)
        last = now


FAR = st.floats(1e-3, 1e4).flatmap(lambda s: st.sampled_from([s, -s]))
DESIRED = st.builds(
    Desired, st.floats(-0.1, 0.1), st.floats(-1.0, 1.0), st.just(0.0), st.floats(0.0, 100.0))


def event(kinds: str, values: st.SearchStrategy[Any] = st.none()) -> st.SearchStrategy[Event]:
    """Draw one of some kinds of events, its value and its topics."""
    kind, topics = st.sampled_from(kinds.split()), st.sampled_from(TOPICS)
    return st.tuples(kind, values, topics).map(lambda drawn: Event(*drawn))


EVENT = st.one_of(
    event('shift clock', FAR), event('stamp', st.sampled_from([0, -1, 2**63, nan])),
    event('drop twice reset tare set_location'), event('withhold', st.integers(1, 20)),
    event('desired', DESIRED), event('change', st.sampled_from(
        [(name, value) for name, values in CHANGES.items() for value in values])))


@settings(derandomize=True, database=None, deadline=None, max_examples=60,
          phases=(Phase.explicit, Phase.generate))
@given(st.lists(st.tuples(EVENT, st.integers(0, 12)), min_size=3, max_size=20))
def test_no_sequence_of_events_breaks_a_limit(pauses: list[tuple[Event, int]]) -> None:
    events = [one for event, pause in pauses for one in [event, *[Event('plain')] * pause]]
    assert HostileLoop().run(events) == []


@pytest.mark.parametrize('events, reasons, jumps', [
    ([Event('stamp', 0)], {'joint_zero_stamp': 1, 'wrench_zero_stamp': 1}, 0),
    ([Event('stamp', -5)], {'joint_invalid_stamp': 1, 'wrench_invalid_stamp': 1}, 0),
    ([Event('stamp', nan)], {'joint_invalid_stamp': 1, 'wrench_invalid_stamp': 1}, 0),
    ([Event('shift', 0.6)], {'joint_future_stamp': 1, 'wrench_future_stamp': 1}, 0),
    ([Event('shift', -3.0, 'wrench')], {'wrench_past_stamp': 1}, 0),
    ([Event('shift', 1e4)] * (CONFIRMING - 1),
     {'joint_future_stamp': CONFIRMING - 1, 'wrench_future_stamp': CONFIRMING - 1}, 0),
    ([Event('clock', -3600.0)], {}, 1), ([Event('clock', 3600.0)], {}, 0)])
def test_false_stamps_are_counted_and_only_a_clock_that_stays_is_followed(
    events: list[Event], reasons: dict[str, int], jumps: int
) -> None:
    loop = HostileLoop()
    loop.run([*events, *[Event('plain')] * 20])
    session = loop.session
    assert (+session.rejected, session.time_jumps, loop.violations) == (reasons, jumps, [])
    assert session.last_stamp_ns == loop.now_ns
