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

"""Where a contact began: a surface far from its configured location, or one not yet known."""

from __future__ import annotations

from collections import deque
from math import hypot, inf, sqrt
from operator import itemgetter
from typing import Callable, Sequence

import numpy as np

from .check import Array, millimetres
from ...signals.contact_sample import ContactSample

_NEW_CONTACT_S = 0.05  # out of contact, after which a contact is a new one
_LONGEST_S = 0.25  # of the rise of the force that is looked at
_CLEAR = 20.0  # standard deviations of the noise: the force has risen enough
_LEAST = 10  # samples
_APPROACH = 50  # samples before the contact
_SINGULAR = 1e-12  # of two columns: rounding alone tells them apart
_BETWEEN = 17  # places tried between the samples next to the best
_OF_DEPTH = 0.5  # a soft wall is felt only deep inside, but its force grows from x_e on
_LEAST_MARGIN = 1e-3  # [m]
_DETECTION_SAMPLES = 4.0

KnownForces = Callable[[float, int], Sequence[float]]

LOCATING = 'locating the surface'
_NEVER_FREE = (
    'waiting for free flight: there is a force since the start, and environment.location is nan, '
    'taken at first touch; if the tool is free, the sensor has an offset: set '
    'environment.location, call ~/tare, then set it to nan again'
)


class TouchDown:
    """
    Judge the beginning of every contact, before an estimator learns from it.

    The force of a contact that begins deep inside the wall is followed until it has risen: the
    line of force over position meets zero at the surface. Until then estimates are withheld; they
    remain so where the surface is not at its location.

    Attributes
    ----------
    text : str
        The warning; '' without one.
    found : tuple of (float, float) or None
        The surface found where its location was unknown, and its standard deviation [m].
    taken : bool
        Whether the location is that of a surface found.
    known_forces : callable or None
        From a surface not known before, and a number of samples, to the force of known physics on
        the last of them [N].
    watches : bool
        False in a contact that has been judged: its further samples need not be followed.

    """

    def __init__(self) -> None:
        self.known_forces: KnownForces | None = None
        self.reset()

    def reset(self) -> None:
        """Forget all contacts."""
        self.taken = False
        self.text = ''
        self.found: tuple[float, float] | None = None
        self.watches = True
        self._free_s = 0.0
        self._settled = False  # the present contact has been judged
        self._never_free = True
        self._approach: deque[tuple[float, ...]] = deque(maxlen=_APPROACH)
        self._rise: list[tuple[float, ...]] = []
        self._rise_s = 0.0

    def trust(self) -> None:
        """Accept the location from now on, as after a change of it, also in contact."""
        self.text, self.found, self._rise = '', None, []
        self._settled, self._free_s = True, 0.0

    def take(
        self, sample: ContactSample, dt: float, touching: bool, depth: float, pressing: float,
        margin: float, noise_variance: float,
    ) -> str:
        """
        Follow a sample.

        Parameters
        ----------
        sample : ContactSample
            The next one.
        dt, touching, depth : float, bool, float
            Time since the sample before [s], whether in contact, x - x_e [m] (NaN where unknown).
        pressing, margin : float
            Pressing force of the wall [N], and how far from its location the surface may be [m].
        noise_variance : float
            Of the force [N^2].

        Returns
        -------
        reason : str
            Why the estimate is withheld, '' where it is not.

        """
        if touching:
            self._free_s = 0.0
            if self._settled:
                self.watches = False
                return self.text
            return self._touch(sample, dt, depth, pressing, margin, noise_variance)
        self.watches = True
        watched = self.text or self._rise
        self._leave(dt)
        if not depth <= 0.0:
            self._approach.append(_point(sample, pressing, dt))
        elif not watched:
            self._approach.clear()
        return self.text

    def _leave(self, dt: float) -> None:
        self._free_s += dt
        if self._free_s >= _NEW_CONTACT_S:
            if self._never_free:
                self.text = ''
            self._never_free = self._settled = False
            self._rise, self._rise_s = [], 0.0

    def _touch(
        self, sample: ContactSample, dt: float, depth: float, pressing: float, margin: float,
        noise_variance: float,
    ) -> str:
        """Return why the estimate of a sample in contact not yet judged is withheld."""
        if self._never_free:
            self._settled = depth == depth
            self.text = '' if self._settled else _NEVER_FREE
            return self.text
        _, x, velocity, _ = sample
        if not self._rise:
            travel = abs(velocity) * dt * _DETECTION_SAMPLES if velocity == velocity else 0.0
            margin = max(margin, _LEAST_MARGIN) + travel
            if depth <= margin:
                self._settled, self.text = True, ''
                return ''
        self._rise.append(_point(sample, pressing, dt))
        self._rise_s += dt
        risen = pressing > _CLEAR * sqrt(noise_variance) and len(self._rise) >= _LEAST
        if risen or self._rise_s > _LONGEST_S:
            self._judge(x, depth, max(margin, _LEAST_MARGIN), sqrt(noise_variance))
        # The depth of the sample that completes the rise is not known yet.
        known = self._settled and self.found is None
        return self.text or ('' if known else LOCATING)

    def _judge(self, x: float, depth: float, margin: float, noise: float) -> None:
        """Say where the force began to rise."""
        approach, rise = np.array(self._approach).reshape(-1, 4), np.array(self._rise)
        surface, std = surface_of(approach, rise, noise)
        if depth != depth and self.known_forces is not None:
            known = np.array(self.known_forces(surface, len(approach) + len(rise)))
            if known.any():
                approach[:, 1] -= known[:len(approach)]
                rise[:, 1] -= known[len(approach):]
                surface, std = surface_of(approach, rise, noise)
        self._rise, self._rise_s, self._settled = [], 0.0, True
        if depth != depth:
            self.found, self.text, self.taken = (surface, std), '', True
            return
        location = x - depth
        inside = surface - location
        far = inside > margin and inside > _OF_DEPTH * depth
        self.text = (
            f'contact began {millimetres(inside)} inside the wall, at x = {surface:.4g} m; set '
            f'environment.location to {surface:.4g}'
            + (' (it was taken at the first touch, of another wall)' if self.taken
               else ', or to nan to take it at first touch')
        ) if far else ''


def _point(sample: ContactSample, pressing: float, dt: float) -> tuple[float, ...]:
    return sample[1], pressing, sample[2], dt


def surface_of(approach: Array, rise: Array, noise: float) -> tuple[float, float]:
    """
    Return where the force of a touch-down began to rise.

    The wall K (x - x_e) + B v acts beyond x_e alone; the x_e that leaves the least residual is
    chosen, among the positions passed and then between them.

    Parameters
    ----------
    approach, rise : ndarray, shape (N, 4), (M, 4)
        Position [m], pressing force [N], rate [m/s] (NaN where not measured) and time since the
        sample before [s], before and after the detection of contact; N may be 0.
    noise : float
        Standard deviation of the force [N].

    Returns
    -------
    surface, std : float, float
        x_e and its standard deviation [m].

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
