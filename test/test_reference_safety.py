# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
The reference is safe whatever happens: finite, slow enough, never deeper than its limit.

Estimates, setpoints, gaps and changes of parameters are drawn by hypothesis, always the same.
"""

from __future__ import annotations

from math import inf, isfinite, nan, ulp
from typing import Any

from contact_estimation.estimation.parameters import EstimationParameters
from contact_estimation.estimation.session import ContactSession
from contact_estimation.estimators import ESTIMATORS
from contact_estimation.exceptions import ContactEstimationError
from contact_estimation.parameters.specification import (
    LARGEST,
    ParameterSpecification,
    specifications,
)
from contact_estimation.parameters.values import build
from contact_estimation.reference.laws import LAWS
from contact_estimation.reference.parameters import ReferenceParameters
from contact_estimation.reference.reference_generator import limited, ReferenceGenerator
from contact_estimation.reference.setpoints import Desired, Reference
from hypothesis import given, Phase, settings, strategies as st
import pytest

T, PERIOD_NS = 0.002, 2_000_000
ANY = st.floats(width=64) | st.sampled_from([nan, inf, -inf, 0.0, 1e308, -1e308, 5e-324])
COMMON = st.floats(-0.05, 0.05)
HOSTILE = COMMON | ANY
DESIRED = st.builds(Desired, HOSTILE, HOSTILE, HOSTILE, st.floats(0.0, 100.0) | ANY)
LIMITS = st.builds(
    ReferenceParameters,
    stiffness_floor=st.floats(1e-3, 1e4), maximum_velocity=st.floats(1e-6, 10.0),
    fade_s=st.floats(1e-3, 60.0), maximum_force_rate=st.floats(0.0, 1e6),
)
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
    assert_safe(last, limited(last, target, dt, T, speed, deepest), dt, T, speed, deepest)


STEPS = st.lists(st.tuples(
    DESIRED, st.booleans(), HOSTILE, st.floats(1.0, 1e6) | ANY,
    st.floats(0.0, 0.01) | st.sampled_from([T, 10.0, 1e-12]),
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
        assert_safe(last, now, dt, T, limits.maximum_velocity, deepest)
        last = now


def values_of(spec: ParameterSpecification) -> st.SearchStrategy[Any]:
    """Draw valid values of a parameter, the ends of its range among them."""
    if spec.choices:
        return st.sampled_from(spec.choices)
    if isinstance(spec.default, bool):
        return st.booleans()
    low, high = spec.minimum, spec.maximum
    if isinstance(spec.default, int):
        return st.integers(int(low or 0), int(high or 50))
    drawn = st.floats(
        -LARGEST if low is None else low, LARGEST if high is None else min(high, LARGEST))
    return drawn | st.just(nan) if spec.nan_is_off else drawn


CHANGEABLE = [spec for spec in specifications(EstimationParameters) if not spec.read_only]
OFTEN = [spec for spec in CHANGEABLE if not spec.name.startswith(('physics.', 'tuning.'))]
CHANGE = (st.sampled_from(OFTEN) | st.sampled_from(CHANGEABLE)).flatmap(
    lambda spec: st.tuples(st.just(spec.name), values_of(spec)))
EVENT = st.tuples(st.just('change'), CHANGE) | st.tuples(
    st.just('desired'), st.tuples(st.integers(-5, 5), DESIRED)
) | st.tuples(st.just('sample'), st.tuples(
    st.sampled_from([1, 1, 1, 2, 500]) | st.integers(-3, 3),
    st.floats(-0.02, 0.02) | ANY, COMMON | ANY, st.floats(-80.0, 5.0) | ANY,
)) | st.tuples(st.just('press'), st.tuples(st.integers(1, 60), st.floats(1e-4, 0.02)))


class Storm:
    """A session under hostile events, whose references are checked one by one."""

    def __init__(self, estimator: str) -> None:
        self.session = ContactSession(build(EstimationParameters, {
            'estimator': estimator, 'reference.maximum_depth': 0.01, 'force_reference': 30.0}))
        self._now_ns, self._last_ns, self._jumps = 10**9, 0, 0
        self._last: Reference | None = None

    def change(self, name: str, value: Any) -> None:
        """Change a parameter; an inconsistent one is refused."""
        try:
            self.session.change_parameters({name: value})
        except ContactEstimationError:
            pass

    def desired(self, ahead: int, desired: Desired) -> None:
        """Add a setpoint."""
        self.session.add_desired(self._now_ns + ahead * PERIOD_NS, desired)

    def sample(self, periods: int, position: float, velocity: float, force: float) -> None:
        """Add a pair of measurements, possibly out of order, and check the reference."""
        self._now_ns += periods * PERIOD_NS
        self.session.add_motion(self._now_ns, position, velocity)
        for result in self.session.add_wrench(self._now_ns, force):
            self._check(result.sample, result.reference)

    def press(self, count: int, depth: float) -> None:
        """Press into a wall of 3000 N/m for some samples."""
        for k in range(count):
            x = depth * (1.0 + 0.3 * ((k % 10) - 5) / 5.0)
            self.sample(1, x, 0.0, -3000.0 * x)

    def _check(self, sample: Any, reference: Any) -> None:
        p = self.session.parameters
        deepest = p.environment.location + p.reference.maximum_depth
        if self._last is None or self.session.time_jumps != self._jumps:
            self._jumps = self.session.time_jumps
            self._last = self._last or Reference(sample.position, 0.0, 0.0)
            dt = 1.0 / p.sample_rate
        else:
            dt = (sample.stamp_ns - self._last_ns) * 1e-9
        assert_safe(self._last, reference, dt, 1.0 / p.sample_rate,
                    p.reference.maximum_velocity, deepest)
        self._last, self._last_ns = reference, sample.stamp_ns


@pytest.mark.slow
@pytest.mark.filterwarnings('ignore::RuntimeWarning')  # overflow, after such parameters
@pytest.mark.parametrize('estimator', ESTIMATORS)
@settings(always_the_same, max_examples=30)
@given(st.lists(EVENT, min_size=5, max_size=25))
def test_a_session_is_safe_under_storms_of_samples_setpoints_and_parameters(
    estimator: str, events: list[Any]
) -> None:
    storm = Storm(estimator)
    storm.press(30, 0.005)
    for kind, arguments in events:
        getattr(storm, kind)(*arguments)
    storm.press(20, 0.005)
