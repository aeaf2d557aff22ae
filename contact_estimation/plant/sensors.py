# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Simulated measurements of force and position, with seeded noise."""

from __future__ import annotations

from typing import Iterator

import numpy as np

from .plant_parameters import PlantParameters
from .world import Truth

_BLOCK = 1024


class Sensors:
    """Noise on the sensed force; noise, then quantisation on the position."""

    def __init__(self, parameters: PlantParameters) -> None:
        self.configure(parameters)
        seeds = np.random.SeedSequence(parameters.seed).spawn(3)
        # One stream per signal: switching one noise off does not change the others.
        self._streams = [self._noise(np.random.default_rng(seed)) for seed in seeds]

    def configure(self, parameters: PlantParameters) -> None:
        """Change noise and quantisation while running."""
        self._p = parameters.sensors

    def _noise(self, generator: np.random.Generator) -> Iterator[float]:
        while True:
            uniform = self._p.distribution == 'uniform'
            if uniform:
                block = generator.uniform(-1.0, 1.0, _BLOCK)
            else:
                block = generator.standard_normal(_BLOCK)
            yield from block.tolist()

    def measure(self, truth: Truth) -> tuple[float, float, float]:
        """Return F_e [N], x [m] and its rate [m/s], NaN where velocity is not published."""
        p = self._p
        force = truth.sensed + p.force_noise * next(self._streams[0])
        position = truth.position + p.position_noise * next(self._streams[1])
        if p.position_quantisation > 0.0:
            position = round(position / p.position_quantisation) * p.position_quantisation
        velocity = truth.velocity + p.velocity_noise * next(self._streams[2])
        return force, position, velocity if p.publish_velocity else float('nan')
