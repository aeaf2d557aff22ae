# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Where the first contact began, where nobody has said it and known forces act beside the wall."""

from collections import deque
from math import hypot, inf
from operator import itemgetter
from typing import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from ..estimators.multiple_model import CONTACT, FREE

Array = NDArray[np.float64]

_LONGEST_S = 0.25  # of the rise of the force that is looked at
_CLEAR = 20.0  # standard deviations of the noise: the force has risen enough
_LEAST = 10  # samples
_APPROACH = 50  # samples before the contact
_SINGULAR = 1e-12  # of two columns: rounding alone tells them apart
_BETWEEN = 17  # places tried between the samples next to the best

KnownForces = Callable[[float, int], Sequence[float]]


class FirstTouch:
    """
    Follow the force of a touch-down until it has risen, then find where it began.

    known_forces: from a surface not known before, and a number of samples, to the force of known
    physics on the last of them [N]
    """

    def __init__(self, known_forces: KnownForces) -> None:
        self._known_forces = known_forces
        self._approach: deque[tuple[float, ...]] = deque(maxlen=_APPROACH)
        self._rise: list[tuple[float, ...]] = []
        self._rise_s, self._state = 0.0, FREE

    def take(
        self, state: int, x: float, v: float, pressing: float, level: float, dt: float,
        noise: float,
    ) -> tuple[float, float] | None:
        """
        Follow a sample.

        state: of the contact
        x, v: position [m], and its measured rate, NaN without [m/s]
        pressing, level, dt, noise: pressing force and that of free flight [N], time since the last
        sample [s], standard deviation of the force [N]
        Returns surface, std: x_e and its standard deviation [m]; None while it is not known
        """
        point = x, pressing, v, dt
        if state != CONTACT:
            self._rise, self._rise_s = [], 0.0
            if state != self._state:  # the force of free flight is another
                self._approach.clear()
            self._state = state
            self._approach.append(point)
            return None
        self._rise.append(point)
        self._rise_s += dt
        if len(self._rise) < 2 or self._rise_s < _LONGEST_S and (
                len(self._rise) < _LEAST or pressing - level <= _CLEAR * noise):
            return None
        return self._judge(level, noise)

    def _judge(self, level: float, noise: float) -> tuple[float, float]:
        approach, rise = np.array(self._approach).reshape(-1, 4), np.array(self._rise)
        approach[:, 1] -= level
        rise[:, 1] -= level
        surface, std = surface_of(approach, rise, noise)
        known = np.array(self._known_forces(surface, len(approach) + len(rise)))
        if known.any():
            approach[:, 1] -= known[:len(approach)]
            rise[:, 1] -= known[len(approach):]
            surface, std = surface_of(approach, rise, noise)
        return surface, std


def surface_of(approach: Array, rise: Array, noise: float) -> tuple[float, float]:
    """
    Return where the force of a touch-down began to rise.

    The wall K (x - x_e) + B v acts beyond x_e alone; the x_e that leaves the least residual is
    chosen, among the positions passed and then between them.

    approach, rise (N, 4), (M, 4): position [m], pressing force [N], rate [m/s]
    (NaN where not measured) and time since the sample before [s], before and after the detection
    of contact; N may be 0
    noise: standard deviation of the force [N]
    Returns surface, std: x_e and its standard deviation [m]
    """
    x, force, v, dt = np.concatenate([approach, rise]).T
    if not np.isfinite(v).all():
        v = np.gradient(x, np.cumsum(np.maximum(dt, 1e-9)))
    force = force - (np.mean(approach[:len(approach) // 2, 1]) if len(approach) > 1 else 0.0)
    last = float(rise[min(_LEAST // 2, len(rise) - 1), 0])  # later, too little would remain
    passed = np.unique(x[(x >= min(x[0], last)) & (x <= last)])
    first = _least_residual([float(rise[0, 0]), *passed, *_lines(rise)], x, force, v)
    k = int(np.searchsorted(passed, first[0]))
    near = passed[max(k - 1, 0):k + 2]
    between = np.linspace(near[0], near[-1], _BETWEEN) if len(near) > 1 else near
    best, K_best, _ = min(first, _least_residual(between, x, force, v), key=itemgetter(2))
    step = float(np.median(np.abs(np.diff(rise[:_LEAST, 0]))))  # in one sample
    return best, hypot(step, noise / K_best)


def _least_residual(
    places: Sequence[float] | Array, x: Array, force: Array, v: Array
) -> tuple[float, float, float]:
    """Return the place from which a wall explains the force best, its K, and the residual."""
    tried = np.asarray(places)
    inside = x > tried[:, None]
    d, rate = inside * (x - tried[:, None]), inside * v  # (places, N)
    dd, dv, vv = (np.sum(product, 1) for product in (d * d, d * rate, rate * rate))
    df, vf = d @ force, rate @ force
    alone = df / np.maximum(dd, 1e-300)  # K without a damper
    determinant = dd * vv - dv * dv
    told = determinant > _SINGULAR * dd * vv
    scale = np.where(told, determinant, 1.0)
    B = np.where(told, (dd * vf - dv * df) / scale, 0.0)
    K = np.where(told, (vv * df - dv * vf) / scale, alone)
    left = np.sum((force - K[:, None] * d - B[:, None] * rate)**2, 1)
    undamped = np.sum((force - alone[:, None] * d)**2, 1)
    left = np.where(K > 0.0, np.where(B < 0.0, undamped, left), inf)
    k = int(np.argmin(left))
    if left[k] == inf:
        return float(tried[0]), inf, inf
    return float(tried[k]), float(alone[k] if B[k] < 0.0 else K[k]), float(left[k])


def _lines(rise: Array) -> list[float]:
    """Return the position at which a line through the rise is zero; of a wall felt late."""
    x, force = rise[:, 0], rise[:, 1]
    centred = x - np.mean(x)
    square = float(centred @ centred)
    slope = float(centred @ force) / square if square > 0.0 else 0.0
    return [float(np.mean(x) - np.mean(force) / slope)] if slope > 0.0 else []
