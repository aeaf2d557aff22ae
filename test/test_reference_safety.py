# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
The reference is safe whatever happens: finite, slow enough, never deeper than its limit.

Estimates, setpoints, gaps and changes of parameters are drawn by hypothesis, always the same.
"""

from __future__ import annotations

from math import inf, isfinite, nan, ulp
from typing import Any

from contact_estimation.reference.parameters import ReferenceParameters
from contact_estimation.reference.reference_generator import LAWS, limited, ReferenceGenerator
from contact_estimation.reference.setpoints import Desired, Reference
from hypothesis import given, Phase, settings, strategies as st

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
