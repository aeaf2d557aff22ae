# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Stability of the present gains on the wall as it is estimated, for `~/stability`."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from math import isfinite, nan

from .stable_gains import ADMITTANCE, IMPEDANCE, stable_gains, StableGains
from ..parameters import parameter, ParameterGroup

OFF, STABILITY = 'off', 'stability'
_CHANGE = 0.05  # of K_e, B_e, or of a deviation by the value, from which the margin is new


@dataclass(frozen=True)
class StabilityParameters(ParameterGroup):
    """The impedance or admittance of the robot along the normal, for `~/stability`."""

    kind: str = parameter(
        OFF, 'What the controller is: an admittance turns force into motion, an impedance motion '
        'into force; off: nothing is judged', choices=(OFF, ADMITTANCE, IMPEDANCE))
    mass: float = parameter(1.0, 'M_t', 'kg', minimum=1e-6)
    damping: float = parameter(0.0, 'B_t', 'N s/m', minimum=0.0)
    stiffness: float = parameter(0.0, 'K_t', 'N/m', minimum=0.0)
    sample_time: float = parameter(0.002, 'Period of the controller', 's', minimum=1e-6)
    delay: float = parameter(
        0.0, 'From the measurement until the robot moves accordingly, without the hold of a '
        'sample', 's', minimum=0.0)
    phase_margin: float = parameter(
        45.0, 'Wanted margin, for the least damping and the warning', 'deg', minimum=0.0,
        maximum=90.0)


class StabilityWatch:
    """
    Judge the gains again where the wall, or what is known of it, has changed.

    gains: as judged last; None while no wall is known
    """

    def __init__(self) -> None:
        self.gains: StableGains | None = None
        self._judged: tuple[StabilityParameters, tuple[float, ...]] | None = None

    def take(
        self, robot: StabilityParameters, K_e: float, K_e_std: float, B_e: float, B_e_std: float
    ) -> float:
        """
        Return the least phase margin within two standard deviations of the wall [deg].

        robot: the present gains
        K_e, K_e_std, B_e, B_e_std: the wall and its standard deviations; not finite where nothing
        is known
        Returns margin: negative where the loop is unstable; NaN where it is off or no wall is
        known
        """
        wall = K_e, K_e_std, B_e, B_e_std
        if robot.kind == OFF or not all(map(isfinite, wall)):
            self.gains = self._judged = None
            return nan
        if self.gains is None or not self._known(robot, wall):
            self.gains, self._judged = judged(robot, *wall), (robot, wall)
        return self.gains.least_phase_margin

    def _known(self, robot: StabilityParameters, wall: tuple[float, ...]) -> bool:
        assert self._judged is not None
        of_robot, before = self._judged
        sizes = wall[0], wall[0], wall[2] + wall[3], wall[2] + wall[3]
        return robot == of_robot and all(
            abs(a - b) <= _CHANGE * size for a, b, size in zip(wall, before, sizes))

    @property
    def values(self) -> dict[str, float]:
        """Margins, least damping and stiffest wall by name, for the diagnostics."""
        return {} if self.gains is None else {
            name: float(getattr(self.gains, name)) for name in (
                'phase_margin', 'least_phase_margin', 'least_damping', 'stiffest_wall')}

    def text(self, robot: StabilityParameters) -> str:
        """Return what to do where the margin is less than wanted; '' where it is not."""
        gains = self.gains
        if gains is None or gains.least_phase_margin >= robot.phase_margin:
            return ''
        raised = gains.least_damping
        remedy = (f'raise stability.damping (B_t) to {raised:.3g} N s/m' if raised > robot.damping
                  else f'lower it to about {raised:.3g} N s/m' if raised == raised
                  else 'no damping gives the wanted margin; lower delay or stiffness, raise M_t')
        what = 'may be unstable' if not gains.stable else (
            f'has a phase margin of {gains.least_phase_margin:.3g} deg, less than '
            f'{robot.phase_margin:g},')
        return (f'the {robot.kind} {what} on this wall (it bears {gains.stiffest_wall:.3g} N/m); '
                f'{remedy}')


def judged(
    robot: StabilityParameters, K_e: float, K_e_std: float, B_e: float, B_e_std: float
) -> StableGains:
    own = asdict(robot)
    M_t, B_t, K_t = (own.pop(name) for name in ('mass', 'damping', 'stiffness'))
    return stable_gains(K_e, B_e, M_t=M_t, B_t=B_t, K_t=K_t, K_e_std=K_e_std, B_e_std=B_e_std,
                        **own)
