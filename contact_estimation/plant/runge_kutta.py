# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The sums of a fourth-order Runge-Kutta step."""

from __future__ import annotations

State = tuple[float, ...]
"""x [m], v [m/s], then the internal states of the effects."""


def shift(state: State, h: float, rates: State) -> State:
    """Return state + h rates."""
    return tuple([s + h * rate for s, rate in zip(state, rates)])


def combine(
    state: State, h: float, k1: State, k2: State, k3: State, k4: State
) -> list[float]:
    """Return the state after a step h [s] with rates k1 to k4."""
    sixth = h / 6.0
    return [s + sixth * (a + 2.0 * b + 2.0 * c + d)
            for s, a, b, c, d in zip(state, k1, k2, k3, k4)]
