# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Which impedance or admittance is stable on a wall, with delay and sampling."""

from dataclasses import asdict, dataclass, replace
from itertools import product
from math import inf, isfinite, nan, pi, sqrt
from typing import Callable

import numpy as np
from numpy.typing import NDArray

from ..exceptions import ParameterRangeError, UnknownNameError
from ..parameters import parameter, ParameterGroup
from ..physics.numeric import Array

ADMITTANCE, IMPEDANCE = 'admittance', 'impedance'
_BAND = 2.0  # standard deviations
_DECADES, _STEPS = 3.0, 61  # of a search in both directions, and its points
_FREQUENCIES = 800
_MOST_DELAY = 1000  # samples


@dataclass(frozen=True)
class StableGains:
    """
    Stability of a robot on a wall; margins are the worst within two standard deviations.

    Attributes
    ----------
    stable : bool
        Whether the loop is stable for all walls of the band.
    phase_margin : float
        Further phase lag at which a loop of the nominal wall becomes unstable [deg]; negative
        where it is unstable; 180 where the gain never reaches 1.
    least_phase_margin : float
        The same for the worst wall of the band [deg].
    damping_ratio : float
        Of the slowest pole on the nominal wall.
    least_damping : float
        Smallest B_t whose least phase margin is the one wanted [N s/m]; 0 if none is needed, NaN
        if none suffices.
    stiffest_wall : float
        K_e at which the loop becomes unstable with these gains [N/m]; inf if at none below 1000
        times the nominal one.

    """

    stable: bool
    phase_margin: float
    least_phase_margin: float
    damping_ratio: float
    least_damping: float
    stiffest_wall: float


def stable_gains(
    K_e: float, B_e: float, *, M_t: float, B_t: float, K_t: float, sample_time: float,
    delay: float = 0.0, K_e_std: float = 0.0, B_e_std: float = 0.0, kind: str = ADMITTANCE,
    phase_margin: float = 45.0,
) -> StableGains:
    """
    Judge the gains of a robot on a wall, and find the least damping for a wanted margin.

    The wall is attached: F_e = -(K_e x + B_e v), as while contact lasts. An *admittance* turns the
    measured force into motion, M_t a + B_t v + K_t x = F, which the robot follows: the loop is
    (K_e + B_e s) / (M_t s^2 + B_t s + K_t). An *impedance* turns measured motion into the force
    -(K_t x + B_t v) on a robot of mass M_t: (K_t + B_t s) / (M_t s^2 + B_e s + K_e). Measured
    values are held for a sample and act after the delay. Without both, the loop has the
    characteristic polynomial M_t s^2 + (B_t + B_e) s + K_t + K_e in either case, whose damping
    ratio Love and Book ("Environment estimation for enhanced impedance control", ICRA 1995)
    choose by B_t. Here it is discretised exactly (Astrom and Wittenmark, "Computer-Controlled
    Systems", sampling of systems with time delays), and stable where all poles lie in the unit
    circle.

    Parameters
    ----------
    K_e, B_e : float
        Stiffness [N/m] and damping [N s/m] of the wall, such as those of an `Estimate`.
    M_t, B_t, K_t : float
        Mass [kg], damping [N s/m] and stiffness [N/m] of the robot.
    sample_time : float
        Period of the controller [s].
    delay : float
        From the measurement until the robot moves accordingly, without the hold of a sample [s].
    K_e_std, B_e_std : float
        Standard deviations of K_e and B_e.
    kind : {'admittance', 'impedance'}
        What the controller turns into what.
    phase_margin : float
        Wanted for `least_damping` [deg].

    Returns
    -------
    gains : StableGains
        Margins and least damping.

    Raises
    ------
    ParameterRangeError
        If a value is out of range.
    UnknownNameError
        If there is no such `kind`.

    """
    _check_ranges(locals())
    loop = _Loop(kind, M_t, B_t, K_t, K_e, B_e, sample_time, delay)
    walls = [replace(loop, K_e=max(0.0, K_e + k * K_e_std), B_e=max(0.0, B_e + b * B_e_std))
             for k, b in product((-_BAND, 0.0, _BAND), repeat=2)]

    margins = {wall: wall.phase_margin() for wall in walls}
    walls.sort(key=margins.__getitem__)  # the first that fails decides, mostly the worst

    def suffices(B_t: float) -> bool:
        return all(replace(wall, B_t=B_t).phase_margin() >= phase_margin for wall in walls)

    return StableGains(
        all(wall.poles_radius() < 1.0 for wall in walls), loop.phase_margin(),
        min(margins.values()), loop.damping_ratio(),
        _first(suffices, 2.0 * sqrt(M_t * (K_t + K_e)), nan),
        _first(lambda value: replace(loop, K_e=value).poles_radius() >= 1.0, max(K_e, 1.0), inf))


def _check_ranges(given: dict[str, object]) -> None:
    if given['kind'] not in (ADMITTANCE, IMPEDANCE):
        raise UnknownNameError.among('kind', given['kind'], (ADMITTANCE, IMPEDANCE))
    for name, value in given.items():
        if name == 'kind':
            continue
        positive = name in ('M_t', 'sample_time')
        assert isinstance(value, (int, float))
        if not isfinite(value) or value < 0.0 or positive and value == 0.0:
            raise ParameterRangeError(
                f'{name} must be a number {">" if positive else ">="} 0 in SI units, got '
                f'{value!r}; give the estimate and the gains of the controller')
    delay, sample_time = float(str(given['delay'])), float(str(given['sample_time']))
    if delay > _MOST_DELAY * sample_time:
        raise ParameterRangeError(
            f'delay must be at most {_MOST_DELAY} times sample_time, got {delay:g} and '
            f'{sample_time:g} s; check the units')


def _first(holds: Callable[[float], bool], scale: float, otherwise: float) -> float:
    """Return the smallest value at which a condition holds, near some scale; 0 if far below."""
    values = scale * np.logspace(-_DECADES, _DECADES, _STEPS)
    high = next((place for place, value in enumerate(values) if holds(value)), None)
    if not high:
        return otherwise if high is None else 0.0
    below, above = float(values[high - 1]), float(values[high])
    while above - below > 1e-4 * above:
        middle = 0.5 * (below + above)
        below, above = (below, middle) if holds(middle) else (middle, above)
    return above


@dataclass(frozen=True)
class _Loop:
    """A second-order system with sampled, held and delayed feedback."""

    kind: str
    M_t: float
    B_t: float
    K_t: float
    K_e: float
    B_e: float
    sample_time: float
    delay: float

    def _parts(self) -> tuple[Array, Array, Array, Array, int]:
        """Return Phi, Gamma_0, Gamma_1, the feedback row and the whole samples of delay."""
        physical, fed_back = (self.K_t, self.B_t), (self.K_e, self.B_e)
        if self.kind == IMPEDANCE:
            physical, fed_back = fed_back, physical
        system = np.zeros((3, 3))  # of x, v and the held input
        system[0, 1] = 1.0
        system[1] = np.array([-physical[0], -physical[1], 1.0]) / self.M_t
        samples = int(self.delay / self.sample_time + 1e-9)
        rest = max(0.0, self.delay - samples * self.sample_time)
        from scipy.linalg import expm  # slow to import, and seldom needed
        late, early = expm(system * rest), expm(system * (self.sample_time - rest))
        return (early[:2, :2] @ late[:2, :2], early[:2, 2], early[:2, :2] @ late[:2, 2],
                np.array(fed_back), samples)

    def _poles(self) -> NDArray[np.complex128]:
        """Return the poles; the inputs of the last samples are states."""
        Phi, Gamma_0, Gamma_1, row, samples = self._parts()
        size = 3 + samples
        closed = np.zeros((size, size))  # x, v, u[k - 1], u[k - 2], ...
        closed[:2, :2], closed[2, :2] = Phi, -row
        for k in range(samples):
            closed[3 + k, 2 + k] = 1.0
        if samples == 0:
            closed[:2, :2] -= np.outer(Gamma_0, row)
        else:
            closed[:2, 1 + samples] += Gamma_0
        closed[:2, 2 + samples] += Gamma_1
        return np.asarray(np.linalg.eigvals(closed), np.complex128)

    def poles_radius(self) -> float:
        """Return the largest absolute value of a pole."""
        return float(np.max(np.abs(self._poles())))

    def damping_ratio(self) -> float:
        """Return the damping ratio of the slowest pole."""
        poles = self._poles()
        s = np.log(poles[np.argmax(np.abs(poles))])
        return float(-s.real / abs(s))

    def phase_margin(self) -> float:
        """Return the least lag, or lead where unstable, that makes the loop reach -1 [deg]."""
        Phi, Gamma_0, Gamma_1, row, samples = self._parts()
        slowest = min(1.0, 1e-3 * sqrt((self.K_t + self.K_e) / self.M_t) * self.sample_time)
        z = np.exp(1j * np.geomspace(max(slowest, 1e-9), pi, _FREQUENCIES))
        inputs = (Gamma_0[:, None] + Gamma_1[:, None] / z) / z**samples  # (2, N)
        (a, b), (c, d) = Phi
        determinant = (z - a) * (z - d) - b * c
        x, v = (((z - d) * inputs[0] + b * inputs[1]) / determinant,
                (c * inputs[0] + (z - a) * inputs[1]) / determinant)
        loop = row[0] * x + row[1] * v
        crossings = np.flatnonzero(np.diff(np.abs(loop) > 1.0))
        if not len(crossings):
            return 180.0 if self.poles_radius() < 1.0 else -180.0
        gain = np.log(np.abs(loop))
        share = gain[crossings] / (gain[crossings] - gain[crossings + 1])
        phase = np.unwrap(np.angle(loop))
        to_minus_one = pi + phase[crossings] + share * (phase[crossings + 1] - phase[crossings])
        if self.poles_radius() < 1.0:
            return float(np.degrees(np.min(np.mod(to_minus_one, 2.0 * pi))))
        return float(-np.degrees(np.min(np.mod(-to_minus_one, 2.0 * pi))))


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
        """Return the least phase margin within two standard deviations [deg], NaN if unknown."""
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
        return (f'the {robot.kind} {what} on this wall (stable to {gains.stiffest_wall:.3g} N/m); '
                f'{remedy}')


def judged(
    robot: StabilityParameters, K_e: float, K_e_std: float, B_e: float, B_e_std: float
) -> StableGains:
    own = asdict(robot)
    M_t, B_t, K_t = (own.pop(name) for name in ('mass', 'damping', 'stiffness'))
    return stable_gains(K_e, B_e, M_t=M_t, B_t=B_t, K_t=K_t, K_e_std=K_e_std, B_e_std=B_e_std,
                        **own)
