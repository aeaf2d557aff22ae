# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The sufficient statistics of a wall: Gram matrices of its blocks, and scales of the priors."""

from collections import deque
from copy import copy
from math import exp, hypot, inf, log, nan, sqrt
from typing import Sequence

import numpy as np

from .constants import (
    ANYWHERE_M, AS_TOLD, COMMIT, DAMPING_S, ELSEWHERE, EXACT_SURFACE_M, FADE_S, LEAST_STIFFNESS,
    NEAR, STIFFEST, STILL_THERE, UNLIKELY)
from .evidence import Hypotheses, hypotheses, judge, Judged, Place, Scene
from .knowledge import OUTSIDE
from .laws import (
    Array, COLUMNS, CREEPING, DEPTH, DRIFTING, FORCE, FRICTION, KELVIN_VOIGT, LOG_PRIOR, MASS,
    MOVING, NAMES, ONE, RATE, SET, shifted_table, TIME)
from .runs import Change, in_doubt, places, Runs, shifted
from .slow_states import DoubtedRows, MovingWall, OwnData

_SCALES: Array = np.geomspace(LEAST_STIFFNESS, STIFFEST, 16)
_DEPTH_S = 1.0  # over which the mean depth is taken
_RECENT_S = 0.5  # of the last data, at least
_KEPT = 2  # places of a surface before a change
_FARTHEST = 20.0  # log odds of a law of the wall before a change


class SameWall:
    """
    The wall before a change, in case not the wall has changed but the zero of the sensor.

    before (22, 22): Gram matrix of all data before it
    what: law, scale and surface
    variance: of the step [N^2]
    odds: log odds against another wall
    """

    def __init__(self, before: Array, what: Hypotheses, variance: float, odds: float) -> None:
        self._before, self.what, self._variance, self.odds = before, what, variance, odds
        self._gap = nan  # by which its evidence counts more than that of the other wall

    def fade(self, fade: float) -> None:
        """Count what was before the less, the older it is."""
        self._before *= fade
        self._gap *= fade

    def move(self, table: Array) -> None:
        """Move the reference of all columns; see `shifted_table`."""
        self._before = table @ self._before @ table.T

    def data(self, since: Array) -> tuple[Array, float]:
        """
        Return all data, the force since the change shifted, and what the evidence loses.

        since (22, 22): of the data since the change
        """
        (gram,), (cost,) = shifted(self._before + since, since[None], np.array([self._variance]))
        return gram, float(cost)

    def data_of_now(self, since: Array, x0: float) -> Array:
        """Return all data, of which those before had another zero or stiffness."""
        return in_doubt(self._before + since, self._before, float(self.what.centre[0]) - x0,
                        self._variance)

    def step_again(self, other: Array, odds: float) -> None:
        """Note another step, after data (22, 22) of what seemed another wall."""
        self._before, _ = self.data(other)
        self._gap, self.odds = nan, self.odds + odds

    def judge(self, since: Array, scene: Scene, evidence: float) -> Judged:
        """Judge it by the data since the change, of which another wall has some evidence."""
        gram, cost = self.data(since)
        judged = judge(gram[None], scene, self.what)
        gained = float(judged.evidence[0]) + cost - evidence
        if self._gap != self._gap:
            self._gap = self.odds - gained
        self.odds = self._gap + gained
        return judged


class WallStatistics:
    """
    What the blocks of a wall add up to; its hypotheses are judged by this alone.

    location, std: x_e as told, NaN where unknown, and its standard deviation [m]
    gram (22, 22): sum of the Gram matrices of all blocks, the older, the less
    walking, doubting: the same of walls that move or drift, of laws that doubt some rows
    runs: the same since every time of a possible change
    odds: log odds of each law
    surfaces: where the surface may be
    x0, deepest: reference of the columns, and greatest position so far [m]
    depth, scatter: mean depth of late [m], its variance [m^2]
    scale, seconds: K_e [N/m] and B_e / K_e [s] for the priors
    edge: outside of which the tool is free [m]
    same: the wall before the last change where the zero may have stepped instead, else None
    """

    def __init__(self, location: float, std: float) -> None:
        self._told = (location, std) if location == location else (0.0, inf)
        self.gram, self.runs = np.zeros((COLUMNS, COLUMNS)), Runs()
        self.walking = [MovingWall(law) for law in (MOVING, CREEPING, DRIFTING)]
        self.doubting = [DoubtedRows(law) for law in (FRICTION, MASS)]
        self.odds = LOG_PRIOR.copy()
        self.surfaces = [Place(location, EXACT_SURFACE_M, AS_TOLD), Place(location, std, NEAR),
                         Place(location, ANYWHERE_M, ELSEWHERE)]
        self.x0 = location if location == location else 0.0
        self.depth, self.scatter, self.deepest = 1e-3, 0.0, -inf
        self._depths: deque[tuple[float, float, float]] = deque()  # of late: time, place, variance
        self.scale, self.seconds = 1e3, DAMPING_S
        self.same: SameWall | None = None
        self.edge = inf

    def look_near(self, surface: float, std: float, unfelt: float, as_told: bool) -> None:
        """
        Expect the surface at a place.

        surface, std: place and its standard deviation [m]
        unfelt: force that it may have there already [N]
        as_told: whether it may also be exactly as told
        """
        told = self._told if as_told else (0.0, inf)
        self.surfaces = [*(self.surfaces[:1] if as_told else []), Place(
            surface, std, NEAR, unfelt, *told), Place(surface, ANYWHERE_M, ELSEWHERE)]

    def copied(self) -> 'WallStatistics':
        """Return a copy to go on from, with no runs yet."""
        other = copy(self)
        other.walking = [copy(one) for one in self.walking]
        other.doubting = [copy(one) for one in self.doubting]
        other._depths, other.runs, other.same = self._depths.copy(), copy(self.runs), None
        other.runs.clear()
        return other

    def shift_force(self, more: float) -> None:
        """Take a force from that of all data [N]."""
        table = np.eye(COLUMNS)
        table[FORCE, ONE] = -more
        self.gram = table @ self.gram @ table.T
        for one in self.own:
            one.move(table)

    @property
    def own(self) -> list[OwnData]:
        """Return the laws whose data are their own."""
        return [*self.walking, *self.doubting]

    @property
    def place_prior(self) -> Array:
        """Return the log prior of each surface."""
        return np.log([one.probability for one in self.surfaces])

    def add(self, phi: Array, weights: Array, told: list[Array], seconds: float,
            samples: float) -> None:
        """
        Add a block that lasts so long; the older, the less.

        weights, told (N,): of its rows phi, and what the laws that doubt rows divide them by
        samples: independent ones in a row
        """
        t = np.linspace(1.0 / phi.shape[1] - 1.0, 0.0, phi.shape[1])
        phi[TIME] = seconds * t + self.seconds  # the damper feels a speed at once
        gram = (phi * weights) @ phi.T
        fade = exp(-seconds / FADE_S)
        self.deepest = max(self.deepest, self.x0 - float(phi[SET].min()))
        self._note_depth(seconds, phi[DEPTH])
        self.gram = fade * self.gram + gram
        if self.same is not None:
            self.same.fade(fade)
        self.runs.add(gram, fade, seconds)
        for one in self.walking:
            one.add(gram, fade, seconds, self.scale)
        for law, more in zip(self.doubting, told):
            law.add(phi, weights, more, fade, samples)
        self.odds = LOG_PRIOR + (self.odds - LOG_PRIOR) * fade

    @property
    def places_without_touch(self) -> tuple[Array, Array, Array]:
        """Return centre, deviation and weight of each surface as if no touch had been felt."""
        centre, std, weight, _, told, told_std = np.array(self.surfaces).T
        is_told = told_std < inf
        return np.where(is_told, told, centre), np.where(is_told, told_std, std), weight

    def _note_depth(self, seconds: float, depths: Array) -> None:
        """Take mean and variance of the depth over the last second."""
        late, count = self._depths, len(depths)
        middle = float(np.add.reduce(depths)) / count
        variance = float(np.add.reduce(np.square(depths - middle))) / count
        late.append((seconds, self.x0 + middle, variance))
        while sum([one[0] for one in late]) - late[0][0] >= _DEPTH_S:
            late.popleft()
        weight, place, variance = np.array(late).T
        weight = weight / weight.sum()
        mean = float(weight @ place)
        self.depth = max(mean - self.x0, 1e-5)
        self.scatter = float(weight @ (variance + np.square(place - mean)))

    def move_to(self, surface: float) -> float:
        """Move the reference of the columns to a place [m]; return the mean depth from there."""
        delta = surface - self.x0
        table = shifted_table(delta)
        self.gram = table @ self.gram @ table.T
        for one in self.own:
            one.move(table)
        self.runs.move(table)
        if self.same is not None:
            self.same.move(table)
        self.x0 += delta
        self.depth = max(self.depth - delta, 1e-5)
        return self.depth

    def rescale(self, K: float, B: float, least: float, lag: float = 0.0) -> None:
        """Scale the priors by K_e, at least, and by B_e less what a lag has taken from it."""
        self.scale = max(K, least)
        self.seconds = max(B / self.scale + lag, 0.0)

    def find_scale(self, scene: Scene) -> None:
        """Find the stiffness that scales the priors of a wall that is not known."""
        law = np.array([KELVIN_VOIGT])
        what = Hypotheses(*(np.concatenate(one) for one in zip(*(
            hypotheses(law, self.surfaces, scale, scene.depth) for scale in _SCALES))))
        found = judge(self.gram[None].copy(), scene, what)
        odds = found.evidence + np.tile(self.place_prior, len(_SCALES))
        odds[found.theta[:, 0] <= 0.0] = -inf
        K, B = found.theta[int(np.argmax(odds)), :2].tolist()
        self.rescale(K, B, LEAST_STIFFNESS, scene.lag[0])

    def posed(self, scene: Scene) -> tuple[Hypotheses, Array, Array]:
        """Return all laws, each with each surface, Gram matrices of the laws, and log odds."""
        what = hypotheses(np.arange(len(NAMES)), self.surfaces, self.scale, scene.depth)
        grams, odds = np.repeat(self.gram[None], len(NAMES), axis=0), self.odds[what.law]
        for one in self.own:
            grams[one.law] = one.gram
        for one in self.walking:
            own = what.law == one.law
            far = np.hypot(what.std[own], one.walked)
            odds[own] = one.prior + np.log(far / what.std[own])  # whose cost the walk has paid
            what.std[own] = far
        for other in self.doubting:
            odds[what.law == other.law] += other.gained
        return what, grams, odds

    def excitation(self) -> tuple[float, float]:
        """
        Return relative standard deviations of K_e and B_e that recent data would leave alone.

        The Cramer-Rao bound with the surface as known: eq. (27) made quantitative.
        """
        K, B = self.scale, max(self.seconds, DAMPING_S) * self.scale
        (kk, kb), (_, bb) = self.runs.recent(_RECENT_S)[
            np.ix_([DEPTH, RATE], [DEPTH, RATE])].tolist()
        determinant = kk * bb - kb * kb
        if kk <= 0.0:
            return inf, inf
        if determinant <= 1e-12 * kk * bb:
            return 1.0 / (K * sqrt(kk)), inf
        return sqrt(bb / determinant) / K, sqrt(kk / determinant) / B

    # -- changes ----------------------------------------------------------------------------

    def commit(
        self, change: Change, best: int, of_laws: Array, scene: Scene
    ) -> 'WallStatistics':
        """
        Drop the wall before a change and return it; its laws and motion stay a prior.

        of_laws: log odds of each law before it
        """
        centre, std = float(change.centre[best]), float(change.std[best])
        other = not change.shift[best]
        gram = self.runs.commit(int(change.run[best]))
        before = self.gram - gram
        replaced = self.copied()
        replaced.gram, replaced.edge = before, centre - OUTSIDE * std
        replaced.restart_own()
        if other:
            law = of_laws[:MOVING].argmax(axis=0, keepdims=True)
            what = hypotheses(law, self.surfaces, self.scale, scene.depth)
            judged = judge(before[None].copy(), scene, what)
            odds = judged.evidence + self.place_prior
            order = np.argsort(-odds)
            self.odds = np.maximum(of_laws - of_laws[law], LOG_PRIOR - _FARTHEST)
            self._doubt(change, best, before, hypotheses(
                law, [self.surfaces[order[0]]], self.scale, scene.depth))
            if change.as_before[best]:
                weights = np.exp(odds - odds.max())
                kept = np.stack([*places(judged, scene), weights / weights.sum()], axis=1)
                self._go_on(gram, kept[order[:_KEPT]].tolist())
            else:
                self._go_on(gram, [(centre, std, 1.0)])
        else:
            self.same = None
            shift = float(change.shift[best])
            self._go_on(in_doubt(gram + before, before, centre - self.x0, shift),
                        [(centre, hypot(std, sqrt(shift) / self.scale), 1.0)])
        return replaced

    def _go_on(self, gram: Array, kept: Sequence[tuple[float, float, float]]) -> None:
        """Use other data, and a surface that is at one of some places or elsewhere."""
        self.gram = gram
        self.restart_own()
        centre, std, _ = kept[0]
        self.surfaces = [*(Place(at, error, STILL_THERE * p) for at, error, p in kept
                           if p > UNLIKELY), Place(centre, max(self.depth, std), ELSEWHERE)]

    def restart_own(self) -> None:
        """Let laws whose data are their own begin from those of all others."""
        for one in self.own:
            one.restart(self.gram, float(self.odds[:MOVING].max()))

    def _doubt(self, change: Change, best: int, before: Array, what: Hypotheses) -> None:
        """Keep the wall before a change, in case the zero has stepped instead."""
        again = np.where(change.shift, change.odds, -inf)
        k = int(again.argmax())
        if again[k] == -inf:
            self.same = None
        elif self.same is not None and self.same.odds > 0.0:
            self.same.step_again(before, float(again[k] - change.odds[best]))
        else:
            self.same = SameWall(before, what, float(change.shift[k]),
                                 float(again[k] - change.odds[best]))

    def judge_same(self, scene: Scene, evidence: float) -> tuple[Array, Judged, int]:
        """
        Judge whether the zero has stepped instead of the wall; decide where that is certain.

        evidence: of the wall as it is since then
        Returns share, judged, law: probability (1,), coefficients, and index of the law
        """
        same = self.same
        assert same is not None
        judged = same.judge(self.gram, scene, evidence)
        if same.odds > COMMIT:
            self._go_on(same.data_of_now(self.gram, self.x0), [(
                float(same.what.centre[0]), max(self.depth, float(same.what.std[0])), 1.0)])
        if not log(UNLIKELY) < same.odds < COMMIT:
            self.same = None
        share = np.array([1.0 / (1.0 + exp(-max(same.odds, -50.0)))])
        return share, judged, int(same.what.law[0])
