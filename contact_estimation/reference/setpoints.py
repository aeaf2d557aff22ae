# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Setpoints: what the planner asks for, and the reference that the robot follows."""

from typing import Callable, NamedTuple


class Desired(NamedTuple):
    """Setpoint of the planner at one instant."""

    # position, velocity, acceleration: x_d with derivatives [m], [m/s], [m/s^2]
    position: float
    velocity: float
    acceleration: float
    force: float  # F_r, positive while pressing [N]; NaN where no force is prescribed


class Reference(NamedTuple):
    """The reference trajectory at one instant, as published on `reference_trajectory`."""

    # position, velocity, acceleration: x_r with derivatives [m], [m/s], [m/s^2]
    position: float
    velocity: float
    acceleration: float
    force: float = 0.0  # F_r while a force law is active, else 0 [N]


ReferenceAt = Callable[[float], tuple[float, float, float, float]]
"""
From time [s] to the fields of a `Reference` there.

A plain tuple suffices: an integrator asks many thousand times per second, and a named tuple takes
ten times as long to make.
"""
