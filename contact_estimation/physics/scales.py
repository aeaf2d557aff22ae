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

"""Orders of magnitude in a recording, from which searches and random draws start."""

from __future__ import annotations

from typing import NamedTuple


class Scales(NamedTuple):
    """
    Orders of magnitude in a recording.

    Attributes
    ----------
    depth, speed, force, control : float
        Largest penetration [m], penetration rate [m/s], contact force [N] and control force [N].
    greatest_pull : float
        Largest positive F_e [N].
    duration : float
        Length of the recording [s].
    stiffness, damping, mass : float
        K_e [N/m] and B_e [N s/m] fitted without effects, M_t [kg].
    spectrum : tuple of (float, complex)
        Frequency [Hz] and complex amplitude [N] of the largest peaks in the spectrum of the
        contact residual.

    """

    depth: float
    speed: float
    force: float
    control: float
    greatest_pull: float
    duration: float
    stiffness: float
    damping: float
    mass: float
    spectrum: tuple[tuple[float, complex], ...] = ()

    def peaks(self) -> tuple[tuple[float, complex], ...]:
        """Return the peaks of the residual spectrum, or one guess where none is known."""
        return self.spectrum or ((1.0, complex(0.0, -0.02 * self.force)),)
