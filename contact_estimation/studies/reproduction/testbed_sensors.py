# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Sensors of the testbed, and the acquisition of their samples: raw or as in the paper."""

from __future__ import annotations

from abc import ABC, abstractmethod
from math import nan

from .testbed_constants import TestbedConstants
from ...parameters.values import build
from ...plant.plant_parameters import PlantParameters
from ...plant.sensors import Sensors
from ...signals.filters import ButterworthBank


class Acquisition(ABC):
    """Processing of sensor samples before estimation."""

    @abstractmethod
    def process(self, force: float, position: float) -> tuple[float, float, float]:
        """
        Process one sample.

        force: F_e from the force sensor [N]
        position: deflection of the wall from the potentiometer [m]
        Returns force, position, velocity: input of the estimator [N], [m], [m/s]; NaN without a
        velocity
        """


class RawAcquisition(Acquisition):
    """Raw samples, for estimators that filter and differentiate themselves."""

    def process(self, force: float, position: float) -> tuple[float, float, float]:
        """Return force and position unchanged; see `Acquisition.process`."""
        return force, position, nan


class PaperAcquisition(Acquisition):
    """
    The paper's processing, section 5.1.

    All signals are Butterworth-filtered; the velocity is the filtered finite difference of the
    deflection; the static friction is subtracted from the force, whichever way the wall moves.
    """

    def __init__(self, constants: TestbedConstants) -> None:
        self._rate, self._friction = constants.sample_rate, constants.wall.static_friction
        self._filter = ButterworthBank(3, constants.sensing.filter_cutoff, self._rate)
        self._last = nan

    def process(self, force: float, position: float) -> tuple[float, float, float]:
        """Filter, differentiate, subtract; see `Acquisition.process`."""
        last = self._last if self._last == self._last else position
        self._last = position
        row = force, position, (position - last) * self._rate
        force, position, velocity = self._filter.take(row)
        return min(0.0, force + self._friction), position, velocity


def make_sensors(constants: TestbedConstants, seed: int) -> Sensors:
    """Build force sensor and potentiometer."""
    sensing = constants.sensing
    return Sensors(build(PlantParameters, {
        'sensors.force_noise': sensing.force_noise,
        'sensors.position_noise': sensing.potentiometer_noise,
        'sensors.position_quantisation': sensing.potentiometer_step,
        'sensors.publish_velocity': False,
        'sensors.distribution': 'uniform',
        'sample_rate': constants.sample_rate,
        'seed': seed,
    }))
