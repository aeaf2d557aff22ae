# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Inference of a wall: laws, surfaces and changes, weighed by their evidence in blocks."""

from __future__ import annotations

from math import exp, inf, nan, sqrt
from typing import Iterator, TypeVar

import numpy as np
from numpy.typing import NDArray

from .blocks import Blocks
from .constants import (
    ANYWHERE_M, AS_TOLD, DAMPING_FLOOR, DAMPING_S, ELSEWHERE, EXACT_SURFACE_M, FADE_S, JITTER_S,
    MODEL_ERROR, MODEL_ERROR_S, NEAR, SHIFT, STIFFNESS_FLOOR, STILL_THERE)
from .contact import CONTACT, ContactFilter
from .evidence import (
    Hypotheses, hypotheses, judge, judge_in_parts, Judged, mixture, negativity, Scene, Wall, walls)
from .laws import (
    ACCELERATION, Array, CHOSEN, COLUMNS, DEEP, DEPTH, FORCE, FORCE_RATE, Ints,
    KELVIN_VOIGT, LOG_PRIOR, MASS, MOVING, NAMES, POWERS, RATE, scales, shifted_table, UNKNOWNS)
from .runs import (
    Change, decided, force_step, Rhythm, Runs, SETTLED, shifted, SURPRISE, Touch)
from .slow_states import Knowledge, LagPosterior, MovingWall, OUTSIDE, OUTSIDE_M, Replaced, SURE
from .touch import before_release, surface_of_touch

_LAWS = len(NAMES)
_ALARM = 4.0  # deviations of the median of a short block that ends a longer one
_OF_MEDIAN = 1.57  # its variance over that of a mean: pi / 2
_CLIPPED = 4.0  # times the mean so far: a change is no misfit
_STRADDLES = 0.3  # of the depth: as well must the surface be known for rows across it
_SOFTER = 0.03  # of the scale so far: a stiffness that is not known may be found negative
_START = 3  # blocks in which the scale of the priors is not known
_DEPTH_S = 1.0  # over which the mean depth is taken
_RESIDUAL_S = 2.0  # over which residuals are averaged
_RECENT_S = 0.5  # of the last data, at least
_SCALES: Array = np.geomspace(30.0, 1e6, 16)  # of a wall that is not known [N/m]
_FARTHEST = 20.0  # log odds of a law of the wall before a change
_Force = TypeVar('_Force', float, Array)


class WallInference:
    """
    What is inferred of a wall from the blocks of its contacts.

    A hypothesis is a small linear fit of some columns to the sum of the Gram matrices of all
    blocks, and its evidence is that of a Gaussian model.

    location, location_std: x_e as told, NaN where unknown, and its standard deviation [m]
    lag: prior of the lag of the force sensor [s]
    blocks, contact: the samples, and the noise of the force
    changes: how often the wall has become another
    inertia: known mass that moves with the wall, whose force the samples contain [kg]
    """

    def __init__(
        self, location: float, location_std: float, lag: tuple[float, float], blocks: Blocks,
        contact: ContactFilter,
    ) -> None:
        self._told = location, max(location_std, EXACT_SURFACE_M)
        self._blocks, self._contact = blocks, contact
        self.lag, self.rhythm, self.inertia = LagPosterior(*lag), Rhythm(False), 0.0
        self._variance = 0.0  # of the force, as the last block began
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
        self._depth, self._scatter, self._residual = 1e-3, 0.0, nan
        self._scale, self._seconds = 1e3, DAMPING_S  # K_e and B_e / K_e for the priors
        self._surfaces = [(location, EXACT_SURFACE_M, AS_TOLD), (location, std, NEAR),
                          (location, ANYWHERE_M, ELSEWHERE)]
        self._top: tuple[Ints, Array, Scene] | None = None
        self._touched: Touch | None = None
        self._outward = 0  # blocks in a row in which the tool moves out of the wall
        self._level = 0.0  # of the force in free flight, before this contact [N]
        self._replaced: Replaced | None = None
        self._excited_at, self._excitation = -1, (inf, inf)

    def expect(self, surface: float, std: float) -> None:
        """Use a surface that the first touch has shown [m]."""
        std = max(std, EXACT_SURFACE_M)
        self._look_near(surface, std)

    def _look_near(self, surface: float, std: float) -> None:
        self._surfaces = [(surface, std, NEAR), (surface, ANYWHERE_M, ELSEWHERE)]
        if not self.rhythm.blocks:
            self._x0 = surface

    @property
    def scene(self) -> Scene:
        """Return what all hypotheses share now."""
        return Scene(self._x0, self._depth, self._seconds, self.lag.lag)

    def variance_of(self, force: _Force) -> _Force:
        """Return the variance of a force: of noise, and of what no law predicts of it [N^2]."""
        error = MODEL_ERROR * force
        return self._contact.variance + error * error * (MODEL_ERROR_S / self._blocks.period_s)

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

    # -- blocks -----------------------------------------------------------------------------

    def touch(self, x: float, onset: float) -> None:
        """
        Begin a contact: the wall may be another.

        x, onset: where the contact was noticed, and where the force may have begun [m]
        """
        self.rhythm.touch()
        self._level, self._replaced = self._contact.level, None
        known = self.known
        noise = self._blocks.noise[0]
        error = EXACT_SURFACE_M + (sqrt(noise) if noise == noise else 0.0)
        again = known.valid and not self._was_free_at(onset, known.stiffness)
        self._touched = Touch(0.5 * (x + onset), 0.5 * abs(x - onset) + error, again)
        if not self.rhythm.blocks:
            self._x0 = onset  # powers of the depth are right near their reference only
        if known.surface != known.surface or not self.rhythm.blocks and self._was_free_at(
                onset, float(_SCALES[0])):
            self._look_near(*self._touched[:2])
            self.known = known._replace(surface=onset, surface_std=self._touched[1])
        elif x < known.surface - OUTSIDE * known.surface_std - OUTSIDE_M:  # another wall
            self.known = known._replace(surface=x, surface_std=ANYWHERE_M)

    def _was_free_at(self, onset: float, stiffness: float) -> bool:
        """Return whether free flight went deeper into the wall as known than such a one lets."""
        known = self.known
        inside = onset - known.surface - OUTSIDE * known.surface_std - OUTSIDE_M
        # A force above 2 SHIFT deviations would have been seen.
        return stiffness * inside > 2.0 * SHIFT * sqrt(self._contact.variance)

    def alarms(self, shorts: Array) -> NDArray[np.bool_]:
        """Return which short blocks are not what the wall as known explains."""
        now = self.known
        if not now.valid:
            return np.zeros(shorts.shape[1], bool)
        K, B, T = now.stiffness, now.damping, self._blocks.period_s
        rest, rate = self._blocks.usual(K, shorts)  # of which outliers are no part
        off = rest - self._contact.level + K * now.surface - B * rate
        count, jitter = self._blocks.short, JITTER_S * K * rate
        error = MODEL_ERROR * shorts[0, :, -1]
        variance = _OF_MEDIAN / count * (
            self._variance + error * error * (MODEL_ERROR_S / T) + jitter * jitter
            + self._blocks.noise[0] * (K * K + 2.0 * count * (B / (count * T)) ** 2))
        return np.asarray(off * off > _ALARM * _ALARM * variance)

    def parts_of(
        self, windows: int, later: int = 0, alarmed: bool = False
    ) -> Iterator[None]:
        """Add a block and judge all hypotheses that it concerns, in parts of a tenth of a ms."""
        blocks, known = self._blocks, self.known
        self._variance = self._contact.variance
        if not blocks.select(windows, self._contact, later):
            return
        yield
        phi = blocks.rows(self._x0)
        phi[FORCE] -= self.inertia * phi[ACCELERATION]
        yield
        weights = self._weights(phi)
        surprise = self._surprise(phi, weights)
        if (alarmed or surprise > SURPRISE) and known.valid:
            wall = known.stiffness, known.damping, known.surface
            weights = weights * blocks.next_to_jumps(wall, self._contact.variance)
        yield
        self._add((phi * weights) @ phi.T, phi)
        due = self.rhythm.is_due(surprise)
        if self._contact.state == CONTACT:
            blocks.wanted = (blocks.short, blocks.long, blocks.settled)[self.rhythm.length]
        if due:
            yield
            if self.rhythm.blocks <= _START:
                self._find_scale()
                yield
            yield from self._judge()
        self._runs.begin()

    def learn_tap(self, samples: Array) -> Iterator[None]:
        """Add the rows of a short contact, about the surface that it shows."""
        smooth, contact = self._blocks.smoothing, self._contact
        rising = before_release(smooth, samples[0] - contact.level, samples[1], contact.variance)
        if rising is None:
            return
        force, x = rising
        yield
        found = surface_of_touch(
            smooth, force, x, smooth.hop / self._contact.variance, self._gram, self._x0,
            self._scale, tuple(np.array(self._surfaces).T))  # type: ignore[arg-type]
        if found is None:
            return
        yield
        surface, std = found
        if std < _STRADDLES * self._move_to(surface):
            phi = smooth.rows(force, x, np.full(len(x), nan), self._x0, self._blocks.noise, True)
            self._add((phi * self._weights(phi)) @ phi.T, phi)
            yield
            if self.rhythm.blocks <= _START:
                self._find_scale()
            yield from self._judge()
            self._runs.begin()

    def zero_has_stepped(self, x: float) -> bool:
        """Return whether free flight at a place [m] has another force than before a contact."""
        off = abs(self._contact.level - self._level)
        return self._replaced is not None and x < self._replaced.surface and (
            off > 2.0 * SHIFT * sqrt(self._contact.variance))

    def leave(self) -> Iterator[None]:
        """End a contact: weigh its last data, and forget a change that only a release showed."""
        yield from self.weigh_rest()
        if self._replaced is not None and (
                self._outward > self.rhythm.blocks - self._replaced.blocks):
            yield from self.put_back()

    def put_back(self) -> Iterator[None]:
        """Put the wall before a change back: it is not known when the zero has stepped."""
        if self._replaced is None:  # forgotten since
            return
        (self._gram, self._odds, self._surfaces, self._scale, self._seconds, self._depth,
         *_) = self._replaced
        self._replaced, self._top = None, None
        self._runs.clear()
        self._moving.restart(self._gram, float(self._odds[:MOVING].max()))
        self.changes += 1
        yield
        yield from self._judge()
        self._runs.begin()

    def weigh_rest(self) -> Iterator[None]:
        """Weigh hypotheses with the last data of a contact."""
        if self.rhythm.unjudged:
            yield
            yield from self._judge()

    def _weights(self, phi: Array) -> Array:
        """Return samples a row over its variance: of noises, stamps, and errors of any model."""
        K, force = self._scale, phi[FORCE]
        B = K * max(self._seconds - self.lag.lag[0], 0.0)
        smooth = self._blocks.smoothing
        variance = (self.variance_of(force) + np.square(JITTER_S * phi[FORCE_RATE])
                    + self._blocks.noise[0] * (K * K + B * B * smooth.rate_noise / smooth.noise))
        return np.asarray(smooth.hop / variance)

    def _add(self, gram: Array, phi: Array) -> None:
        """Add a block to all that is known; the older, the less."""
        seconds = phi.shape[1] * self._blocks.smoothing.hop * self._blocks.period_s
        fade = exp(-seconds / FADE_S)
        if self._touched is not None:
            if self.rhythm.blocks:
                self._runs.begin(self._touched)
            self._touched = None
        self.rhythm.add(seconds)
        self._outward = self._outward + 1 if float(phi[RATE].mean()) < 0.0 else 0
        self._depth_s = min(self._depth_s + seconds, _DEPTH_S)
        depth, gain = max(float(phi[DEPTH].mean()), 1e-5), min(seconds / self._depth_s, 1.0)
        off = depth - self._depth
        self._scatter = (1.0 - gain) * (self._scatter + gain * off * off) + gain * float(
            phi[DEPTH].var())
        self._depth += gain * off
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

    def _judge(self) -> Iterator[None]:
        """Weigh laws and surfaces, and the changes of the best of them that is at rest."""
        scene = self.scene
        self.rhythm.judged()
        what = hypotheses(np.arange(_LAWS), self._surfaces, self._scale)
        moves: NDArray[np.bool_] = what.law == MOVING
        grams = np.repeat(self._gram[None], len(moves), axis=0)
        grams[moves] = self._moving.gram
        judged = yield from judge_in_parts(grams, scene, what)
        yield
        odds = judged.evidence + self._prior_odds(what, moves) - negativity(
            judged, what.law, scene)
        still = int(np.argmax(np.where(moves, -inf, odds)))
        yield
        change, law, prior = None, int(what.law[still]), np.log([one[2] for one in self._surfaces])
        before = yield from self._runs.before(
            self._gram, scene, hypotheses(np.array([law]), self._surfaces, self._scale),
            prior)
        if before is not None:
            yield
            alone = float(judged.evidence[still] + prior[still % len(prior)])
            block_s = min(self._blocks.wanted, self._blocks.long) * self._blocks.period_s
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
        self._report_knowledge(weights, judged, what, change, law, scene)
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
        if self._replaced is None:
            self._replaced = Replaced(
                self._gram - gram, self._odds, self._surfaces, self._scale, self._seconds,
                self._depth, centre - OUTSIDE * std, self.rhythm.blocks)
        if change.shifted[best]:
            rest = (self._gram - gram)[None]
            gram = shifted(gram + rest, rest, force_step(
                np.array([self._scale]), self._depth))[0][0]
            std = max(self._depth, std)
        else:
            surface = self._surfaces[change.place[best]]
            before = judge(np.repeat((self._gram - gram)[None], _LAWS, axis=0), scene,
                           hypotheses(np.arange(_LAWS), [surface], self._scale)).evidence
            most = float(before[:MOVING].max())
            self._odds = np.maximum(self._odds + before - most, LOG_PRIOR - _FARTHEST)
            self.changes += 1
        self._gram = gram
        self._moving.restart(gram, gap + float(self._odds[:MOVING].max() - LOG_PRIOR[MOVING]))
        self._surfaces = [(centre, std, STILL_THERE),
                          (centre, max(self._depth, std), ELSEWHERE)]
        if self._told[0] == self._told[0]:
            self._surfaces.append((self._told[0], EXACT_SURFACE_M, 1.0 - STILL_THERE))
        K, B = change.judged.theta[best, :2].tolist()
        self._rescale(K, B, 1.0, self.lag.lag[0])

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
        smooth = self._blocks.smoothing
        ratio = float(np.mean(error * error * weights)) / (smooth.hop * smooth.noise)
        if self.rhythm.early:
            return ratio
        before = self._residual if self._residual == self._residual else 1.0
        share = min(phi.shape[1] * smooth.hop * self._blocks.period_s / _RESIDUAL_S, 1.0)
        self._residual = before + share * (min(ratio, _CLIPPED * before + 1.0) - before)
        return ratio

    def _learn_lag(self, weights: Array, judged: Judged) -> None:
        """Learn the lag where a spring and a damper are all that is there."""
        of_law = weights.reshape(_LAWS, -1)
        if of_law[KELVIN_VOIGT].sum() > 0.5:
            k = MASS * of_law.shape[1] + int(np.argmax(of_law[KELVIN_VOIGT]))
            self.lag.learn(judged.theta[k], judged.P[k])

    def _report_knowledge(
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
        (K, B, delta), spreads = mixture(weights, found)
        mass = judged.theta[MASS * (len(judged.theta) // _LAWS), 2]
        K_std = sqrt(spreads[0] + (STIFFNESS_FLOOR * K) ** 2)
        surface, surface_std = self.known.surface, self.known.surface_std
        if K_std < SURE * K:  # else nothing is found of it
            surface, surface_std = self._x0 + delta, sqrt(spreads[2]) + 2e-6
        self.known = Knowledge(
            K, B, K_std, sqrt(spreads[1] + (DAMPING_FLOOR * B) ** 2), surface, surface_std,
            float(mass) if of_law[MASS] > 0.5 else nan, tuple(of_law.tolist()),
            sqrt(self._residual) if self._residual == self._residual else nan,
            tuple((np.sqrt(POWERS**2 @ of_law * self._scatter) / self._depth).tolist()))
        if self.known.valid:
            self._rescale(K, B, _SOFTER * self._scale)

    def _follow_surface(self) -> None:
        """Move the reference of the columns to the surface where that is known better."""
        known = self.known
        off = abs(known.surface - self._x0)
        if known.valid and off > max(2.0 * known.surface_std, EXACT_SURFACE_M) and (
                known.surface_std < 0.3 * self._depth):
            self._move_to(known.surface)

    def _move_to(self, surface: float) -> float:
        """Move the reference of the columns to a place [m]; return the mean depth from there."""
        delta = surface - self._x0
        table = shifted_table(delta)
        self._gram = table @ self._gram @ table.T
        self._moving.move(table)
        self._runs.move(table)
        if self._replaced is not None:
            gram = table @ self._replaced.gram @ table.T
            self._replaced = self._replaced._replace(gram=gram)
        self._x0 += delta
        self._depth = max(self._depth - delta, 1e-5)
        return self._depth
