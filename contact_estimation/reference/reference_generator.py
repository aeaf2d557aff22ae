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

"""The reference trajectory x_r, continuous under jumps of estimate and setpoint."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, isfinite, nan

from .laws import LAWS
from .limits import limited, PoseLimits
from .setpoints import Desired, Reference
from ..exceptions import ParameterRangeError
from ..parameters.specification import group, parameter, ParameterGroup


@dataclass(frozen=True)
class ReferenceParameters(ParameterGroup):
    """Conversion of a desired force into a reference position."""

    robot_stiffness: float = parameter(
        5000.0, 'K_t of the robot, used by the law `series`', 'N/m', minimum=1e-3
    )
    robot_force_tracking: bool = parameter(
        False, 'The robot adds F_r to its control force itself; excludes the law `series`'
    )
    stiffness_floor: float = parameter(
        500.0, 'Lower limit of K_hat in the laws, so that a bad estimate commands no large depth',
        'N/m', minimum=1e-3,
    )
    maximum_velocity: float = parameter(
        0.25, 'Limit of |dx_r/dt|, whether a force law is active or x_d passes through; must be '
        'above the speed of the planner, or x_r lags behind x_d', 'm/s', minimum=1e-6, maximum=1e6,
    )
    maximum_depth: float = parameter(
        nan, 'Limit of x_r beyond environment.location; NaN: no limit', 'm', minimum=0.0,
        nan_is_off=True,
    )
    fade_s: float = parameter(
        0.2, 'Time over which the offset between two laws fades out', 's',
        minimum=1e-3, maximum=60.0,
    )
    maximum_force_rate: float = parameter(
        2000.0, 'Faster changes of F_r are treated as steps, without feed-forward', 'N/s',
        minimum=0.0,
    )
    limits: PoseLimits = group(PoseLimits, 'Limits of ~/target_pose of an arm')


class ReferenceGenerator:
    """
    Convert setpoints of the planner into the reference that the robot follows.

    A force law applies while F_r is finite and there is contact; otherwise x_d passes through.
    Whenever that changes, the offset between old and new reference fades out smoothly. Position
    and rates always stay within the limits of `limits.limited`.

    Parameters
    ----------
    law : str
        Key of LAWS.
    parameters : ReferenceParameters
        Limits.
    period_s : float
        Nominal time between references [s].

    Attributes
    ----------
    limited : bool
        Whether a limit keeps the last reference away from what it should be.

    Raises
    ------
    ParameterRangeError
        If `series` is combined with force tracking by the robot.

    """

    def __init__(
        self, law: str, parameters: ReferenceParameters, period_s: float = 2e-3
    ) -> None:
        self._law, self._p, self._period_s = law, parameters, period_s
        refuse_double_tracking(law, parameters.robot_force_tracking)
        self.reset()

    def reset(self) -> None:
        """Discard the past: the next reference is not smoothed, unless `start` is called."""
        self._mode: str | None = None
        self._last: Reference | None = None
        self._offset, self._faded_s = 0.0, 0.0
        self.limited = False
        self._forces: list[tuple[float, float]] = []  # (time, F_r), at most three

    def start(self, position: float) -> None:
        """
        Start at the position of the robot, from which x_r then moves within its limits.

        Parameters
        ----------
        position : float
            Measured x [m]; finite.

        """
        self._last = Reference(position, 0.0, 0.0)

    def configure(
        self, law: str, parameters: ReferenceParameters, period_s: float = 2e-3
    ) -> None:
        """
        Change law or limits while running; x_r stays continuous.

        Parameters
        ----------
        law, parameters, period_s
            As for the constructor.

        Raises
        ------
        ParameterRangeError
            If `series` is combined with force tracking by the robot.

        """
        refuse_double_tracking(law, parameters.robot_force_tracking)
        if law != self._law or parameters != self._p:
            self._mode = None if self._last is None else 'changed'
        self._law, self._p, self._period_s = law, parameters, period_s

    def step(
        self, t: float, dt: float, desired: Desired, contact: bool, x_e: float, K_hat: float,
        deepest: float = inf,
    ) -> Reference:
        """
        Compute the reference of one instant.

        Parameters
        ----------
        t : float
            Time at which the robot follows it [s].
        dt : float
            Time since the last call [s].
        desired : Desired
            Setpoint at that time.
        contact : bool
            Whether there is contact.
        x_e : float
            Location of the wall [m].
        K_hat : float
            Estimated stiffness [N/m].
        deepest : float
            Largest x_r [m]; NaN: no limit.

        Returns
        -------
        reference : Reference
            Finite, continuous in position, within the limits.

        """
        position, velocity, acceleration, force = desired
        F_r_dot = F_r_ddot = 0.0
        if self._forces or isfinite(force):
            F_r_dot, F_r_ddot = self._differentiate(t, force)
        compliance = LAWS[self._law] if contact and isfinite(force) else None
        if compliance is not None:
            mode, C = self._law, compliance(
                max(K_hat, self._p.stiffness_floor), self._p.robot_stiffness)
            target = Reference(x_e + force * C, F_r_dot * C, F_r_ddot * C, force)
        else:
            mode, target = 'pass_through', Reference(position, velocity, acceleration)
        if mode != self._mode:
            self._switch(mode, dt, target)
        wanted = self._fade(dt, target) if self._offset else target
        last = self._last or wanted
        if not isfinite(last.position):
            last = Reference(0.0, 0.0, 0.0)
        new = limited(last, wanted, dt, self._period_s, self._p.maximum_velocity, deepest)
        self._last, self.limited = new, new.position != wanted.position
        return new

    def _differentiate(self, t: float, F_r: float) -> tuple[float, float]:
        past = self._forces
        if not isfinite(F_r):
            if past:
                past.clear()
            return 0.0, 0.0
        if past and t <= past[-1][0]:
            past.clear()
        if past and abs(F_r - past[-1][1]) > self._p.maximum_force_rate * (t - past[-1][0]):
            past.clear()
        past.append((t, F_r))
        if len(past) < 3:
            return 0.0, 0.0
        (t2, f2), (t1, f1), (t0, f0) = past
        del past[0]
        slope, before = (f0 - f1) / (t0 - t1), (f1 - f2) / (t1 - t2)
        curvature = 2.0 * (slope - before) / (t0 - t2)
        return slope + 0.5 * curvature * (t0 - t1), curvature

    def _switch(self, mode: str, dt: float, target: Reference) -> None:
        if self._mode is not None and self._last is not None:
            # Extrapolate the old reference by its velocity, so that the rate is continuous too.
            expected = self._last.position + dt * self._last.velocity
            offset = expected - target.position
            self._offset, self._faded_s = offset if isfinite(offset) else 0.0, 0.0
        self._mode = mode

    def _fade(self, dt: float, target: Reference) -> Reference:
        duration = self._p.fade_s
        s = self._faded_s / duration
        self._faded_s += dt
        if s >= 1.0:
            self._offset = 0.0
            return target
        o = self._offset
        return Reference(
            target.position + o * (1.0 - s * s * (3.0 - 2.0 * s)),
            target.velocity - o * 6.0 * s * (1.0 - s) / duration,
            target.acceleration - o * (6.0 - 12.0 * s) / duration**2, target.force,
        )


def refuse_double_tracking(law: str, force_tracking: bool) -> None:
    """
    Refuse the law `series` on a robot that tracks force itself.

    Parameters
    ----------
    law : str
        Name of the law.
    force_tracking : bool
        Whether the robot adds F_r to its control force.

    Raises
    ------
    ParameterRangeError
        If both are chosen: 74.5 N result instead of 50 N on the benchmark.

    """
    if law == 'series' and force_tracking:
        raise ParameterRangeError(
            'reference_law series and a robot with force_tracking both correct for K_t, which '
            'together results in about 1.5 times the force; expected one of them, got both; use '
            'reference_law eq20 with force tracking, or switch force_tracking off'
        )
