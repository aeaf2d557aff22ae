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

"""
Axes estimated beside the contact axis: eq. (3) for each, independent of the others.

All axes share stamps: the forces come in one wrench and the positions in one joint state. Where
one component of a message is no measurement, the message counts for no axis. So each axis has the
same samples, and one wrench gives one estimate on every axis.
"""

from __future__ import annotations

from collections import deque
from dataclasses import replace
from math import inf
from typing import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from .parameters import EstimationParameters
from .pipeline import EstimationPipeline
from ..estimators.estimator import Estimate
from ..signals.contact_sample import ContactSample
from ..signals.synchronisation import Synchroniser

Columns = Sequence[NDArray[np.float64]]


def estimated_axes(parameters: EstimationParameters) -> dict[str, str]:
    """
    List the axes that are estimated.

    Parameters
    ----------
    parameters : EstimationParameters
        All parameters.

    Returns
    -------
    joints : dict of str to str
        Axis to joint, the contact axis first.

    """
    further = parameters.further_axes.named()
    return {parameters.axis: parameters.joint, **{a: own.joint for a, own in further.items()}}


def parameters_of_axis(parameters: EstimationParameters, axis: str) -> EstimationParameters:
    """
    Take the parameters for one of the further axes: its own location, all else shared.

    Parameters
    ----------
    parameters : EstimationParameters
        All parameters.
    axis : str
        The axis.

    Returns
    -------
    parameters : EstimationParameters
        With the location of that axis as that of the environment.

    """
    location = parameters.further_axes.named()[axis].location
    return replace(parameters, environment=replace(parameters.environment, location=location))


class FurtherAxis:
    """
    Synchroniser and pipeline of one axis.

    Parameters
    ----------
    parameters : EstimationParameters
        Those of `parameters_of_axis`.

    """

    def __init__(self, parameters: EstimationParameters) -> None:
        self.synchroniser = Synchroniser(parameters.synchronisation)
        self.pipeline = EstimationPipeline(parameters)
        self.samples: deque[ContactSample] = deque()

    def process(self, count: int) -> list[Estimate]:
        """Estimate from the oldest samples."""
        return self.pipeline.process_run([self.samples.popleft() for _ in range(count)])


class FurtherAxes:
    """
    The axes beside the contact axis, which leads: its synchroniser decides, and they follow.

    Decisions depend on stamps alone once every component is a measurement, so all take the same.

    Parameters
    ----------
    parameters : EstimationParameters
        All parameters.

    """

    def __init__(self, parameters: EstimationParameters) -> None:
        self._axes = {
            axis: FurtherAxis(parameters_of_axis(parameters, axis))
            for axis in parameters.further_axes.named()
        }
        self._limits = parameters.synchronisation

    def __bool__(self) -> bool:
        """Tell whether there is any."""
        return bool(self._axes)

    @property
    def pipelines(self) -> dict[str, EstimationPipeline]:
        """The pipelines by axis."""
        return {name: axis.pipeline for name, axis in self._axes.items()}

    def configure(self, parameters: EstimationParameters) -> None:
        """
        Take new parameters while running.

        Parameters
        ----------
        parameters : EstimationParameters
            All parameters.

        """
        self._limits = parameters.synchronisation
        for name, axis in self._axes.items():
            axis.synchroniser.configure(parameters.synchronisation)
            axis.pipeline.configure(parameters_of_axis(parameters, name))

    def reset(self) -> None:
        """Go back to the first guess on every axis."""
        for axis in self._axes.values():
            axis.pipeline.reset()

    def restart_time(self) -> None:
        """Accept stamps before the last one."""
        for axis in self._axes.values():
            axis.synchroniser.jumped = False
            axis.pipeline.restart_time()

    def set_biases(self, biases: Mapping[str, float]) -> None:
        """
        Take known forces for zero.

        Parameters
        ----------
        biases : mapping
            Axis to what is subtracted from its measured force [N].

        """
        for name, bias in biases.items():
            self._axes[name].pipeline.set_bias(bias)

    # -- readings ---------------------------------------------------------------------------

    def add_wrench(self, stamp_ns: int, forces: Sequence[float]) -> float:
        """
        Take the forces of the further axes.

        Parameters
        ----------
        stamp_ns : int
            Header stamp [ns].
        forces : sequence of float
            F_e of every axis, the contact axis first [N].

        Returns
        -------
        force : float
            For the contact axis [N]; no measurement where one of the others is none.

        """
        limit = self._limits.maximum_force
        for force in forces:
            if not abs(force) <= limit:
                forces = (force,) * len(forces)
                break
        for axis, force in zip(self._axes.values(), forces[1:]):
            axis.samples.extend(axis.synchroniser.add_wrench(stamp_ns, force))
        return forces[0]

    def add_motion(
        self, stamp_ns: int, positions: Sequence[float], velocities: Sequence[float]
    ) -> tuple[float, float]:
        """
        Take the motion of the further axes.

        Parameters
        ----------
        stamp_ns : int
            Header stamp [ns].
        positions, velocities : sequence of float
            Of every axis, the contact axis first [m], [m/s].

        Returns
        -------
        position, velocity : float
            For the contact axis; no measurement where one of the others is none.

        """
        motions = list(zip(positions, velocities))
        for motion in motions:
            if not self._is_measurement(*motion):
                motions = [motion] * len(motions)
                break
        for axis, motion in zip(self._axes.values(), motions[1:]):
            axis.samples.extend(axis.synchroniser.add_motion(stamp_ns, *motion))
        return motions[0]

    def _is_measurement(self, position: float, velocity: float) -> bool:
        limits, speed = self._limits, abs(velocity)
        too_fast = speed > limits.maximum_velocity and speed != inf  # infinite: not measured
        return abs(position) <= limits.maximum_position and not too_fast

    def add_pairs(
        self, stamps_ns: NDArray[np.int64], forces: Columns, positions: Columns,
        velocities: Columns,
    ) -> bool:
        """
        Take wrenches and joint readings that have the same stamps; see `Synchroniser.add_pairs`.

        Parameters
        ----------
        stamps_ns : ndarray of int64, shape (N,)
            Stamps of both [ns].
        forces, positions, velocities : sequence of ndarray, shape (N,)
            Of every axis, the contact axis first.

        Returns
        -------
        taken : bool
            False where they must be added one by one; nothing is taken then.

        """
        limits = self._limits
        measured = all(bool((np.abs(f) <= limits.maximum_force).all()) for f in forces) and all(
            bool((np.abs(x) <= limits.maximum_position).all()) for x in positions
        ) and not any(bool((np.abs(v) > limits.maximum_velocity).any()) for v in velocities)
        if not measured:
            return False
        columns = zip(forces[1:], positions[1:], velocities[1:])
        for axis, (force, position, velocity) in zip(self._axes.values(), columns):
            samples = axis.synchroniser.add_pairs(stamps_ns, force, position, velocity)
            if samples is None:  # the stamps decide, so the first refuses if any does
                return False
            axis.samples.extend(samples)
        return True

    # -- samples ----------------------------------------------------------------------------

    def process(self, count: int) -> list[tuple[Estimate, ...]]:
        """
        Estimate from the oldest samples, as many as the contact axis takes now.

        Parameters
        ----------
        count : int
            Number of samples.

        Returns
        -------
        estimates : list of tuple of Estimate
            For each sample the estimate of every further axis.

        """
        return list(zip(*(axis.process(count) for axis in self._axes.values())))
