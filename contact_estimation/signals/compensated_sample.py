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

"""A sample with known physics compensated, and the interface of compensations."""

from __future__ import annotations

from typing import NamedTuple, Protocol


class CompensatedSample(NamedTuple):
    """
    The terms of the relation that is left of a sample after known physics are compensated.

    Attributes
    ----------
    depth : float
        Penetration of the surface at its known position [m].
    pressing : float
        -F_e without what the sensor adds [N]: decides contact.
    rest : float
        The same less the known force of the environment [N]: what K_e and B_e explain.
    travel : float
        Displacement whose rate multiplies B_e [m].
    velocity : float
        That rate [m/s], NaN where not measured.
    stiffness_column, constant_column : float
        phi_K [m], and its slope over the depth.
    usable : bool
        Whether the relation holds.

    """

    depth: float
    pressing: float
    rest: float
    travel: float
    velocity: float
    stiffness_column: float
    constant_column: float
    usable: bool


class SampleCompensation(Protocol):
    """Anything that compensates known physics sample by sample."""

    def take(
        self, stamp_ns: int, depth: float, velocity: float, force: float, pressing: float
    ) -> CompensatedSample:
        """
        Compensate one sample.

        Parameters
        ----------
        stamp_ns : int
            Stamp, after the last one [ns].
        depth : float
            x less the nominal x_e [m].
        velocity : float
            Measured rate of x [m/s], NaN where not measured.
        force, pressing : float
            F_e as measured; -F_e less the bias [N].

        Returns
        -------
        sample : CompensatedSample
            The terms that are left.

        """
