# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The wrench of an arm without its tool, as it is published."""

from __future__ import annotations

from collections import deque
from typing import NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray

from .parameters import EstimationParameters
from ..kinematics.contact_kinematics import ArmState
from ..signals.butterworth import ButterworthBank

Array = NDArray[np.float64]

_LONGEST_GAP_S = 0.1  # between samples, beyond which there is no acceleration


class _Instant(NamedTuple):
    """Static wrench (6,), R_s, and of the sensor's origin and the tool's centre x, v (2, 3)."""

    t: float
    wrench: Array
    R: Array
    points: Array
    rates: Array


class CompensatedWrench:
    """
    Take the inertia of the tool out of wrenches, consistently with what the estimator fits.

    With m = `physics.tool_inertia.mass` and c = `tool.centre`, the acceleration a_c of the tool's
    centre and a_o of the sensor's origin, the wrench of the contact is

        F_e = f + m R_s^T a_c           T_e = tau + m c x R_s^T a_o

    (`kinematics.tool_load`), where f, tau are without weight and bias. Accelerations are central
    differences over three samples: of velocities where all joints have them, else of positions.
    They belong to the middle sample, and an acceleration of one sample is mostly noise; so the
    wrench is averaged with the weights 1/4, 1/2, 1/4 over the same samples, and the sum passes the
    low-pass of the estimator. The two delays are the same for force and acceleration: one sample,
    and that of the filter (sqrt(2) / (2 pi f_c), 4.5 ms at 50 Hz).

    Without that mass the wrench is neither averaged nor filtered.
    """

    def __init__(self, parameters: EstimationParameters) -> None:
        mass = parameters.physics.tool_inertia.mass
        self._mass = mass if mass == mass else 0.0
        self._centre = np.array(parameters.tool.centre)
        self._filter = ButterworthBank(
            6, parameters.conditioning.cutoff_frequency, parameters.sample_rate)
        self._past: deque[_Instant] = deque(maxlen=3)
        self._settled = False

    def take(self, stamp_ns: int, state: ArmState) -> Sequence[float]:
        """
        Compensate the wrench of the next sample.

        stamp_ns: of the sample [ns]
        Returns wrench: force [N] and torque [N m] in the sensor's frame. After a gap, the first
        two are without inertia compensated.
        """
        if not self._mass:
            return [*state.wrench.tolist()]
        now, past = self._instant(stamp_ns * 1e-9, state), self._past
        if past and not 0.0 < now.t - past[-1].t < _LONGEST_GAP_S:
            past.clear()
            self._settled = False
        past.append(now)
        if len(past) < 3:
            return [*state.wrench.tolist()]
        row = self._averaged(*past).tolist()
        if not self._settled:
            self._settled = True
            self._filter.settle(row)
        return self._filter.take(row)

    def _instant(self, t: float, state: ArmState) -> _Instant:
        lever, centre = state.R @ state.sensor, state.R_sensor @ self._centre
        origin = state.p + lever
        velocity, omega = state.twist
        rate = velocity + np.cross(omega, lever)
        return _Instant(
            t, state.wrench, state.R_sensor, np.array([origin, origin + centre]),
            np.array([rate, rate + np.cross(omega, centre)]))

    def _averaged(self, first: _Instant, middle: _Instant, last: _Instant) -> Array:
        """Return the wrench at the middle sample."""
        step = 0.5 * (last.t - first.t)
        a = (last.rates - first.rates) / (2.0 * step)
        if not np.isfinite(a).all():
            a = (last.points - 2.0 * middle.points + first.points) / step**2
        of_origin, of_centre = self._mass * a @ middle.R  # in the sensor's frame
        inertial = np.concatenate([of_centre, np.cross(self._centre, of_origin)])
        wrench: Array = 0.25 * (first.wrench + 2.0 * middle.wrench + last.wrench)
        return wrench + inertial
