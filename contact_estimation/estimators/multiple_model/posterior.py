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

"""The posterior of the wall, sample by sample."""

from __future__ import annotations

from collections import deque
from math import exp, inf, isfinite, log, nan, sqrt
from typing import Iterator, NamedTuple, Sequence

import numpy as np

from .constants import (
    ANYWHERE_M, AS_TOLD, AS_TOLD_M, DAMPING_FLOOR, DAMPING_S, ELSEWHERE, FADE_S, JITTER_S, MODEL_ERROR,
    MODEL_ERROR_S, NEAR, STIFFNESS_FLOOR, STILL_THERE, WALL_WALK)
from .contact import CONTACT, ContactFilter, FREE, NEITHER
from .evidence import Hypotheses, judge, Judged, Scene, Wall, walls
from .lag import LagPosterior
from .laws import (
    ACCELERATION, Array, CHOSEN, COLUMNS, DEEP, DEPTH, FORCE, FORCE_RATE, FRICTION, Ints, KELVIN_VOIGT, LOG_PRIOR, MASS,
    MOVING, NAMES, ONE, RATE, scales, shifted_table, UNKNOWNS)
from .runs import Change, decided, Runs
from .smoothing import Smoothing
from .touch import surface_of_touch

_FIRST = 20  # samples from which period and noise are learned
_BLOCK_S = 0.020  # of samples that are processed together
_FILLED = 3.5  # periods without a sample that are bridged
_OUTLIER, _POSITION_OUTLIER = 6.0, 10.0  # standard deviations from the median of five
_STEEP, _STEEP_POSITION = 0.15, 0.5  # of a step of that median, by which a touch may differ
_PRESSES = 3.0  # standard deviations of the force, from which rows are used
_GREATEST = 1e5  # [N]; a larger force is no measurement
_LAWS = len(NAMES)
_LONG = 2  # short blocks in a long one
_EARLY = 20  # short blocks of a contact, each judged; later every fifth long one is
_EVERY = 5
_ALERT = 5  # blocks judged after a surprise
_SURPRISE = 4.0  # mean square of a block, over the noise's: chi^2 of 5 to 10 rows, below 1e-3
_CLIPPED = 4.0  # times the mean so far: a change is no misfit
_OUTSIDE, _OUTSIDE_M = 4.0, 5e-4  # of a surface [deviations, m]: no force is that of the wall
_TAP_S = 0.06  # contact that is shorter has few rows or none beside those of its touch
_STRADDLES = 0.3  # of the depth: as well must the surface be known for rows across it
_FASTEST, _REACH = 20.0, 1e-3  # twice any arm [m/s], a step of a coarse sensor [m]
_BELIEVED = 10  # samples in a row
_SAME_RATE, _OTHER_RATE = 1e-4, 0.1  # relative errors of the period
_LONGEST_STEPS = 5000  # over which it is measured, of samples with errors of a tenth
_JUMP = 12.0  # standard deviations of a difference that is no noise
_START = 3  # blocks in which the scale of the priors is not known
_SETTLED = 10  # blocks, from which the lag is learned
_DEPTH_S = 1.0  # over which the mean depth is taken
_RESIDUAL_S = 2.0  # over which residuals are averaged
_RECENT = 25  # blocks of the last half second to second
_PARTS = 8  # at most, of the work on a block
_DONE = object()
_FAR = 40.0  # log odds against a moving wall, from which it starts anew
_SURE = 0.3  # relative standard deviation above which there is no estimate


class Knowledge(NamedTuple):
    """
    What is known of the wall.

    Attributes
    ----------
    stiffness, damping, stiffness_std, damping_std : float
        K_e [N/m], B_e [N s/m]; NaN before the first contact.
    surface, surface_std : float
        x_e [m]; NaN before it is known.
    inertia : float
        Mass that moves with the wall where that is the law, else NaN [kg].
    laws : tuple of float
        Probabilities, in the order of `laws.NAMES`.
    fit : float
        Rms of the residual over that of the noise, in the last 2 s of contact; NaN before.

    """

    stiffness: float
    damping: float
    stiffness_std: float
    damping_std: float
    surface: float
    surface_std: float
    inertia: float
    laws: tuple[float, ...]
    fit: float

    @property
    def valid(self) -> bool:
        """Whether the stiffness is known to a third of it."""
        return self.stiffness_std < _SURE * self.stiffness


class WallPosterior:
    """
    Hypotheses of contact, law, surface and changes of a wall, weighed by their evidence.

    Samples are judged for contact one by one. In contact every 20 ms of them become a block: rows
    of smoothed columns, in which every law is linear, and their Gram matrix. A hypothesis is a
    small linear fit of some columns to the sum of these matrices, and its evidence is that of a
    Gaussian model. What contacts add up is carried from one to the next.

    Parameters
    ----------
    location, location_std : float
        x_e as told, NaN where unknown, and its standard deviation [m].
    lag : (float, float)
        Prior of the lag of the force sensor [s].
    position_noise : float
        Least standard deviation of the position [m].
    minimum_force, least_noise : float
        Contact begins above this force; least standard deviation of the force [N].

    Attributes
    ----------
    known : Knowledge
        Now.
    contact : ContactFilter
        The state of contact and the noise of the force.
    period_s : float
        Of the samples as measured [s]; 0 before 20 of them.
    lag : LagPosterior
        Of the force sensor.
    changes : int
        How often the wall has become another.
    outliers : int
        Forces replaced as outliers.
    inertia : float
        Known mass that moves with the wall, whose force the samples contain [kg].

    """

    def __init__(
        self, location: float = nan, location_std: float = 2e-3,
        lag: tuple[float, float] = (1.2e-3, 1e-3), position_noise: float = 0.0,
        minimum_force: float = 0.0, least_noise: float = 1e-3,
    ) -> None:
        self._told = location, max(location_std, AS_TOLD_M)
        self._least = position_noise * position_noise
        self.inertia = 0.0
        self.contact, self.lag = ContactFilter(minimum_force, least_noise), LagPosterior(*lag)
        self.period_s, self.outliers = 0.0, 0
        self._first: list[tuple[float, ...]] = []
        self._noise = nan, nan  # variances of position and rate
        self._still = nan  # force since which the position has not changed
        self.restart()
        self.forget()

    def forget(self) -> None:
        """Forget the wall; noises, lag and the zero of the sensor stay."""
        location, std = self._told
        self.known = Knowledge(nan, nan, nan, nan, location,
                               std if location == location else ANYWHERE_M, nan,
                               tuple(np.exp(LOG_PRIOR).tolist()), nan)
        self._runs = Runs()
        self._gram, self._moving = np.zeros((2, COLUMNS, COLUMNS))
        self._moving_norm = self._moving_odds = 0.0
        self._odds = LOG_PRIOR.copy()
        self.changes = self._blocks = self._of_contact = self._alert = 0
        self._depth_s = 0.0
        self._x0 = location if location == location else 0.0
        self._depth, self._residual = 1e-3, nan
        self._scale, self._seconds = 1e3, 0.0  # K_e and B_e / K_e for the priors
        self._surfaces = [(location, AS_TOLD_M, AS_TOLD), (location, std, NEAR),
                          (location, ANYWHERE_M, ELSEWHERE)]
        self._top: tuple[Ints, Array, Scene] | None = None
        self._touched = nan
        self._excited_at, self._excitation = -1, (inf, inf)

    def expect(self, surface: float, std: float) -> None:
        """Use a surface that the first touch has shown [m]."""
        std = max(std, AS_TOLD_M)
        self._surfaces = [(surface, std, NEAR), (surface, ANYWHERE_M, ELSEWHERE)]
        if not self._blocks:
            self._x0 = surface

    def keep(self, contact: ContactFilter) -> None:
        """Use the noise and the level of another posterior on the same samples."""
        self.contact.variance, self.contact.level = contact.variance, contact.level
        self.contact.level_variance = contact.level_variance

    @property
    def law(self) -> str:
        """Name of the most probable law."""
        return NAMES[int(np.argmax(self.known.laws))]

    @property
    def excitation(self) -> tuple[float, float]:
        """
        Relative standard deviations of K_e and B_e that the last second would leave on its own.

        The Cramer-Rao bound with the surface as known: eq. (27) made quantitative.

        """
        if self._excited_at != self._blocks:
            self._excited_at = self._blocks
            self._excitation = self._bounds()
        return self._excitation

    def _bounds(self) -> tuple[float, float]:
        gram = self._runs.recent(_RECENT) if self._blocks else self._gram
        K, B = self._scale, max(self._seconds, DAMPING_S) * self._scale
        (kk, kb), (_, bb) = gram[np.ix_([DEPTH, RATE], [DEPTH, RATE])].tolist()
        determinant = kk * bb - kb * kb
        if kk <= 0.0:
            return inf, inf
        if determinant <= 1e-12 * kk * bb:
            return 1.0 / (K * sqrt(kk)), inf
        return sqrt(bb / determinant) / K, sqrt(kk / determinant) / B

    def restart(self) -> None:
        """Begin anew with the next sample, as after a gap or a jump of the clock."""
        self._last_t, self._last_x, self._jumped = -inf, nan, 0
        self._raw: list[tuple[float, ...]] = []
        self._filled = 0
        self._work: Iterator[None] | None = None
        self._tap: list[tuple[float, float]] | None = None

    # -- samples ----------------------------------------------------------------------------

    def take(
        self, t: float, force: float, x: float, v: float = nan, usable: bool = True,
        felt: tuple[float, float] | None = None, bent: tuple[float, float] = (0.0, 0.0),
    ) -> int:
        """
        Process a sample.

        Parameters
        ----------
        t : float
            Stamp, after the last one [s].
        force, x, v : float
            Pressing force [N], position [m] and its measured rate, NaN without [m/s].
        usable : bool
            Whether the wall is to be learned from it.
        felt : (float, float), optional
            Force and position by which contact is judged, where these are others.
        bent : (float, float)
            Where known physics bend the wall: how much more than x the displacement is that B_e
            damps [m], and the slope of x over the depth less 1.

        Returns
        -------
        state : int
            FREE, CONTACT or NEITHER.

        """
        dt = t - self._last_t
        felt_force, felt_x = felt or (force, x)
        if not (isfinite(force) and isfinite(x) and dt > 0.0 and abs(felt_force) < _GREATEST):
            return self.contact.state
        if self._jumps(dt, felt_x):
            return self.contact.state
        self._last_t = t
        if not self.period_s:
            self._begin(t, felt_force, felt_x)
            return FREE
        if self._work is not None:
            self._go_on()
        T, known = self.period_s, self.known
        before = self.contact.state
        if dt > _FILLED * T:
            self._raw.clear()
            self._filled = 0
            dt = T
        else:
            self._measure_period(dt)
            if dt > 1.5 * T and self._raw:
                self._bridge(round(dt / T), (force, x, v, *bent))
        state = self.contact.take(dt, felt_force, felt_x, known.surface, known.surface_std)
        if state == CONTACT and before != CONTACT:
            self._touch(felt_x)
            known = self.known
        outermost = known.surface - _OUTSIDE * known.surface_std - _OUTSIDE_M
        taught = state == CONTACT and usable and not felt_x < outermost
        self._raw.append((force, x, v, *bent, float(taught)))
        if felt is None:  # out of contact, a force less known physics is that of no wall
            self._follow_tap(force, x, before, state)
        if len(self._raw) >= self._block:
            self._close()
        return state

    def _follow_tap(self, force: float, x: float, before: int, state: int) -> None:
        """Keep the samples around a touch; a contact that was shorter than rows has no others."""
        tap = self._tap
        if state == CONTACT:
            if before != CONTACT:
                self._tap = tap = list(self._recent)
            if tap is not None:
                tap.append((force, x))
                if len(tap) > self._longest_tap:
                    self._tap = None
        elif tap is not None:
            self._tap = None
            if self._work is not None:
                self._go_on(to_end=True)
            self._work = self._learn_tap(np.array(tap).T)
        self._recent.append((force, x))

    def _learn_tap(self, samples: Array) -> Iterator[None]:
        """Add the rows of a short contact, about the surface that it shows."""
        smooth = self._smoothing
        force, x = samples
        force = force - self.contact.level
        deviation = sqrt(self.contact.variance)
        pressing = np.flatnonzero(force > _PRESSES * deviation)
        if not len(pressing):
            return
        end = int(pressing[-1])  # the release, where the wall lets go, is not used
        force, x = force[:end], x[:end]
        windows = (len(x) - 2 * smooth.half - 1) // smooth.hop + 1
        if windows < 1:
            return
        length = smooth.length(windows)
        force, x = force[-length:], x[-length:]
        yield
        found = surface_of_touch(
            smooth, force, x, smooth.hop / self.contact.variance, self._gram, self._x0,
            self._scale, tuple(np.array(self._surfaces).T))  # type: ignore[arg-type]
        if found is None:
            return
        yield
        surface, std = found
        if std < _STRADDLES * self._move_to(surface):
            phi = smooth.rows(force, x, np.full(len(x), nan), self._x0, self._noise, True)
            self._add((phi * self._weights(phi)) @ phi.T, phi)
            yield
            if self._blocks <= _START:
                self._find_scale()
            yield from self._judge()
            self._runs.begin()

    def _go_on(self, to_end: bool = False) -> None:
        """Do the next part of the work on the last block, so that no sample takes long."""
        assert self._work is not None
        for _ in range(_PARTS if to_end else self._parts):
            if next(self._work, _DONE) is _DONE:
                self._work = None
                return

    def _jumps(self, dt: float, x: float) -> bool:
        """Return whether the tool cannot have moved so fast; so often in a row, it is elsewhere."""
        if abs(x - self._last_x) > _FASTEST * min(dt, 1.0) + _REACH and self._jumped < _BELIEVED:
            self._jumped += 1
            return True
        if self._jumped >= _BELIEVED:
            self._raw.clear()
            self._filled = 0
        self._jumped, self._last_x = 0, x
        return False

    def _begin(self, t: float, force: float, x: float) -> None:
        """Collect the samples that tell period and noise."""
        self._first.append((t, force, x))
        if len(self._first) < _FIRST:
            return
        stamps, forces, places = np.array(self._first).T
        self._first.clear()
        location, std = self._told
        self._set_period(float(np.median(np.diff(stamps))))
        self._measure_period(float(stamps[-1] - stamps[0]))
        self.contact.start(forces, not places[-1] > location - 2.0 * std)

    def _set_period(self, period_s: float) -> None:
        self.period_s = period_s
        self._smoothing = smooth = Smoothing(period_s)
        self._short = max(1, round(_BLOCK_S / period_s) // smooth.hop) * smooth.hop
        self._block = self._long = _LONG * self._short
        self._parts = -(-_PARTS // max(self._short - 1, 1))
        self._buffer = np.zeros((6, smooth.length(self._long // smooth.hop) + 4))
        self._recent: deque[tuple[float, float]] = deque(maxlen=3 * smooth.half)
        self._longest_tap = 3 * smooth.half + round(_TAP_S / period_s)
        self._filled = 0
        self._elapsed, self._steps, self._measured = 0.0, 0, _FIRST - 1

    def _measure_period(self, dt: float) -> None:
        """Refine the period with the time that passes: an error of it is one of B_e."""
        steps = round(dt / self.period_s)
        self._elapsed += dt
        self._steps += steps
        if self._steps < self._measured:
            return
        period = self._elapsed / self._steps
        off = abs(period / self.period_s - 1.0)
        if off > _OTHER_RATE:
            self._set_period(period)
        elif off > _SAME_RATE:
            self._smoothing = Smoothing(period)
            self.period_s = period
        if self._measured < _LONGEST_STEPS:
            self._measured *= 4
        else:
            self._elapsed, self._steps = 0.0, 0

    def _bridge(self, steps: int, now: tuple[float, ...]) -> None:
        """Fill in samples that were lost, on a straight line."""
        *last, usable = self._raw[-1]
        for k in range(1, steps):
            between = [a + k / steps * (b - a) for a, b in zip(last, now)]
            self._raw.append((*between, usable))

    def _touch(self, x: float) -> None:
        """Begin a contact: the wall may be another."""
        self._of_contact, self._block = 0, self._short
        known = self.known
        if known.surface != known.surface:
            self._x0 = x
            self._surfaces = [(x, ANYWHERE_M, 1.0)]
        elif x < known.surface - _OUTSIDE * known.surface_std - _OUTSIDE_M:  # another wall
            self.known = known._replace(surface=x, surface_std=ANYWHERE_M)
        self._touched = x

    def _close(self) -> None:
        """Begin the work on a block of samples."""
        if self._work is not None:
            self._go_on(to_end=True)
        new = np.array(self._raw).T
        self._raw.clear()
        buffer, count = self._buffer, min(new.shape[1], self._long)
        buffer[:, :-count] = buffer[:, count:]
        buffer[:, -count:] = new[:, -count:]
        self._filled += count
        self._learn_noise(buffer[1:3, -(count + 4):])
        windows = count // self._smoothing.hop
        if self._filled >= self._smoothing.length(windows) + 4 and buffer[-1].any():
            self._work = self._parts_of(windows)

    def _learn_noise(self, recent: Array) -> None:
        """Learn the noise of position and rate from second differences, as that of the force."""
        bends = np.square(np.diff(recent, 2, axis=1)) / 6.0
        noise = []
        for squares, known in zip(bends, self._noise):
            if known == known:
                mean = float(np.mean(np.minimum(squares, 9.0 * known)))
                known += 0.05 * (mean - known)
            else:
                known = float(np.median(squares)) / 0.455
            noise.append(max(known, 1e-20))
        self._noise = max(noise[0], self._least), noise[1]

    def _rows(self, windows: int) -> Array | None:
        """Return the rows of windows that are in contact throughout."""
        smooth, deviation = self._smoothing, sqrt(self.contact.variance)
        recent = self._buffer[:, -(smooth.length(windows) + 4):]
        force, x, course = self._without_outliers(recent[:2], deviation)
        v, *bent, usable = recent[2:, 2:-2]
        inside = (usable > 0.0) & (course > _PRESSES * deviation)
        whole = ~(~inside @ smooth.bands(windows)[2])
        if not whole.any() or self._is_frozen(force, x, deviation):
            return None
        self._samples = force, x, whole
        phi = smooth.rows(force, x, v, self._x0, self._noise, bent=bent)
        if self.inertia:
            phi[FORCE] -= self.inertia * phi[ACCELERATION]
        return phi if whole.all() else phi[:, whole]

    def _beside_jumps(self, windows: int) -> Array:
        """Return 0 for rows across a jump of the force, which are those of no wall, 1 for others."""
        force, x, whole = self._samples
        known, smooth = self.known, self._smoothing
        if not known.valid:
            return np.ones(np.count_nonzero(whole))
        rate = np.gradient(x) / self.period_s
        left = force - known.stiffness * (x - known.surface) - known.damping * rate
        steps = np.abs(left[2:] - left[:-2])  # over two samples: a jump is one, motion is not
        usual = 3.0 * float(np.median(steps)) + _JUMP * sqrt(self.contact.variance)
        jumps = np.zeros(len(x))
        jumps[1:-1] = steps > usual
        return np.asarray((jumps @ smooth.bands(windows)[2] < 0.5)[whole], float)

    def _without_outliers(self, both: Array, deviation: float) -> tuple[Array, Array, Array]:
        """Return force and position with the median of five for outliers, and that of the force."""
        level, middle = self.contact.level, both[:, 2:-2]
        bound = np.array([[_OUTLIER * deviation],
                          [_POSITION_OUTLIER * sqrt(self._noise[0]) + 1e-7]])
        bends = np.abs(both[:, 1:-3] - 2.0 * middle + both[:, 3:-1])
        if not (bends > bound).any():  # an outlier bends the course at least as much
            force, x = middle
            return force - level, x, force - level
        window = np.lib.stride_tricks.sliding_window_view(both, 5, axis=1)
        median = np.sort(window, axis=2)[:, :, 2]
        bound = bound + np.array([[_STEEP], [_STEEP_POSITION]]) * np.abs(
            np.diff(median, axis=1, prepend=median[:, :1]))
        outside = np.abs(middle - median) > bound
        self.outliers += int(np.count_nonzero(outside[0, -self._block:]))
        force, x = np.where(outside, median, middle)
        return force - level, x, median[0] - level

    def _is_frozen(self, force: Array, x: Array, deviation: float) -> bool:
        """Return whether a channel repeats one value while the other moves."""
        moves = x != x[0]
        if moves.any():
            self._still = nan
            return bool(np.count_nonzero(force[1:] == force[:-1]) > 0.8 * len(force))
        mean = float(force.mean())
        if self._still != self._still:
            self._still = mean
        return abs(mean - self._still) > 5.0 * deviation / sqrt(len(x)) + 0.01 * abs(mean)

    # -- inference --------------------------------------------------------------------------

    @property
    def scene(self) -> Scene:
        """What all hypotheses share now."""
        return Scene(self._x0, self._depth, self._seconds, self.lag.lag)

    def _parts_of(self, windows: int) -> Iterator[None]:
        """Add a block and judge all hypotheses that it concerns, in parts of a tenth of a ms."""
        phi = self._rows(windows)
        if phi is None:
            return
        yield
        weights = self._weights(phi)
        surprise = self._surprise(phi, weights)
        if surprise:
            weights = weights * self._beside_jumps(windows)
        self._add((phi * weights) @ phi.T, phi)
        early = self._of_contact <= _EARLY or self._blocks <= _SETTLED
        self._alert = _ALERT if surprise else max(self._alert - 1, 0)
        self._block = self._short if early or self._alert else self._long
        if early or self._alert or self._blocks % _EVERY == 0:
            yield
            if self._blocks <= _START:
                self._find_scale()
                yield
            yield from self._judge()
        self._runs.begin()

    def _weights(self, phi: Array) -> Array:
        """Return samples a row over its variance: of noises, stamps, and errors of any model."""
        T, K, force = self.period_s, self._scale, phi[FORCE]
        B = K * max(self._seconds - self.lag.lag[0], 0.0)
        smooth = self._smoothing
        variance = (self.contact.variance + np.square(JITTER_S * phi[FORCE_RATE])
                    + np.square(MODEL_ERROR * force) * (MODEL_ERROR_S / T)
                    + self._noise[0] * (K * K + B * B * smooth.rate_noise / smooth.noise))
        return np.asarray(smooth.hop / variance)

    def _add(self, gram: Array, phi: Array) -> None:
        """Add a block to all that is known; the older, the less."""
        seconds = phi.shape[1] * self._smoothing.hop * self.period_s
        fade = exp(-seconds / FADE_S)
        if self._touched == self._touched:
            if self._blocks:
                self._runs.begin(self._touched)
            self._touched = nan
        self._blocks += 1
        self._of_contact += 1
        self._depth_s = min(self._depth_s + seconds, _DEPTH_S)
        depth = max(float(phi[DEPTH].mean()), 1e-5)
        self._depth += (depth - self._depth) * min(seconds / self._depth_s, 1.0)
        self._gram *= fade
        self._gram += gram
        self._runs.add(gram, fade, seconds)
        # A surface that walks loses what is known of s: the Schur complement of its column.
        moving = self._moving * fade
        walk = (self._scale * WALL_WALK) ** 2 * seconds
        column = moving[ONE]
        moving -= np.outer(column, column) / (1.0 / walk + column[ONE])
        self._moving_norm = fade * self._moving_norm - 0.5 * log(1.0 + walk * column[ONE])
        self._moving = moving + gram
        self._odds = LOG_PRIOR + (self._odds - LOG_PRIOR) * fade
        self._moving_odds *= fade

    def _find_scale(self) -> None:
        """Find the stiffness that scales the priors of a wall that is not known."""
        gram = self._gram
        for _ in range(3):
            centre, std, _ = self._surfaces[-1]
            found = judge(gram[None], self.scene, Hypotheses(
                np.array([KELVIN_VOIGT]), np.array([self._scale]), np.array([centre]),
                np.array([std])))
            K, B = found.theta[0, :2].tolist()
            if not K > 0.0:
                K = max(gram[DEPTH, FORCE] / max(gram[DEPTH, DEPTH], 1e-30), 10.0)
            self._scale, self._seconds = K, max(B / K + self.lag.lag[0], 0.0)

    def _hypotheses(self, laws: Ints, surfaces: Sequence[tuple[float, float, float]]) -> Hypotheses:
        count = len(surfaces)
        centre, std, _ = np.tile(np.array(surfaces).T, len(laws))
        return Hypotheses(np.repeat(laws, count), np.full(len(centre), self._scale), centre, std)

    def _judge(self) -> Iterator[None]:
        """Weigh laws and surfaces, and the changes of the best of them that is at rest."""
        scene = self.scene
        what = self._hypotheses(np.arange(_LAWS), self._surfaces)
        moves = what.law == MOVING
        grams = np.repeat(self._gram[None], len(moves), axis=0)
        grams[moves] = self._moving
        judged = judge(grams, scene, what)
        odds = judged.evidence + self._prior_odds(what, moves) - _signs(judged, what.law, scene)
        still = int(np.argmax(np.where(moves, -inf, odds)))
        yield
        best = Hypotheses(*(one[still:still + 1] for one in what))
        change = None
        before = self._runs.before(self._gram, scene, best)
        if before is not None:
            yield
            change = self._runs.since(before, scene, float(judged.evidence[still]),
                                      self._block * self.period_s)
            # A wall at rest may have changed instead of moving.
            odds = odds + np.where(
                moves, 0.0, np.logaddexp.reduce(np.append(change.odds, 0.0)))
        yield
        self._restart_moving(odds, judged.evidence, moves)
        weights = np.exp(odds - odds.max())
        weights /= weights.sum()
        top = int(np.argmax(odds))
        self._top = what.law[top:top + 1], judged.theta[top], scene
        self._tell(weights, judged, what, change, int(what.law[still]), scene)
        if self._blocks > _SETTLED:
            self._learn_lag(weights, judged)
        certain = decided(change)
        if change is not None and certain >= 0:
            yield
            gap = float(odds[moves].max() - odds[~moves].max())
            self._commit(change, certain, best, scene, min(max(gap, -_FAR), 0.0))
        self._follow_surface()

    def _prior_odds(self, what: Hypotheses, moves: Array) -> Array:
        prior = np.log([one[2] for one in self._surfaces])
        own = np.where(moves, LOG_PRIOR[MOVING] + self._moving_norm + self._moving_odds,
                       self._odds[what.law])
        return np.asarray(own + np.tile(prior, _LAWS))

    def _restart_moving(self, odds: Array, evidence: Array, moves: Array) -> None:
        """Let a moving wall that is out of the question start from what is known: it may begin."""
        best = float(odds[~moves].max())
        if best - float(odds[moves].max()) > _FAR:
            self._moving, self._moving_norm = self._gram.copy(), 0.0
            self._moving_odds = best - float(evidence[~moves].max()) - _FAR

    def _commit(
        self, change: Change, best: int, still: Hypotheses, scene: Scene, gap: float
    ) -> None:
        """Drop the wall before a change; what was told of laws and motion stays a prior."""
        run = int(change.run[best])
        centre, std = float(change.centre[best]), float(change.std[best])
        gram = self._runs.commit(run)
        before = judge(
            np.repeat((self._gram - gram)[None], _LAWS, axis=0), scene,
            self._hypotheses(np.arange(_LAWS), [(float(still.centre[0]),
                                                 float(still.std[0]), 1.0)])).evidence
        most = float(before[:MOVING].max())
        self._odds = np.maximum(self._odds + before - most, LOG_PRIOR - 0.5 * _FAR)
        self._gram, self._moving, self._moving_norm = gram, gram.copy(), 0.0
        self._moving_odds = gap + float(self._odds[:MOVING].max() - LOG_PRIOR[MOVING])
        self.changes += 1
        self._surfaces = [(centre, std, STILL_THERE), (centre, ANYWHERE_M, ELSEWHERE)]
        if abs(self._told[0] - centre) < 4.0 * std:
            self._surfaces.append((self._told[0], AS_TOLD_M, 1.0 - STILL_THERE))
        K, B = change.judged.theta[best, :2].tolist()
        self._scale = max(K, 1.0)
        self._seconds = max(B / self._scale + self.lag.lag[0], 0.0)
        self._depth_s = 0.0

    def _surprise(self, phi: Array, weights: Array) -> bool:
        """Average the residual of a block under what was known before; is it surprising?"""
        if self._top is None:
            return False
        law, theta, scene = self._top
        if scene.x0 != self._x0:
            return True
        columns = phi[CHOSEN[law[0], :UNKNOWNS]] * scales(law, scene.depth)[0, :UNKNOWNS, None]
        tau = scene.lag[0] if DEEP[law[0]] else 0.0
        error = phi[FORCE] + tau * phi[FORCE_RATE] - theta @ columns
        smooth = self._smoothing
        ratio = float(np.mean(error * error * weights)) / (smooth.hop * smooth.noise)
        if self._blocks <= _SETTLED or self._of_contact <= _EARLY:
            return ratio > _SURPRISE
        before = self._residual if self._residual == self._residual else 1.0
        share = phi.shape[1] * smooth.hop * self.period_s / _RESIDUAL_S
        self._residual = before + share * (min(ratio, _CLIPPED * before + 1.0) - before)
        return ratio > _SURPRISE

    def _learn_lag(self, weights: Array, judged: Judged) -> None:
        """Learn the lag where a spring and a damper are all that is there."""
        of_law = weights.reshape(_LAWS, -1)
        if of_law[KELVIN_VOIGT].sum() > 0.5:
            k = MASS * of_law.shape[1] + int(np.argmax(of_law[KELVIN_VOIGT]))
            self.lag.learn(judged.theta[k], judged.P[k])

    def _tell(
        self, weights: Array, judged: Judged, what: Hypotheses, change: Change | None,
        law: int, scene: Scene,
    ) -> None:
        """Publish the mixture of all hypotheses."""
        of_law = weights.reshape(_LAWS, -1).sum(1)
        found = walls(judged, what.law, scene, ANYWHERE_M)
        if change is not None:
            changed = np.append(change.odds, 0.0)
            share = np.exp(changed - np.logaddexp.reduce(changed))[:-1] * (1.0 - of_law[MOVING])
            since = walls(change.judged, np.full(len(share), law), scene, ANYWHERE_M)
            found = Wall(*(np.concatenate(pair, axis=-1) for pair in zip(found, since)))
            weights = np.concatenate([weights * (1.0 - share.sum()), share])
        means, stds = [], []
        for values, variances in zip(found[:3], found.variances):
            mean = float(weights @ values)
            means.append(mean)
            stds.append(float(weights @ (variances + np.square(values - mean))))
        K, B, delta = means
        mass = judged.theta[MASS * (len(judged.theta) // _LAWS), 2]
        K_std = sqrt(stds[0] + (STIFFNESS_FLOOR * K) ** 2)
        surface, surface_std = self.known.surface, self.known.surface_std
        if K_std < _SURE * K:  # else nothing is found of it
            surface, surface_std = self._x0 + delta, sqrt(stds[2]) + 2e-6
        self.known = Knowledge(
            K, B, K_std, sqrt(stds[1] + (DAMPING_FLOOR * B) ** 2), surface, surface_std,
            float(mass) if of_law[MASS] > 0.5 else nan, tuple(of_law.tolist()),
            sqrt(self._residual) if self._residual == self._residual else nan)
        self._scale = max(K, 1.0)
        self._seconds = max(B / self._scale, 0.0)

    def _follow_surface(self) -> None:
        """Move the reference of the columns to the surface where that is known better."""
        known = self.known
        off = abs(known.surface - self._x0)
        if known.valid and off > max(2.0 * known.surface_std, AS_TOLD_M) and (
                known.surface_std < 0.3 * self._depth):
            self._move_to(known.surface)

    def _move_to(self, surface: float) -> float:
        """Move the reference of the columns to a place [m]; return the mean depth from there."""
        delta = surface - self._x0
        table = shifted_table(delta)
        self._gram = table @ self._gram @ table.T
        self._moving = table @ self._moving @ table.T
        self._runs.move(table)
        self._x0 += delta
        self._depth = max(self._depth - delta, 1e-5)
        return self._depth


def _signs(judged: Judged, laws: Ints, scene: Scene) -> Array:
    """Return what it costs that stiffness, damping, friction and mass are not negative."""
    theta, P = judged.theta, judged.P
    damping = theta[:, 1] + np.where(DEEP[laws], 0.0, scene.lag[0]) * theta[:, 0]
    values = np.stack([theta[:, 0], damping, np.where(laws == MASS, theta[:, 2], 0.0),
                       np.where(laws == FRICTION, theta[:, 4], 0.0)])
    variances = np.stack([P[:, 0, 0], P[:, 1, 1], P[:, 2, 2], P[:, 4, 4]])
    below = np.square(np.minimum(values, 0.0)) / np.maximum(variances, 1e-30)
    return np.minimum(0.5 * below.sum(0), 15.0)
