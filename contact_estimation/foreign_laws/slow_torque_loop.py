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

"""Torque loop of finite bandwidth."""

from __future__ import annotations

from math import expm1

from numpy.random import Generator

from .law import Magnitudes, RobotLaw, Strength


class SlowTorqueLoop(RobotLaw):
    """
    The drives deliver the commanded force with a lag.

    tau f' + f = u.
    Eppinger and Seering, Proc. IEEE Conf. Robotics and Automation, 1987 (actuator dynamics).

    """

    families = ('timing', 'robot', 'inertia')

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        return lambda s: {'tau': 0.05 * s}

    def drive(
        self, u: float, x: float, v: float, dt: float, state: float
    ) -> tuple[float, float]:
        """Return the lagging force; see `RobotLaw.drive`."""
        state += (u - state) * -expm1(-dt / self.values.tau)
        return state, state
