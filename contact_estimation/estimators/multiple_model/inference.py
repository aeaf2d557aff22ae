# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Inference of a wall: laws, surfaces and changes, weighed by their evidence in blocks."""

from math import hypot, inf, nan, sqrt
from typing import Iterator

import numpy as np
from numpy.typing import NDArray

from .blocks import Blocks
from .constants import (
    ANYWHERE_M, COMMIT, EXACT_SURFACE_M, LEAST_STIFFNESS, NEAR_DEPTH, SHIFT, UNLIKELY)
from .contact import CONTACT, ContactFilter, FREE
from .earlier_walls import EarlierWalls
from .evidence import hypotheses, judge_in_parts, Judged, mixture, negativity, Scene, walls
from .knowledge import Knowledge
from .laws import (
    ACCELERATION, ACCELERATION_NOISE, Array, CURVED, EXPONENT, FORCE, IMPARTIAL, Ints,
    LOG_PRIOR, MOVING, NAMES, RATE)
from .report import Report
from .residuals import Residuals
from .rhythm import Rhythm, SETTLED, SURPRISE
from .runs import Change, decided, LEAST_BLOCKS, Touch
from .slow_states import judge_walks, LagPosterior
from .touch import before_release, surface_of_touch
from .wall_statistics import WallStatistics

_LAWS = len(NAMES)
_STRADDLES = 0.3  # of the depth: as well must the surface be known for rows across it
_NEGATIVE = 15.0  # log odds that negative stiffness or damping of a law on all data costs at most
_SOFTER = 0.03  # of the scale so far: a stiffness that is not known may be found negative
_START = 3  # blocks in which the scale of the priors is not known


class WallInference:
    """
    What is inferred of a wall from the blocks of its contacts.

    location, location_std: x_e as told, NaN where unknown, and its standard deviation [m]
    lag: prior of the lag of the force sensor [s]
    blocks, contact: the samples, and the noise of the force
    residuals: what the best law leaves of the force
    changes: how often the wall has become another
    inertia: known mass that moves with the tool, whose force the samples contain [kg]
    """

    def __init__(
        self, location: float, location_std: float, lag: tuple[float, float], blocks: Blocks,
        contact: ContactFilter,
    ) -> None:
        self._blocks, self._contact = blocks, contact
        self.lag, self.rhythm, self.inertia = LagPosterior(*lag), Rhythm(followed=False), 0.0
        std = max(location_std, EXACT_SURFACE_M)
        self._report = Report(Knowledge(
            nan, nan, nan, nan, location, std if location == location else ANYWHERE_M, nan,
            tuple(np.exp(LOG_PRIOR).tolist()), nan))
        self._sums = WallStatistics(location, std)
        self.residuals, self.changes = Residuals(blocks, contact), 0
        self._touched: Touch | None = None
        self._earlier = EarlierWalls()
        self._level = 0.0  # of the force in free flight, before this contact [N]
        self._excited_at, self._excitation = -1, (inf, inf)
        # Log odds of each law as last judged before something seems to have changed.
        self._of_laws: Array | None = None
        self._doubted = False

    def expect(self, surface: float, std: float) -> None:
        """Use a surface that the first touch has shown [m]."""
        self._sums.look_near(surface, max(std, EXACT_SURFACE_M), self._unfelt, False)
        if not self.rhythm.blocks:
            self._sums.x0 = surface

    @property
    def known(self) -> Knowledge:
        """Return what is known of the wall."""
        return self._report.known

    @property
    def scene(self) -> Scene:
        """Return what all hypotheses share now."""
        sums = self._sums
        return Scene(sums.x0, sums.depth, sums.seconds, self.lag.lag,
                     self._contact.level_variance)

    @property
    def law(self) -> str:
        """Name of the most probable law."""
        return NAMES[int(np.argmax(self.known.laws))]

    @property
    def excitation(self) -> tuple[float, float]:
        """Relative standard deviations of K_e and B_e; see `WallStatistics.excitation`."""
        if self._excited_at != self.rhythm.blocks:
            self._excited_at = self.rhythm.blocks
            self._excitation = self._sums.excitation()
        return self._excitation

    # -- blocks -----------------------------------------------------------------------------

    def touch(self, x: float, onset: float, free_s: float, rate: float) -> None:
        """
        Begin a contact: the wall may be another.

        x, onset: where the contact was noticed, and where the force may have begun [m]
        free_s, rate: time since the last contact [s], and rate of the tool [m/s]
        """
        self.rhythm.touch()
        self._level, self._sums.same = self._contact.level, None
        self._earlier.begin()
        known, unfelt, noise = self.known, self._unfelt, self._blocks.noise[0]
        late = rate * hypot(*self.lag.lag)
        error = EXACT_SURFACE_M + hypot(sqrt(noise) if noise == noise else 0.0, late)
        again = known.valid and not known.was_free_at(onset, known.stiffness, unfelt)
        self._touched = Touch(0.5 * (x + onset), 0.5 * abs(x - onset) + error, again)
        elsewhere = not x >= known.outermost or known.was_free_at(onset, LEAST_STIFFNESS, unfelt)
        elsewhere |= known.valid and known.force_left(onset, free_s) < unfelt and (
            not again or self._is_far_from_curve(self._touched.place))
        other = bool(self.rhythm.blocks) and known.valid and elsewhere
        if other:
            self._begin_anew()
        elif self.rhythm.blocks:
            for one in self._sums.walking:
                one.leave(free_s, self._sums.scale)
        if not self.rhythm.blocks:
            self._sums.x0 = onset  # powers of the depth are right near their reference only
            self._sums.look_near(*self._touched[:2], self._unfelt, not elsewhere)
            if elsewhere:
                self._report.known = known._replace(
                    surface=onset, surface_std=ANYWHERE_M if other else self._touched.std)

    def _is_far_from_curve(self, place: float) -> bool:
        """Return whether a curved law leads, whose columns are of no use from a place on [m]."""
        sums, law = self._sums, int(np.argmax(self.known.laws))
        unfelt = min(self._unfelt / (self.known.stiffness * sums.depth), 1.0)
        late = unfelt ** (1.0 / EXPONENT[law])  # of the depth: a soft beginning
        return bool(CURVED[law]) and abs(place - sums.x0) > (NEAR_DEPTH + late) * sums.depth

    def _begin_anew(self) -> None:
        """Forget a wall that is not the one that is touched, but which laws walls had so far."""
        self._sums, odds = WallStatistics(nan, ANYWHERE_M), self._sums.odds
        self._sums.odds = odds
        self.rhythm = Rhythm(self.rhythm.followed)
        self.residuals.best = self._of_laws = None
        self._report.known = self.known._replace(stiffness_std=nan, damping_std=nan)
        self._excited_at, self._doubted = -1, False
        self.changes += 1

    @property
    def _unfelt(self) -> float:
        """Return the force at a touch that CUSUM may not have seen [N]."""
        return 2.0 * SHIFT * sqrt(self._contact.variance)

    def parts_of(self, windows: int, later: int = 0, alarmed: bool = False) -> Iterator[None]:
        """Add a block and judge all hypotheses that it concerns, in parts of a tenth of a ms."""
        blocks, known = self._blocks, self.known
        self.residuals.begin_block()
        if not blocks.select(windows, self._contact, later):
            return
        yield
        phi = blocks.rows(self._sums.x0, self._sums.deepest)
        if self.inertia:
            phi[FORCE] -= self.inertia * phi[ACCELERATION]
        yield
        weights, told = self._weights(phi)
        surprise = self.residuals.surprise(phi, weights, self._sums.x0, self.rhythm.early)
        waits = self.rhythm.waits(surprise)
        if (alarmed or surprise > SURPRISE) and known.valid:
            wall = known.stiffness, known.damping, known.surface
            kept = blocks.next_to_jumps(wall, self._contact.variance)
            weights = weights * (np.minimum.accumulate(kept) if waits else kept)
        yield
        self._add(phi, weights, told)
        due = self.rhythm.is_due(surprise) and not waits
        if self._contact.state == CONTACT:
            blocks.wanted = (blocks.short, blocks.long, blocks.settled)[self.rhythm.length]
        if not due:
            self._report.follow_depth(self._sums)
        else:
            yield
            if self.rhythm.blocks <= _START:
                self._sums.find_scale(self.scene)
                yield
            yield from self._judge()
        self._sums.runs.begin()

    def learn_tap(self, samples: Array) -> Iterator[None]:
        """Add the rows of a short contact, about the surface that it shows."""
        smooth, contact, sums = self._blocks.smoothing, self._contact, self._sums
        rising = before_release(smooth, samples[0] - contact.level, samples[1], contact.variance)
        yield
        if rising is None:
            return
        force, x = rising
        found = surface_of_touch(
            smooth, force, x, smooth.hop / contact.variance, sums.gram, sums.x0,
            sums.scale, sums.places_without_touch)
        yield
        if found is not None and found[1] < _STRADDLES * sums.move_to(found[0]):
            phi = smooth.rows(force, x, np.full(len(x), nan), sums.x0, self._blocks.noise, True,
                              deepest=sums.deepest)
            self._add(phi, *self._weights(phi))
            yield
            if self.rhythm.blocks <= _START:
                sums.find_scale(self.scene)
            yield from self._judge()
            sums.runs.begin()

    @property
    def zero_has_changed(self) -> bool:
        """Whether free flight has another force than before a contact."""
        return abs(self._contact.level - self._level) > self._unfelt

    def leave(self) -> Iterator[None]:
        """End a contact: weigh its last data, and forget a change that only a release showed."""
        if self.rhythm.unjudged:
            yield
            yield from self._judge()
        earlier = self._earlier
        if earlier.inward is not None and earlier.changed:
            yield from self._return_to(earlier.inward)
        if self._contact.state == FREE and not self.zero_has_changed:
            earlier.inward = None

    def put_back(self, x: float) -> Iterator[None]:
        """Put back the wall before what a zero that has changed has done to it, free at x [m]."""
        earlier = self._earlier
        before = earlier.first or earlier.inward
        if before is None or not x < before.edge:
            return
        if before is earlier.inward:  # no step, but a drift: the wall is known with the zero now
            before.shift_force(self._contact.level - self._level)
        earlier.first = None
        yield from self._return_to(before)

    def _return_to(self, before: WallStatistics) -> Iterator[None]:
        self._sums, self._earlier.inward = before, None
        self.residuals.best = None
        self.changes += 1
        yield
        yield from self._judge()
        self._sums.runs.begin()

    def _weights(self, phi: Array) -> tuple[Array, list[Array]]:
        """
        Return samples a row over its variance, with the wall as known.

        Returns also what each of the laws that doubt rows divides that by.
        """
        sums, smooth, best = self._sums, self._blocks.smoothing, self.residuals.best
        own = [one.variance(phi, smooth.noise) for one in sums.doubting]
        unknown = np.square(self.inertia * phi[ACCELERATION_NOISE]) / smooth.noise
        for k, one in enumerate(sums.doubting):
            if best is not None and one.law == best[0][0]:  # then all doubt them
                unknown, own[k] = unknown + own[k], 0.0 * own[k]
        K, B = sums.scale, sums.scale * max(sums.seconds - self.lag.lag[0], 0.0)
        weights = self.residuals.weights(phi, K, B, unknown)
        return weights, [1.0 + weights / smooth.hop * one for one in own]

    def _add(self, phi: Array, weights: Array, told: list[Array]) -> None:
        """Add a block to all that is known; the older, the less."""
        smooth = self._blocks.smoothing
        seconds = phi.shape[1] * smooth.hop * self._blocks.period_s
        if self._touched is not None:
            if self.rhythm.blocks:
                self._sums.runs.begin(self._touched)
            self._touched = None
        self.rhythm.add(seconds)
        self._earlier.follow(float(phi[RATE].mean()), self._sums)
        self._sums.add(phi, weights, told, seconds, smooth.hop * smooth.noise)

    def _judge(self) -> Iterator[None]:
        """Weigh laws and surfaces, and the changes of the best of them that is at rest."""
        scene, sums = self.scene, self._sums
        self.rhythm.judged()
        what, grams, of_law = sums.posed(scene)
        moves: NDArray[np.bool_] = what.law >= MOVING
        yield
        judged = yield from judge_in_parts(grams, scene, what)
        prior = sums.place_prior
        negative = np.minimum(negativity(judged, what.law, scene), _NEGATIVE)
        odds = judged.evidence + (of_law + np.tile(prior, _LAWS)) - negative
        still = int(np.argmax(np.where(moves, -inf, odds)))
        for other in sums.doubting:
            best = int(np.where(what.law == other.law, odds, -inf).argmax())
            other.size = float(judged.theta[best, other.coefficient])
        yield
        of_laws = np.logaddexp.reduce(odds.reshape(_LAWS, -1), axis=1)
        if self._of_laws is None or not (self.rhythm.surprised or self._doubted):
            self._of_laws = of_laws
        law = int(np.argmax(self._of_laws[:MOVING]))
        change = yield from sums.runs.judge(
            sums.gram, scene, hypotheses(
                np.array([law]), sums.surfaces, sums.scale, scene.depth), prior,
            1 if self.rhythm.surprised else LEAST_BLOCKS,
            float(odds[still] + negative[still] - sums.odds[law]),
            min(self._blocks.wanted, self._blocks.long) * self._blocks.period_s)
        if change is not None:  # a wall at rest may have changed instead of moving
            odds = odds + np.where(moves, 0.0, np.logaddexp.reduce(np.append(change.odds, 0.0)))
        yield
        walks_by = judge_walks(sums.walking, odds.reshape(_LAWS, -1).max(1), sums.gram, sums.odds)
        weights = np.exp(odds - odds.max())
        weights /= weights.sum()
        self.rhythm.walks = bool(weights[moves].sum() > 0.5)
        top = int(np.argmax(odds))
        self.residuals.best = what.law[top:top + 1], judged.theta[top], scene
        yield
        others = []
        if change is not None:
            others.append((change.shares * weights[~moves].sum(), change.judged, law))
        if sums.same is not None:
            others.append(sums.judge_same(scene, float(odds[~moves].max())))
        self._report.publish(weights, judged, what.law, scene, sums, self.residuals, others)
        if self.known.valid:
            sums.rescale(self.known.stiffness, self.known.damping, _SOFTER * sums.scale)
        if self.rhythm.blocks > SETTLED:
            self.lag.learn(weights.reshape(_LAWS, -1), judged.theta, judged.P)
        certain, self._doubted = decided(change), change is not None and change.odds.max() > 0.0
        if change is not None and certain >= 0 and walks_by < -COMMIT:
            yield
            self._commit(change, certain, scene)
        self._follow_surface(weights, judged, what.law, scene)

    def _commit(self, change: Change, certain: int, scene: Scene) -> None:
        """Begin anew where a change of the wall is certain."""
        assert self._of_laws is not None  # a change is one from the laws before it
        self._earlier.note_change(self._sums.commit(change, certain, self._of_laws, scene))
        self.changes += not change.shift[certain]
        self._of_laws = None
        K, B = change.judged.theta[certain, :2].tolist()
        self._sums.rescale(K, B, 1.0, self.lag.lag[0])

    def _follow_surface(self, weights: Array, judged: Judged, laws: Ints, scene: Scene) -> None:
        """Move the reference of the columns to the surface: of curved laws where one may be."""
        surface, std = self.known.surface, self.known.surface_std if self.known.valid else inf
        curved = weights * IMPARTIAL[laws] * CURVED[laws]
        if curved.sum() > UNLIKELY:
            (_, _, delta), (_, _, variance) = mixture(
                curved / curved.sum(), walls(judged, laws, scene, ANYWHERE_M))
            surface, std = scene.x0 + delta, sqrt(variance)
        off = abs(surface - self._sums.x0)
        if off > max(2.0 * std, EXACT_SURFACE_M) and std < NEAR_DEPTH * self._sums.depth:
            self._sums.move_to(surface)
