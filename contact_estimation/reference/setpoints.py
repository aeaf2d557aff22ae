# Copyright 2026 contact_estimation authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""Setpoints: what the planner asks for, and the reference that the robot follows."""

from __future__ import annotations

from typing import Callable, NamedTuple


class Desired(NamedTuple):
    """
    Setpoint of the planner at one instant.

    Attributes
    ----------
    position, velocity, acceleration : float
        x_d with derivatives [m], [m/s], [m/s^2].
    force : float
        F_r, positive while pressing [N]; NaN where no force is prescribed.

    """

    position: float
    velocity: float
    acceleration: float
    force: float


class Reference(NamedTuple):
    """
    The reference trajectory at one instant, as published on `reference_trajectory`.

    Attributes
    ----------
    position, velocity, acceleration : float
        x_r with derivatives [m], [m/s], [m/s^2].
    force : float
        F_r while a force law is active, else 0 [N].

    """

    position: float
    velocity: float
    acceleration: float
    force: float = 0.0


ReferenceAt = Callable[[float], tuple[float, float, float, float]]
"""
From time [s] to the fields of a `Reference` there.

A plain tuple suffices: an integrator asks many thousand times per second, and a named tuple takes
ten times as long to make.
"""
