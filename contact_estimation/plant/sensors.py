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

"""What force and position sensors make of the truth, seeded."""

from __future__ import annotations

from typing import Iterator

import numpy as np

from .plant_parameters import PlantParameters
from .world import Truth
from ..physics import effects_that_are_on
from ..physics.physics import ForceSensorEffect

_BLOCK = 1024


class Sensors:
    """
    Force sensor with its physics, then noise; position with noise, then quantisation.

    Parameters
    ----------
    parameters : PlantParameters
        Noise, quantisation, seed and physics.

    """

    def __init__(self, parameters: PlantParameters) -> None:
        self.configure(parameters)
        self._last_t: float | None = None
        seeds = np.random.SeedSequence(parameters.seed).spawn(3)
        # One stream a signal: switching one noise off leaves the others as they were.
        self._streams = [self._noise(np.random.default_rng(seed)) for seed in seeds]

    def configure(self, parameters: PlantParameters) -> None:
        """
        Change noise and quantisation while running.

        Parameters
        ----------
        parameters : PlantParameters
            The new values.

        """
        self._p = parameters.sensors
        effects = effects_that_are_on(parameters.physics)
        self._chain = [e for e in effects if isinstance(e, ForceSensorEffect)]

    def _noise(self, generator: np.random.Generator) -> Iterator[float]:
        while True:
            uniform = self._p.distribution == 'uniform'
            if uniform:
                block = generator.uniform(-1.0, 1.0, _BLOCK)
            else:
                block = generator.standard_normal(_BLOCK)
            yield from block.tolist()

    def measure(self, truth: Truth) -> tuple[float, float, float]:
        """
        Measure once.

        Parameters
        ----------
        truth : Truth
            The world now.

        Returns
        -------
        force, position, velocity : float
            F_e [N], x [m] and its rate [m/s], NaN where velocity is not published.

        """
        p = self._p
        dt = 0.0 if self._last_t is None else truth.t - self._last_t
        self._last_t = truth.t
        force = truth.force
        for effect in self._chain:
            force = effect.sense(truth.t, dt, force, truth.acceleration)
        force += p.force_noise * next(self._streams[0])
        position = truth.position + p.position_noise * next(self._streams[1])
        if p.position_quantisation > 0.0:
            position = round(position / p.position_quantisation) * p.position_quantisation
        velocity = truth.velocity + p.velocity_noise * next(self._streams[2])
        return force, position, velocity if p.publish_velocity else float('nan')
