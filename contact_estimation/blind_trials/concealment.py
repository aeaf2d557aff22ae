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
How well an effect is concealed, and the magnitude that conceals it as well as asked.

Concealed r times: the force that a refitted spring-damper leaves in contact is, root mean square,
r times what it leaves in the same world without the effect. For effects of the robot: the residual
of eq. (1) with the nominal robot and central differences of the measured position, likewise.
"""

from __future__ import annotations

from math import hypot, sqrt
from typing import Callable, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .setups import Setup
from .simulation import Run

Array = NDArray[np.float64]

NEAR = 0.1
"""How far the degree of concealment may be from what is wanted."""

_RUNS = 9
_WINDOW_S, _GAP_S = 0.1, 0.3  # of the intervals in which an effect shows
_CLOSE = 0.02  # to end the search
_START = 0.03
_LEAST_STRENGTH = 1e-4  # below, nobody would call it an effect
_WIDEST = 12.0  # factor by which a strength grows or falls in one step


class Concealed(NamedTuple):
    """
    A magnitude and how well it is concealed.

    Attributes
    ----------
    strength : float
        From 0 to 1.
    degree : float
        The r of the definition.
    plain : bool
        Whether it shows too much however small it is, or jumps from nothing to too much.

    """

    strength: float
    degree: float
    plain: bool = False


def degree(port: str, setup: Setup, run: Run, without: Run) -> float:
    """
    Measure how well an effect is concealed.

    Parameters
    ----------
    port : str
        Where the effect acts.
    setup : Setup
        The world without it.
    run, without : Run
        With and without the effect, at the rate of the recording.

    Returns
    -------
    r : float
        Expected over the noise; 1 for no effect.

    """
    noise = _impedance_noise(setup) if port == 'robot' else setup.sensing.force_std
    left, before = (_rms(residual(port, setup, each)) for each in (run, without))
    return hypot(noise, left) / hypot(noise, before)


def residual(port: str, setup: Setup, run: Run) -> Array:
    """
    Give what a refitted spring-damper, or the nominal robot, leaves.

    Parameters
    ----------
    port, setup, run
        As for `degree`.

    Returns
    -------
    residual : ndarray, shape (N,)
        [N]; NaN where none is asked for.

    """
    return impedance_residual(setup, run) if port == 'robot' else contact_residual(setup, run)


def acting(left: Array, t: Array) -> list[tuple[float, float]]:
    """
    Tell when an effect shows.

    Parameters
    ----------
    left : ndarray, shape (N,)
        What it does, such as its `residual` [N]; NaN is as good as nothing.
    t : ndarray, shape (N,)
        Time, evenly spaced [s].

    Returns
    -------
    intervals : list of (float, float)
        In which that, root mean square over a tenth of a second, is more than half of
        that of the whole run [s]; what is closer together than 0.3 s is one interval.

    """
    left, h = np.nan_to_num(left), float(t[1] - t[0])
    if not left.any():
        return []
    width = max(1, round(_WINDOW_S / h))
    power = np.convolve(left**2, np.ones(width) / width, mode='same')
    strong = np.flatnonzero(power > 0.25 * float(np.mean(left[left != 0.0] ** 2)))
    breaks = np.flatnonzero(np.diff(strong) * h > _GAP_S) + 1
    return [(float(t[part[0]]), float(t[part[-1]]))
            for part in np.split(strong, breaks) if len(part)]


def contact_residual(setup: Setup, run: Run) -> Array:
    """
    Refit K_e and B_e to the force in contact and tell what they leave.

    Parameters
    ----------
    setup : Setup
        Of which the wall's location counts.
    run : Run
        Without noise.

    Returns
    -------
    left : ndarray, shape (N,)
        [N]; NaN where the wall neither acts nor is reached.

    """
    d = run.x - setup.wall.location
    phi: Array = -np.column_stack((d, run.v))  # eq. (7)
    pressing = (run.force < 0.0) & (d > 0.0)
    theta = np.linalg.lstsq(phi[pressing], run.sensed[pressing], rcond=None)[0]
    # Eq. (3): the refitted wall cannot pull.
    predicted = np.where(d > 0.0, np.minimum(0.0, phi @ theta), 0.0)
    touching = (d > 0.0) | (run.force != 0.0)
    return np.where(touching, run.sensed - predicted, np.nan)


def impedance_residual(setup: Setup, run: Run) -> Array:
    """
    Evaluate eq. (1) with the nominal robot.

    Parameters
    ----------
    setup : Setup
        The nominal robot.
    run : Run
        Without noise.

    Returns
    -------
    left : ndarray, shape (N,)
        M_t (a - xdd_r) + B_t (v - xd_r) + K_t (x - x_r) - F_e [N]; NaN at both ends.

    """
    robot, h = setup.robot, float(run.t[1] - run.t[0])
    v = np.gradient(run.x, h)
    a = np.gradient(v, h)
    left = (robot.mass * (a - run.a_r) + robot.damping * (v - run.v_r)
            + robot.stiffness * (run.x - run.x_r) - run.sensed)
    left[:2] = left[-2:] = np.nan
    return np.asarray(left)


def _impedance_noise(setup: Setup) -> float:
    """Tell what white noise of position and force makes of eq. (1) with central differences."""
    robot, sensing = setup.robot, setup.sensing
    h = 1.0 / sensing.rate
    taps = np.zeros(5)
    taps += robot.mass / (2.0 * h) ** 2 * np.array([1.0, 0.0, -2.0, 0.0, 1.0])
    taps += robot.damping / (2.0 * h) * np.array([0.0, -1.0, 0.0, 1.0, 0.0])
    taps[2] += robot.stiffness
    return hypot(sensing.position_std * sqrt(float(taps @ taps)), sensing.force_std)


def _rms(values: Array) -> float:
    return float(np.sqrt(np.nanmean(values**2)))


def conceal(degree_of: Callable[[float], float], wanted: float) -> Concealed:
    """
    Search the strength that conceals an effect as well as asked.

    What the effect leaves grows about as the strength, so a secant between logarithms is quick.

    Parameters
    ----------
    degree_of : callable
        Strength to r; a simulation each.
    wanted : float
        r, > 1.

    Returns
    -------
    concealed : Concealed
        The closest that was found, to 2 % where it can be had.

    """
    goal, strength = _excess(wanted), _START
    below: tuple[float, float] | None = None
    above: tuple[float, float] | None = None
    best = Concealed(0.0, 1.0)
    for _ in range(_RUNS):
        r = degree_of(strength)
        if abs(r - wanted) < abs(best.degree - wanted):
            best = Concealed(strength, r)
        at_end = strength == (1.0 if r < wanted else _LEAST_STRENGTH)
        if abs(r / wanted - 1.0) < _CLOSE or at_end:
            break
        if r < wanted:
            below = strength, _excess(r)
        else:
            above = strength, _excess(r)
        strength = min(1.0, max(_LEAST_STRENGTH, _next(below, above, goal)))
    plain = above is not None and abs(best.degree / wanted - 1.0) > NEAR
    return best._replace(plain=plain)


def _excess(r: float) -> float:
    """Give what the effect alone leaves, in units of what is left without it."""
    return sqrt(max(r * r - 1.0, 1e-6))


def _next(
    below: tuple[float, float] | None, above: tuple[float, float] | None, goal: float
) -> float:
    """Go along the secant of the logarithms where the goal is bracketed, else proportionally."""
    if below is not None and above is not None:
        slope = np.log(above[1] / below[1])
        share = float(np.clip(np.log(goal / below[1]) / max(slope, 1e-9), 0.05, 0.95))
        return float(below[0] * (above[0] / below[0]) ** share)
    last, excess = below or above or (_START, goal)
    return last * float(np.clip(goal / excess, 1.0 / _WIDEST, _WIDEST))
