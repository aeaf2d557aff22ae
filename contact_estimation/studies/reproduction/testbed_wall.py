# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The wall of the testbed: spring, damper and bearing friction, without mass."""

from __future__ import annotations

from math import exp
from typing import NamedTuple

from .testbed_constants import FlexibleWallConstants


class WallState(NamedTuple):
    """Deflection [m] and friction as a fraction of its limit, -1 to 1."""

    deflection: float
    friction: float


def friction_limit(rate: float, wall: FlexibleWallConstants) -> float:
    """
    Compute the friction limit of the bearings at a rate: the Stribeck curve.

    rate: rate of the deflection [m/s]
    Returns force: F_c + (F_s - F_c) exp(-(v / v_s)^2) [N]
    """
    more = wall.static_friction - wall.sliding_friction
    return wall.sliding_friction + more * exp(-(rate / wall.stribeck_velocity) ** 2)


def free_rate(state: WallState, wall: FlexibleWallConstants) -> float:
    """
    Compute the rate of the untouched wall with rolling bearings.

    Returns rate: rate of the deflection, from 0 = K_e w + B_e w' + F_c z [m/s]
    """
    friction = wall.sliding_friction * state.friction
    return -(wall.stiffness * state.deflection + friction) / wall.damping


def moved(state: WallState, step: float, wall: FlexibleWallConstants) -> WallState:
    """
    Compute the state after a change of the deflection.

    Dahl's model, dz/dw = (1 - z sgn w') / s, integrated exactly over a step in one direction:
    friction depends on the travelled distance only and approaches its limit over s.

    step: change of the deflection [m]
    """
    if step == 0.0:
        return state
    end = 1.0 if step > 0.0 else -1.0
    left = exp(-abs(step) / wall.presliding)
    return WallState(state.deflection + step, end + (state.friction - end) * left)


def pressing_force(state: WallState, rate: float, wall: FlexibleWallConstants) -> float:
    """
    Compute the force of a tool that moves with the wall.

    rate: rate of the tool [m/s]
    Returns force: K_e w + B_e w' + F(w') z [N]; negative where the tool retreats faster than the
    wall
    """
    friction = friction_limit(rate, wall) * state.friction
    return wall.stiffness * state.deflection + wall.damping * rate + friction
