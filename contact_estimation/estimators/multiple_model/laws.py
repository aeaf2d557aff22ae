# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
The laws of a contact as columns of one table, in which all of them are linear.

With y = x - x0 and smoothing kernels S0, S1, S2 that average, differentiate once and twice, a
contact obeys, whatever its law, S0 f = phi^T theta with at most six columns of the table:

    Kelvin-Voigt     K S0 y + B S1 y + M S2 y + s S0 1
    with friction    ... + F_c S0 sgn v
    yielding         ... - R S0 max y, the greatest depth so far
    moving wall      ... + c (t + B / K), t being the time until now
    curved           K S0 y + c S0 (y^2 / D - y) + d S0 (y^3 / D^2 - y) + B S1 y - k S1 f + s S0 1
    Hunt-Crossley    K S0 y^n + chi S1 y^(n+1) / (n+1) - k S1 f + s S0 n y^(n-1)

since y^n y' = (y^(n+1))' / (n+1). K is the secant at the mean depth D of late. s = -K delta moves
the surface by delta. The lag tau of the sensor is undone by f + tau f' under the last two, where
k stands for what is wrong with tau; in the others it adds -K tau to B and c K tau^2 - B tau to M.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .constants import (
    DAMPING_S, DAMPING_STD_S, FRICTION_N, MASS_KG, POLES_STD, SPEED, TWO_POLES, UNLIKELY)

Array = NDArray[np.float64]
Ints = NDArray[np.int_]

(ONE, DEPTH, RATE, ACCELERATION, SIGN, SQUARE_RATE, POWER, POWER_RATE, POWER_DAMPING, POWER_SLOPE,
 POWER_CURVE, SQUARE, CUBE, CUBE_RATE, SET, ZERO, FORCE, FORCE_RATE, NOISE, RATE_NOISE,
 ACCELERATION_NOISE, TIME) = range(22)
"""Columns: S0 1, S0 y, S1 y, S2 y, S0 sgn v, S1 y^2 / 2, S0 y^1.5, S1 y^1.5, S1 y^2.5 / 2.5,
S0 1.5 y^0.5, S0 0.75 y^-0.5, S0 y^2, S0 y^3, S1 y^3 / 3, -S0 of the greatest y so far, 0, S0 f,
S1 f, the standard deviations of S0 y, S1 y and S2 y, whose squares say how much of the scatter
of each is noise, and the time until now plus B_e / K_e."""

COLUMNS = 22
OF_DEPTH = [DEPTH, POWER, POWER_SLOPE, POWER_CURVE, SQUARE, CUBE]
"""Columns that are functions of the depth."""

OF_RATE = [RATE, SQUARE_RATE, POWER_RATE, POWER_DAMPING, CUBE_RATE]
TIMES_RATE = [ONE, DEPTH, POWER_SLOPE, POWER, SQUARE]
"""Columns of the rate, and what each of them is a steady rate times."""

UNKNOWNS = 6


class Law(NamedTuple):
    """One law."""

    # those of stiffness, damping, third coefficient, surface, and two more
    columns: tuple[int, int, int, int, int, int]
    exponent: float  # n
    prior: float  # probability before any contact


_LINEAR = DEPTH, RATE, ACCELERATION, ONE, ZERO, ZERO
_MOVING = DEPTH, RATE, ACCELERATION, ONE, TIME, ZERO
LAWS = {
    'kelvin_voigt': Law(_LINEAR, 1.0, 0.67),
    'mass': Law(_LINEAR, 1.0, 0.06),
    'friction': Law((DEPTH, RATE, ACCELERATION, ONE, SIGN, ZERO), 1.0, 0.06),
    'hunt_crossley_1': Law((DEPTH, SQUARE_RATE, FORCE_RATE, ONE, ZERO, ZERO), 1.0, 0.06),
    'hunt_crossley_1.5': Law(
        (POWER, POWER_DAMPING, FORCE_RATE, POWER_SLOPE, ZERO, ZERO), 1.5, 0.06),
    'hunt_crossley_2': Law((SQUARE, CUBE_RATE, FORCE_RATE, DEPTH, ZERO, ZERO), 2.0, 0.06),
    'curved': Law((DEPTH, RATE, FORCE_RATE, ONE, SQUARE, CUBE), 1.0, 0.03),
    # Loading alone never tells it: it counts where the data speak for it.
    'yielding': Law((DEPTH, RATE, ACCELERATION, ONE, SET, ZERO), 1.0, 0.5 * UNLIKELY),
    # A wall that moved once and for all has changed; this one goes on moving.
    'moving_wall': Law(_MOVING, 1.0, 1e-4),
    'creeping_wall': Law(_LINEAR, 1.0, 1e-4),
    'drifting_stiffness': Law(_LINEAR, 1.0, 1e-4),
}
"""By name; to add one: its columns, and a row here."""

NAMES = tuple(LAWS)
KELVIN_VOIGT, MASS, FRICTION, BENT, YIELDING, MOVING, CREEPING, DRIFTING = (
    NAMES.index(name) for name in (
        'kelvin_voigt', 'mass', 'friction', 'curved', 'yielding', 'moving_wall', 'creeping_wall',
        'drifting_stiffness'))
LOG_PRIOR: Array = np.log([law.prior for law in LAWS.values()])
EXPONENT: Array = np.array([law.exponent for law in LAWS.values()])
DEEP = np.array([name.startswith('hunt') for name in NAMES])
"""Which laws damp with the depth."""

LATE = np.array([FORCE_RATE in law.columns for law in LAWS.values()])
"""Under which laws f + tau f' stands for f."""

IMPARTIAL: Array = np.where(DEEP, LAWS['kelvin_voigt'].prior / np.exp(LOG_PRIOR), 1.0)
"""What the probabilities are multiplied by where a wall is as likely to be curved as not."""

CURVED = EXPONENT != 1.0
"""Which laws are linear in a shift of the surface only where it is small beside the depth."""

POWERS: Array = np.stack([EXPONENT - 1.0, np.where(DEEP, EXPONENT, 0.0)])
"""Powers of the depth that K_e and B_e of each law grow with, shape (2, N)."""

CHOSEN: Ints = np.array([(*law.columns, FORCE) for law in LAWS.values()])
# n y^(n-1) and S1 y^n of n = 2 are twice the columns that they share with other laws.
_TWICE = np.where(EXPONENT == 2.0, 2.0, 1.0)


def scales(laws: Ints, depth: float) -> Array:
    """
    Return what the columns are multiplied by, so that coefficients are K and B at a depth.

    K_n y^n = (K_n depth^(n-1)) (y^n / depth^(n-1)): the secant stiffness at the depth.

    laws (N,): indices of NAMES
    depth: mean penetration [m], > 0
    Returns scales (N, 7): of the columns of `CHOSEN`
    """
    return _scales(depth)[laws]


@lru_cache(maxsize=2)
def _scales(depth: float) -> Array:
    """Return the scales of all laws, shape (N, 7)."""
    power = depth ** (1.0 - EXPONENT)
    found = np.ones((len(NAMES), UNKNOWNS + 1))
    found[:, 0] = power
    found[:, 1] = np.where(DEEP, depth ** -EXPONENT, 1.0)
    found[:, 3] = power * _TWICE
    found[BENT, 4:6] = 1.0 / depth, 1.0 / (depth * depth)
    return found


def prior(laws: Ints, K: Array, damping: float, lag: tuple[float, float]) -> tuple[Array, Array]:
    """
    Return means and standard deviations of the coefficients but those of K and the surface.

    laws (N,): indices of NAMES
    K (N,): scale of the stiffness [N/m]
    damping: B_e / K_e as estimated so far [s]
    lag: tau of the force sensor and its standard deviation [s]
    Returns mean, std (N, 6): those of K and s are 0 and 1, to be set by the caller
    """
    per_K, mean, width = _priors(damping, *lag)
    scale = K[:, None]
    return mean[laws] * scale, np.where(per_K[laws], width[laws] * scale, width[laws])


@lru_cache(maxsize=2)
def _priors(damping: float, tau: float, std: float) -> tuple[NDArray[np.bool_], Array, Array]:
    """Return which deviations are per N/m of stiffness, means and deviations of all laws."""
    mean, width = np.zeros((len(NAMES), UNKNOWNS)), np.ones((len(NAMES), UNKNOWNS))
    per_K = np.zeros(mean.shape, bool)
    mean[:, 1], width[:, 1], per_K[:, 1] = DAMPING_S, DAMPING_STD_S, True
    # A lag makes K y + B y' to K y + (B - K tau) y' + (c K tau^2 - B tau) y'' + ...
    alike = ~LATE
    alike[MASS] = False
    mean[alike, 2] = TWO_POLES * tau * tau - damping * tau
    width[alike, 2] = (damping + tau) * std + POLES_STD * tau * tau + 1e-9
    per_K[alike, 2] = True
    width[LATE, 2], width[MASS, 2], width[FRICTION, 4] = std + 1e-6, MASS_KG, FRICTION_N
    width[BENT, 4:6], per_K[BENT, 4:6] = 1.0, True
    width[MOVING, 4], per_K[MOVING, 4] = SPEED, True
    width[YIELDING, 4], per_K[YIELDING, 4] = 0.5, True
    return per_K, mean, width


def shifted_table(delta: float) -> Array:
    """
    Return the matrix that moves the reference x0 of the columns.

    (y - delta)^n = y^n - n delta y^(n-1) + ...: exact for n = 1 and 2, else to second order.

    delta: how far into the wall [m]
    Returns matrix (22, 22): new columns from old ones
    """
    matrix = np.eye(COLUMNS)
    for column, source, factor in (
        (DEPTH, ONE, -delta), (SQUARE_RATE, RATE, -delta), (POWER, POWER_SLOPE, -delta),
        (POWER, POWER_CURVE, 0.5 * delta * delta), (POWER_SLOPE, POWER_CURVE, -delta),
        (POWER_DAMPING, POWER_RATE, -delta), (SQUARE, DEPTH, -2.0 * delta),
        (SQUARE, ONE, delta * delta), (CUBE_RATE, SQUARE_RATE, -2.0 * delta),
        (CUBE_RATE, RATE, delta * delta), (CUBE, SQUARE, -3.0 * delta),
        (CUBE, DEPTH, 3.0 * delta * delta), (CUBE, ONE, -delta**3), (SET, ONE, delta),
    ):
        matrix[column, source] = factor
    return matrix
