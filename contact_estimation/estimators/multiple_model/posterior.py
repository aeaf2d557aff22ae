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

from itertools import chain, repeat
from math import exp, inf, isfinite, nan, sqrt
from typing import Iterator, Sequence, TypeVar

import numpy as np
from numpy.typing import NDArray

from .ahead import Ahead, GREATEST
from .blocks import Blocks, FIRST
from .constants import (
    ANYWHERE_M, AS_TOLD, AS_TOLD_M, DAMPING_FLOOR, DAMPING_S, ELSEWHERE, FADE_S, JITTER_S,
    MODEL_ERROR, MODEL_ERROR_S, NEAR, STIFFNESS_FLOOR, STILL_THERE)
from .contact import CONTACT, ContactFilter, FREE
from .evidence import Hypotheses, judge, judge_in_parts, Judged, Scene, Wall, walls
from .knowledge import Knowledge, SURE
from .lag import LagPosterior
from .laws import (
    ACCELERATION, Array, CHOSEN, COLUMNS, DEEP, DEPTH, FORCE, FORCE_RATE, FRICTION, Ints,
    KELVIN_VOIGT, LOG_PRIOR, MASS, MOVING, NAMES, RATE, scales, shifted_table, UNKNOWNS)
from .moving import MovingWall
from .rhythm import Rhythm, SETTLED, SURPRISE
from .runs import Change, decided, Runs
from .touch import before_release, surface_of_touch

_FEW = 4  # samples that are not worth a run
_LAWS = len(NAMES)
_ALARM = 4.0  # deviations of the median of a short block that ends a longer one
_OF_MEDIAN = 1.57  # its variance over that of a mean: pi / 2
_CLIPPED = 4.0  # times the mean so far: a change is no misfit
_OUTSIDE, _OUTSIDE_M = 4.0, 5e-4  # of a surface [deviations, m]: no force is that of the wall
_TAP_S = 0.06  # contact that is shorter has few rows or none beside those of its touch
_STRADDLES = 0.3  # of the depth: as well must the surface be known for rows across it
_SOFTER = 0.03  # of the scale so far: a stiffness that is not known may be found negative
_START = 3  # blocks in which the scale of the priors is not known
_DEPTH_S = 1.0  # over which the mean depth is taken
_RESIDUAL_S = 2.0  # over which residuals are averaged
_RECENT_S = 0.5  # of the last data, at least
_PARTS = 14  # at most, of the work on a block
_SCALES: Array = np.geomspace(30.0, 1e6, 16)  # of a wall that is not known [N/m]
_DONE = object()
_NONE: Array = np.zeros((0, 2))
_FARTHEST = 20.0  # log odds of a law of the wall before a change
_Force = TypeVar('_Force', float, Array)


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
    blocks : Blocks
        The samples, their period and noise.
    lag : LagPosterior
        Of the force sensor.
    rhythm : Rhythm
        Of blocks and judgements.
    changes : int
        How often the wall has become another.
    inertia : float
        Known mass that moves with the wall, whose force the samples contain [kg].

    """

    def __init__(
        self, location: float = nan, location_std: float = 2e-3,
        lag: tuple[float, float] = (1.2e-3, 1e-3), position_noise: float = 0.0,
        minimum_force: float = 0.0, least_noise: float = 1e-3,
    ) -> None:
        self._told = location, max(location_std, AS_TOLD_M)
        self.blocks, self.inertia = Blocks(position_noise), 0.0
        self.contact, self.lag = ContactFilter(minimum_force, least_noise), LagPosterior(*lag)
        self._first: list[tuple[float, ...]] = []
        self.rhythm = Rhythm(False)
        self.restart()
        self.forget()

    def forget(self) -> None:
        """Forget the wall; noises, lag and the zero of the sensor stay."""
        location, std = self._told
        self.known = Knowledge(nan, nan, nan, nan, location,
                               std if location == location else ANYWHERE_M, nan,
                               tuple(np.exp(LOG_PRIOR).tolist()), nan)
        self._runs = Runs()
        self._gram, self._moving = np.zeros((COLUMNS, COLUMNS)), MovingWall()
        self._odds = LOG_PRIOR.copy()
        self.changes, self.rhythm = 0, Rhythm(self.rhythm.followed)
        self._depth_s = 0.0
        self._x0 = location if location == location else 0.0
        self._depth, self._residual = 1e-3, nan
        self._scale, self._seconds = 1e3, DAMPING_S  # K_e and B_e / K_e for the priors
        self._surfaces = [(location, AS_TOLD_M, AS_TOLD), (location, std, NEAR),
                          (location, ANYWHERE_M, ELSEWHERE)]
        self._top: tuple[Ints, Array, Scene] | None = None
        self._touched = nan
        self._excited_at, self._excitation = -1, (inf, inf)

    def expect(self, surface: float, std: float) -> None:
        """Use a surface that the first touch has shown [m]."""
        self._begin_work(None)  # what is judged now has other surfaces
        std = max(std, AS_TOLD_M)
        self._surfaces = [(surface, std, NEAR), (surface, ANYWHERE_M, ELSEWHERE)]
        if not self.rhythm.blocks:
            self._x0 = surface

    def keep(self, contact: ContactFilter) -> None:
        """Use the noise and the level of another posterior on the same samples."""
        self.contact.keep(contact)

    def variance_of(self, force: _Force) -> _Force:
        """Return the variance of a force: of noise, and of what no law predicts of it [N^2]."""
        error = MODEL_ERROR * force
        return self.contact.variance + error * error * (MODEL_ERROR_S / self.period_s)

    @property
    def period_s(self) -> float:
        """Period of the samples as measured [s]; 0 before 20 of them."""
        return self.blocks.period_s

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
        if self._excited_at != self.rhythm.blocks:
            self._excited_at = self.rhythm.blocks
            self._excitation = self._bounds()
        return self._excitation

    def _bounds(self) -> tuple[float, float]:
        gram = self._runs.recent(_RECENT_S) if self.rhythm.blocks else self._gram
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
        self.blocks.restart()
        self._work: Iterator[None] | None = None
        self._touch_t, self._variance = -inf, 0.0

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
        felt_force, felt_x = felt or (force, x)
        blocks, contact = self.blocks, self.contact
        if not (-GREATEST < felt_force < GREATEST and isfinite(force) and isfinite(x)):
            return contact.state
        dt = blocks.step(t, felt_x)
        if not dt:
            return contact.state
        if not blocks.period_s:
            self._begin(t, felt_force, felt_x)
            return FREE
        if blocks.left:
            self._begin_work(self._parts_of(blocks.left))
            blocks.left = 0
        if self._work is not None:
            self._go_on()
        before = contact.state
        contact.take((dt,), (felt_force,), (felt_x,), *self.known[4:6])
        if contact.state != before:
            self._change(t if felt is None else nan, felt_x, before)
        self._learn(dt, (force, x, v, *bent), usable and not felt_x < self._outermost)
        return contact.state

    def run(self, t: Array, force: Array, x: Array, v: Array) -> Iterator[tuple[int, int]]:
        """
        Process consecutive samples as `take` does one by one, many at once where it can.

        Parameters
        ----------
        t, force, x, v : ndarray, shape (N,)
            As of `take`.

        Yields
        ------
        done, state : int, int
            Number of samples done, and the state after each of those since it yielded last; what
            is known was the same after all of them.

        """
        blocks, contact, ahead = self.blocks, self.contact, Ahead(t, force, x, v)
        table, done = np.stack([force, x, v, *np.zeros((3, len(t)))], axis=1), 0
        while done < len(t):
            end = ahead.steady_until(done, blocks)
            if self._work is not None or end - done < _FEW:
                yield done + 1, self.take(*ahead.sample(done))
                done += 1
                continue
            end = min(end, done + self._uneventful(table[done:end, :2]))
            before, outermost = contact.state, self._outermost
            last = done - 1 + contact.take(*ahead.part(done, end), *self.known[4:6])
            if last > done:
                if before == CONTACT:
                    table[done:last, 5] = ~(x[done:last] < outermost)  # NaN while not known
                blocks.extend(ahead.t[last - 1], table[done:last])
                yield last, before
            done = last + 1
            at, *sample = ahead.sample(last)
            dt = blocks.step(at, sample[1])
            if contact.state != before:
                self._change(at, sample[1], before)
            self._learn(dt, (*sample, 0.0, 0.0), not sample[1] < self._outermost)
            yield done, contact.state

    def _uneventful(self, later: Array) -> int:
        """Return the number of samples until a block may end, with the one that may end it."""
        blocks = self.blocks
        count = max(blocks.wanted - blocks.pending, 1)
        if self.contact.state == CONTACT and blocks.wanted == blocks.settled:
            shorts = blocks.shorts(later[:count])
            alarms = np.flatnonzero(self._alarms(shorts)) if shorts.size else _NONE
            if len(alarms):
                count = blocks.short * (int(alarms[0]) + 1) - blocks.pending % blocks.short
        return count

    @property
    def _outermost(self) -> float:
        """Return the position outside of which no force is that of the wall [m]."""
        return self.known.surface - _OUTSIDE * self.known.surface_std - _OUTSIDE_M

    def _change(self, t: float, x: float, before: int) -> None:
        """Begin or end a contact; at NaN if a short one is not to be used."""
        if before == CONTACT:
            self._leave(t)
        elif self.contact.state == CONTACT:
            self._touch(t, x)

    def _learn(self, dt: float, sample: tuple[float, ...], usable: bool) -> None:
        """Add a sample to the block; begin the work on a block that it completes."""
        blocks, taught = self.blocks, usable and self.contact.state == CONTACT
        windows = blocks.add(dt, sample, taught)
        if windows:
            self._begin_work(self._parts_of(windows))
        elif taught and blocks.pending and blocks.wanted == blocks.settled and not (
                blocks.pending % blocks.short) and self._alarms(blocks.shorts(_NONE))[0]:
            self._split()

    def _split(self) -> None:
        """Make a block of its own of the last samples, from which the wall may be another."""
        blocks = self.blocks
        last, windows = blocks.short // blocks.smoothing.hop, blocks.close()
        work = self._parts_of(min(last, windows), alarmed=True) if windows else iter(())
        if windows > last:
            work = chain(self._parts_of(windows - last, blocks.short), work)
        self._begin_work(work)

    def _alarms(self, shorts: Array) -> NDArray[np.bool_]:
        """Return which short blocks are not what the wall as known explains."""
        now = self.known
        if not now.valid:
            return np.zeros(shorts.shape[1], bool)
        K, B, T = now.stiffness, now.damping, self.blocks.period_s
        rest, rate = self.blocks.usual(K, shorts)  # of which outliers are no part
        off = rest - self.contact.level + K * now.surface - B * rate
        count, jitter = self.blocks.short, JITTER_S * K * rate
        error = MODEL_ERROR * shorts[0, :, -1]
        variance = _OF_MEDIAN / count * (
            self._variance + error * error * (MODEL_ERROR_S / T) + jitter * jitter
            + self.blocks.noise[0] * (K * K + 2.0 * count * (B / (count * T)) ** 2))
        return np.asarray(off * off > _ALARM * _ALARM * variance)

    def _begin_work(self, work: Iterator[None] | None) -> None:
        """Finish the work before, since what it has judged may change."""
        if self._work is not None:
            self._go_on(to_end=True)
        self._work = work

    def _leave(self, t: float) -> None:
        """Use what is left of a contact that is over; a short one has no rows but of its touch."""
        blocks = self.blocks
        windows = blocks.close()
        work = self._parts_of(windows) if windows else iter(())
        lasted = t - self._touch_t
        if lasted <= _TAP_S + 0.5 * blocks.period_s:
            count = 3 * blocks.smoothing.half + round(lasted / blocks.period_s)
            work = chain(work, self._learn_tap(blocks.last(count)))
        self._begin_work(chain(work, self._weigh_rest()))
        blocks.wanted = blocks.settled

    def _weigh_rest(self) -> Iterator[None]:
        """Weigh hypotheses with the last data of a contact."""
        if self.rhythm.unjudged:
            yield
            yield from self._judge()

    def _learn_tap(self, samples: Array) -> Iterator[None]:
        """Add the rows of a short contact, about the surface that it shows."""
        smooth, contact = self.blocks.smoothing, self.contact
        rising = before_release(smooth, samples[0] - contact.level, samples[1], contact.variance)
        if rising is None:
            return
        force, x = rising
        yield
        found = surface_of_touch(
            smooth, force, x, smooth.hop / self.contact.variance, self._gram, self._x0,
            self._scale, tuple(np.array(self._surfaces).T))  # type: ignore[arg-type]
        if found is None:
            return
        yield
        surface, std = found
        if std < _STRADDLES * self._move_to(surface):
            phi = smooth.rows(force, x, np.full(len(x), nan), self._x0, self.blocks.noise, True)
            self._add((phi * self._weights(phi)) @ phi.T, phi)
            yield
            if self.rhythm.blocks <= _START:
                self._find_scale()
            yield from self._judge()
            self._runs.begin()

    def _go_on(self, to_end: bool = False) -> None:
        """Do the next part of the work on the last block, so that no sample takes long."""
        assert self._work is not None
        parts = -(-_PARTS // max(self.blocks.wanted - 1, 1))  # done before the next block
        for _ in repeat(None) if to_end else range(parts):
            if next(self._work, _DONE) is _DONE:
                self._work = None
                return

    def _begin(self, t: float, force: float, x: float) -> None:
        """Collect the samples that tell period and noise."""
        self._first.append((t, force, x))
        if len(self._first) < FIRST:
            return
        stamps, forces, places = np.array(self._first).T
        self._first.clear()
        location, std = self._told
        self.blocks.begin(stamps)
        self.contact.start(forces, not places[-1] > location - 2.0 * std)

    def _touch(self, t: float, x: float) -> None:
        """Begin a contact: the wall may be another."""
        self._begin_work(None)
        self.blocks.close()  # nothing is learned from free flight
        self._touch_t = t
        self.rhythm.touch()
        self.blocks.wanted = 3 * self.blocks.short // 2  # the first whole window is longer
        known = self.known
        if known.surface != known.surface:
            self._x0 = x
            self._surfaces = [(x, ANYWHERE_M, 1.0)]
        elif x < known.surface - _OUTSIDE * known.surface_std - _OUTSIDE_M:  # another wall
            self.known = known._replace(surface=x, surface_std=ANYWHERE_M)
        self._touched = x

    # -- inference --------------------------------------------------------------------------

    @property
    def scene(self) -> Scene:
        """Return what all hypotheses share now."""
        return Scene(self._x0, self._depth, self._seconds, self.lag.lag)

    def _parts_of(
        self, windows: int, later: int = 0, alarmed: bool = False
    ) -> Iterator[None]:
        """Add a block and judge all hypotheses that it concerns, in parts of a tenth of a ms."""
        blocks, known = self.blocks, self.known
        self._variance = self.contact.variance
        if not blocks.select(windows, self.contact, later):
            return
        yield
        phi = blocks.rows(self._x0)
        phi[FORCE] -= self.inertia * phi[ACCELERATION]
        yield
        weights = self._weights(phi)
        surprise = self._surprise(phi, weights)
        if (alarmed or surprise > SURPRISE) and known.valid:
            wall = known.stiffness, known.damping, known.surface
            weights = weights * blocks.beside_jumps(wall, self.contact.variance)
        yield
        self._add((phi * weights) @ phi.T, phi)
        due = self.rhythm.is_due(surprise)
        if self.contact.state == CONTACT:
            blocks.wanted = (blocks.short, blocks.long, blocks.settled)[self.rhythm.length]
        if due:
            yield
            if self.rhythm.blocks <= _START:
                self._find_scale()
                yield
            yield from self._judge()
        self._runs.begin()

    def _weights(self, phi: Array) -> Array:
        """Return samples a row over its variance: of noises, stamps, and errors of any model."""
        K, force = self._scale, phi[FORCE]
        B = K * max(self._seconds - self.lag.lag[0], 0.0)
        smooth = self.blocks.smoothing
        variance = (self.variance_of(force) + np.square(JITTER_S * phi[FORCE_RATE])
                    + self.blocks.noise[0] * (K * K + B * B * smooth.rate_noise / smooth.noise))
        return np.asarray(smooth.hop / variance)

    def _add(self, gram: Array, phi: Array) -> None:
        """Add a block to all that is known; the older, the less."""
        seconds = phi.shape[1] * self.blocks.smoothing.hop * self.blocks.period_s
        fade = exp(-seconds / FADE_S)
        if self._touched == self._touched:
            if self.rhythm.blocks:
                self._runs.begin(self._touched)
            self._touched = nan
        self.rhythm.add(seconds)
        self._depth_s = min(self._depth_s + seconds, _DEPTH_S)
        depth = max(float(phi[DEPTH].mean()), 1e-5)
        self._depth += (depth - self._depth) * min(seconds / self._depth_s, 1.0)
        self._gram *= fade
        self._gram += gram
        self._runs.add(gram, fade, seconds)
        self._moving.add(gram, fade, seconds, self._scale)
        self._odds = LOG_PRIOR + (self._odds - LOG_PRIOR) * fade

    def _find_scale(self) -> None:
        """Find the stiffness that scales the priors of a wall that is not known."""
        centre, std, prior = np.tile(np.array(self._surfaces).T, len(_SCALES))
        scales_ = np.repeat(_SCALES, len(self._surfaces))
        what = Hypotheses(np.full(len(centre), KELVIN_VOIGT), scales_, centre, std)
        found = judge(np.repeat(self._gram[None], len(centre), axis=0), self.scene, what)
        odds = found.evidence + np.log(prior)
        odds[found.theta[:, 0] <= 0.0] = -inf
        K, B = found.theta[int(np.argmax(odds)), :2].tolist()
        self._rescale(K, B, float(_SCALES[0]), self.lag.lag[0])

    def _rescale(self, K: float, B: float, least: float, lag: float = 0.0) -> None:
        """Scale the priors by K_e, at least, and by B_e less what a lag has taken from it."""
        self._scale = max(K, least)
        self._seconds = max(B / self._scale + lag, 0.0)

    def _hypotheses(
        self, laws: Ints, surfaces: Sequence[tuple[float, float, float]]
    ) -> Hypotheses:
        count = len(surfaces)
        centre, std, _ = np.tile(np.array(surfaces).T, len(laws))
        return Hypotheses(np.repeat(laws, count), np.full(len(centre), self._scale), centre, std)

    def _judge(self) -> Iterator[None]:
        """Weigh laws and surfaces, and the changes of the best of them that is at rest."""
        scene = self.scene
        self.rhythm.judged()
        what = self._hypotheses(np.arange(_LAWS), self._surfaces)
        moves: NDArray[np.bool_] = what.law == MOVING
        grams = np.repeat(self._gram[None], len(moves), axis=0)
        grams[moves] = self._moving.gram
        judged = yield from judge_in_parts(grams, scene, what)
        yield
        odds = judged.evidence + self._prior_odds(what, moves) - _signs(judged, what.law, scene)
        still = int(np.argmax(np.where(moves, -inf, odds)))
        yield
        change, law, prior = None, int(what.law[still]), np.log([one[2] for one in self._surfaces])
        before = yield from self._runs.before(
            self._gram, scene, self._hypotheses(np.array([law]), self._surfaces), prior)
        if before is not None:
            yield
            alone = float(judged.evidence[still] + prior[still % len(prior)])
            block_s = min(self.blocks.wanted, self.blocks.long) * self.blocks.period_s
            change = yield from self._runs.since(before, scene, alone, block_s)
            # A wall at rest may have changed instead of moving.
            odds = odds + np.where(
                moves, 0.0, np.logaddexp.reduce(np.append(change.odds, 0.0)))
        yield
        gap, rest = float(odds[moves].max() - odds[~moves].max()), self._odds[:MOVING].max()
        self._moving.restart_if_far(self._gram, gap, float(rest))
        weights = np.exp(odds - odds.max())
        weights /= weights.sum()
        top = int(np.argmax(odds))
        self._top = what.law[top:top + 1], judged.theta[top], scene
        yield
        self._tell(weights, judged, what, change, law, scene)
        if self.rhythm.blocks > SETTLED:
            self._learn_lag(weights, judged)
        certain = decided(change)
        if change is not None and certain >= 0:
            yield
            self._commit(change, certain, scene, min(gap, 0.0))
        self._follow_surface()

    def _prior_odds(self, what: Hypotheses, moves: NDArray[np.bool_]) -> Array:
        prior = np.log([one[2] for one in self._surfaces])
        own = np.where(moves, self._moving.prior, self._odds[what.law])
        return np.asarray(own + np.tile(prior, _LAWS))

    def _commit(self, change: Change, best: int, scene: Scene, gap: float) -> None:
        """Drop the wall before a change; what was told of laws and motion stays a prior."""
        run = int(change.run[best])
        centre, std = float(change.centre[best]), float(change.std[best])
        gram = self._runs.commit(run)
        before = judge(
            np.repeat((self._gram - gram)[None], _LAWS, axis=0), scene,
            self._hypotheses(np.arange(_LAWS), [self._surfaces[change.place[best]]])).evidence
        most = float(before[:MOVING].max())
        self._odds = np.maximum(self._odds + before - most, LOG_PRIOR - _FARTHEST)
        self._gram = gram
        self._moving.restart(gram, gap + float(self._odds[:MOVING].max() - LOG_PRIOR[MOVING]))
        self.changes += 1
        self._surfaces = [(centre, std, STILL_THERE), (centre, ANYWHERE_M, ELSEWHERE)]
        if self._told[0] == self._told[0]:
            self._surfaces.append((self._told[0], AS_TOLD_M, 1.0 - STILL_THERE))
        K, B = change.judged.theta[best, :2].tolist()
        self._rescale(K, B, 1.0, self.lag.lag[0])
        self._depth_s = 0.0

    def _surprise(self, phi: Array, weights: Array) -> float:
        """Average and return the mean square residual of a block, in variances of the noise."""
        if self._top is None:
            return 0.0
        law, theta, scene = self._top
        if scene.x0 != self._x0:
            return inf
        columns = phi[CHOSEN[law[0], :UNKNOWNS]] * scales(law, scene.depth)[0, :UNKNOWNS, None]
        tau = scene.lag[0] if DEEP[law[0]] else 0.0
        error = phi[FORCE] + tau * phi[FORCE_RATE] - theta @ columns
        smooth = self.blocks.smoothing
        ratio = float(np.mean(error * error * weights)) / (smooth.hop * smooth.noise)
        if self.rhythm.early:
            return ratio
        before = self._residual if self._residual == self._residual else 1.0
        share = phi.shape[1] * smooth.hop * self.blocks.period_s / _RESIDUAL_S
        self._residual = before + share * (min(ratio, _CLIPPED * before + 1.0) - before)
        return ratio

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
        means, spreads = [], []
        for values, variances in zip(found[:3], found.variances):
            mean = float(weights @ values)
            means.append(mean)
            spreads.append(float(weights @ (variances + np.square(values - mean))))
        K, B, delta = means
        mass = judged.theta[MASS * (len(judged.theta) // _LAWS), 2]
        K_std = sqrt(spreads[0] + (STIFFNESS_FLOOR * K) ** 2)
        surface, surface_std = self.known.surface, self.known.surface_std
        if K_std < SURE * K:  # else nothing is found of it
            surface, surface_std = self._x0 + delta, sqrt(spreads[2]) + 2e-6
        self.known = Knowledge(
            K, B, K_std, sqrt(spreads[1] + (DAMPING_FLOOR * B) ** 2), surface, surface_std,
            float(mass) if of_law[MASS] > 0.5 else nan, tuple(of_law.tolist()),
            sqrt(self._residual) if self._residual == self._residual else nan)
        self._rescale(K, B, _SOFTER * self._scale)

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
        self._moving.move(table)
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
