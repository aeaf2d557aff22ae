# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""What is published of an arm: its reference as a full pose, the wrench without the tool."""

from collections import deque
from math import inf, isfinite
from typing import NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray

from .axes import Result
from .parameters import EstimationParameters
from ..exceptions import ParameterRangeError
from ..kinematics.contact_kinematics import ArmState
from ..reference.parameters import PoseLimits
from ..signals.filters import ButterworthBank


class TargetPose(NamedTuple):
    """A pose of the tip in the base frame."""

    stamp_ns: int  # instant from which it holds [ns]
    position: Sequence[float]  # of the tip's origin [m]
    quaternion: Sequence[float]  # x, y, z, w


def check_target_pose(parameters: EstimationParameters) -> None:
    """Check that x_r determines a pose."""
    if not parameters.kinematics.tip:
        raise ParameterRangeError(
            'publish_target_pose needs the pose of an arm, but kinematics.tip is empty; set '
            'kinematics.base, kinematics.tip and contact.normal, or let the controller of a '
            'single axis follow reference_trajectory'
        )
    if parameters.contact.normal_frame != 'base':
        raise ParameterRangeError(
            'publish_target_pose needs contact.normal_frame base, got '
            f'{parameters.contact.normal_frame!r}: x_r is a coordinate along a normal that does '
            'not turn with the tool'
        )


def target_pose(result: Result, limits: PoseLimits) -> TargetPose | None:
    """Return the measured pose with only the coordinate along the normal replaced by x_r."""
    arm, reference = result.arm, result.reference
    if arm is None or reference is None:
        return None
    normal, measured = arm.normal.tolist(), arm.p.tolist()
    step = step_along(measured, normal, reference.position - result.sample.position, limits)
    if step is None:
        return None
    from scipy.spatial.transform import Rotation  # slow to import, and only arms need it

    position = [p + step * n for p, n in zip(measured, normal)]
    quaternion = Rotation.from_matrix(arm.R).as_quat().tolist()
    return TargetPose(result.reference_stamp_ns, position, quaternion)


def step_along(
    position: Sequence[float], normal: Sequence[float], step: float, limits: PoseLimits
) -> float | None:
    """
    Return the step along the normal that is nearest to a wanted one within the limits.

    position: measured [m]
    step: wanted [m]
    Returns step: in [m]; None where no step leads into the box, or the wanted one is not finite
    """
    if not isfinite(step):
        return None
    low, high = -limits.lead, limits.lead
    for p, n, lower, upper in zip(position, normal, limits.lower, limits.upper):
        if abs(n) < 1e-9:
            ends = (-inf, inf) if lower <= p <= upper else (inf, -inf)
        else:
            ends = ((lower - p) / n, (upper - p) / n)
            ends = (min(ends), max(ends))
        low, high = max(low, ends[0]), min(high, ends[1])
    return min(max(step, low), high) if low <= high else None


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
