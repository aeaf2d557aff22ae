# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The models of an arm that are compared: laws at joints, links, and all of it."""

from functools import lru_cache
from math import log
from typing import Callable, Iterable, Sequence

import numpy as np

from .channels import Term
from .covariance import without_each
from .gram import Fitted, Gram
from .joint_judge import all_possible, JointJudge
from ..fit.constants import ARM, Constants
from ..fit.evidence import Evidence, Scored
from ...physics.joint_effects import JOINT_EFFECTS, Place

Model = frozenset[Term]

MOST_LAWS = 60  # of a model: an arm of seven joints has some twenty
_PLAIN = ('dry_friction', 'viscous_friction', 'inertia', 'sensor_zero')
"""Groups that most joints have; others may be bent to hide a law that joints share."""

_PAIR = ('dry_friction', 'viscous_friction')
_WIDE = ('link', 'arm')  # places of laws that act in all joints
_USUAL = ('coulomb_friction', 'viscous_friction', 'reflected_inertia', 'joint_spring',
          'force_bias')

_TRIED, _STEPS, _ROUNDS = 4, 12, 3  # shared laws refined; steps in a joint; passes over joints
_NEAR = 8.0  # nats below the best, up to which a law is compared in the place of another
_BESIDES = 4  # laws that are compared in the place of one
_ORDER = {name: k for k, name in enumerate(JOINT_EFFECTS)}


@lru_cache(maxsize=None)
def group_of(term: Term) -> tuple[str, Place, int]:
    """Return what a model has once at most: kind of law, place and file."""
    effect = JOINT_EFFECTS[term.effect]
    place = term.place[:2] if isinstance(term.place, tuple) else term.place
    return effect.group or effect.family, place, term.file


class ArmModels:
    """
    Models of an arm: its description with laws at their places.

    Every model has the calibration of its links and of the sensors of its torques.
    """

    def __init__(
        self, gram: Gram, progress: Callable[[str], None] = lambda text: None,
        constants: Constants = ARM,
    ) -> None:
        self.gram, self._progress, self.constants = gram, progress, constants
        every = [term for term in gram.channels.terms if not _is_rotor(gram, term)]
        self._shared = [term for term in every if term in gram.shared]
        self._shared_laws = frozenset(self._shared)
        self._local = {j: [term for term in every if term.place == j and term not in gram.shared]
                       for j in gram.joints}
        self._usual = {j: {min(term for term in terms if (term.effect, term.file) == one)
                           for one in {(term.effect, term.file) for term in terms}
                           if one[0] in _USUAL} for j, terms in self._local.items()}
        counts: dict[str, set[Place]] = {}
        for term in every:
            counts.setdefault(term.effect, set()).add(term.place)
        self._places = {name: log(len(places)) for name, places in counts.items()}
        self.cost = lru_cache(None)(self._cost)
        self._seen = dict[Model, Scored]()
        self._begin()
        self._plain = Model()
        for _ in range(2):
            self._plain = self._refined(self._plain)
            left_out = self._fitted(self._plain).found[1].left_out
            self.gram.set_weights(self.gram.weights_for(left_out))
            self._begin()

    def _begin(self) -> None:
        """Forget all fits, which had other weights of the joints."""
        self._seen.clear()
        self._zero = Evidence(
            self._fitted(Model()), np.zeros(len(self.gram.joints)), self.gram.floor,
            self.constants, white=False)

    def evidence(self) -> Evidence:
        """Return what models are compared against: the description, calibrated."""
        return self._zero

    def score(self, model: Model) -> float:
        """Return the score of a model; minus infinity if its values are not possible."""
        scored = self._scored(model)
        return -np.inf if scored is None else self._zero.score(scored)

    def _scored(self, model: Model) -> Scored | None:
        """Return a fitted model; None if its values are not possible."""
        one = self._fitted(model)
        return one if all_possible(one.found[1].theta) else None

    def _fitted(self, model: Model) -> Scored:
        """Fit a model, and let it predict the blocks that it was not fitted on."""
        if model not in self._seen:
            self._seen[model] = self.as_scored(model, self.gram.fit(model))
        return self._seen[model]

    def as_scored(self, model: Model, found: Fitted) -> Scored:
        """Return a fit with its prior: one more unit is the misfit that every torque has."""
        laws = sorted(model, key=_rank)
        local = [term for term in laws if term not in self.gram.shared]
        shaped = sum(self._has_shape(term) for term in laws)
        return Scored(
            tuple(map(label, laws)), tuple(map(family_of, laws)),
            (len(laws), [_rank(term) for term in laws]),
            self.gram.beyond(found.left_out), self.gram.beyond(found.fitted),
            self.gram.counts,
            found.known + shaped + sum(len(self.gram.scales[term]) for term in local),
            sum(JOINT_EFFECTS[term.effect].laws for term in laws),
            sum(JOINT_EFFECTS[term.effect].is_curve for term in laws), (model, found),
            found.surprise + sum(self.rarity(term) for term in laws))

    @staticmethod
    def _has_shape(term: Term) -> bool:
        """Return whether a law's shape is a value that is told, and not a matter of smoothing."""
        return JOINT_EFFECTS[term.effect].shape is not None and term.effect != 'coulomb_friction'

    def _cost(self, term: Term) -> float:
        """Return the log prior odds against a law of one joint, with its coefficients."""
        effect, c = JOINT_EFFECTS[term.effect], self.constants
        values = len(self.gram.scales[term]) + self._has_shape(term)
        return (c.parameter * values + c.law * effect.laws + c.curve * effect.is_curve
                + self.rarity(term))

    def rarity(self, term: Term) -> float:
        """Return the log prior odds against a law at just this place, of all where it may be."""
        return JOINT_EFFECTS[term.effect].laws * self._places[term.effect]

    def _can_add(self, model: Model, terms: Iterable[Term]) -> list[Term]:
        taken = list(map(group_of, model))
        # What all files have is that of each; two files may differ.
        return [term for term in terms if not any(
            group[:2] == one[:2] and (group[2] == one[2] or -1 in (group[2], one[2]))
            for group in [group_of(term)] for one in taken)]

    # Laws of one joint.

    def _refined(self, model: Model) -> Model:
        """Improve the laws of each joint in turn, given those that joints share."""
        best, since = model, 0
        every = [*enumerate(self.gram.joints)]
        for count, (k, j) in enumerate(every * _ROUNDS):
            better = self._climbed(best, k, j, count < len(every))
            changed = better != best and self.score(better) > self.score(best)
            best, since = (better, 0) if changed else (best, since + 1)
            if since == len(every):
                break
        return self._pruned(best)

    def _climbed(self, model: Model, k: int, j: int, wide: bool) -> Model:
        """Improve the laws of one joint, `wide`: from all usual ones, too."""
        judge = JointJudge(self, model, k)
        mine = frozenset(judge.local)
        # Laws that lack together hide each other.
        full = mine.union(self._can_add(mine, self._usual[j])) if wide else mine
        ends = [self._climb(judge, start, model - mine, self._local[j])
                for start in dict.fromkeys((mine, full))]
        scores = judge.scores(ends)
        best = max(scores, key=lambda one: scores[one], default=mine)
        return frozenset(model - mine | best)

    def _climb(self, judge: JointJudge, mine: Model, rest: Model, every: Sequence[Term]) -> Model:
        """Change a law at a time as long as a joint gains."""
        least = judge.scores([mine]).get(mine, -np.inf)
        for _ in range(_STEPS):
            scores = judge.scores(self.neighbours(mine, every), least)
            # Values may prove impossible once the shared coefficients are fitted, too.
            found = next((one for one in sorted(scores, key=lambda one: -scores[one])
                          if all_possible(self.gram.coefficients(rest | one))), None)
            if found is None:
                break
            mine, least = found, scores[found]
        return mine

    def neighbours(self, mine: Model, every: Sequence[Term]) -> list[Model]:
        """Return models with one law more, less, or exchanged for another of its group."""
        near = [mine - {term} for term in mine]
        near += [mine | {term} for term in self._can_add(mine, every)]
        # Dry and viscous friction together: each alone is bent to stand in for both.
        rest = frozenset(term for term in mine if group_of(term)[0] not in _PAIR)
        viscous = [term for term in every if term.effect == 'viscous_friction']
        near += [rest | {dry, other} for dry in every if dry.effect == 'coulomb_friction'
                 for other in viscous]
        return near + [mine - {term} | {other} for term in mine for other in every
                       if other != term and group_of(other) == group_of(term)]

    def _pruned(self, model: Model) -> Model:
        """Drop laws as long as a model gains by that."""
        fewer: Model | None = model
        while fewer is not None:
            model, score = fewer, self.score(fewer)
            likely = {model - {term}: self._zero.score(self.as_scored(model - {term}, found))
                      for term, found in without_each(self.gram, model).items()}
            fewer = next((one for one in sorted(likely, key=lambda one: -likely[one])
                          if likely[one] > score and self.score(one) > score), None)
        return model

    # As of `Space`.

    def extensions(self, one: Scored) -> list[Scored]:
        """Add each law that joints share, and refine the laws of the joints beside it."""
        model: Model = one.found[0]
        if not model:
            return self._known([self._plain])
        self._progress(', '.join(map(label, sorted(model & frozenset(self._shared)))) or 'joints')
        core = frozenset(term for term in model
                         if term in self.gram.shared or group_of(term)[0] in _PLAIN)
        # Laws of several joints that lack together hide each other: from all usual ones, too.
        full = core.union(*(self._can_add(core, usual) for usual in self._usual.values()))
        gains = []
        for term in self._can_add(model, self._shared):
            starts = (model, core, full) if JOINT_EFFECTS[term.effect].place in _WIDE else (
                model, core)
            wider = [self._possible(start | {term}) for start in starts]
            worth = [self._promise(one) - self._promise(start)
                     for one, start in zip(wider, starts)]
            best = int(np.argmax(worth))  # the laws of the joints are bent to do without it
            if worth[best] > -_NEAR:
                gains.append((worth[best], wider[best]))
        gains.sort(key=lambda pair: -pair[0])
        return self._known([self._refined(start) for _, start in gains[:_TRIED]])

    def _promise(self, model: Model) -> float:
        """Return the score of a model even if its values are not possible before refinement."""
        return self._zero.score(self._fitted(model))

    def _possible(self, model: Model) -> Model:
        """Drop laws of joints whose values are not possible: another law does what they did."""
        while self.score(model) == -np.inf:
            theta = self._fitted(model).found[1].theta
            stand_in = {one for one in model - self._shared_laws
                        if not JOINT_EFFECTS[one.effect].possible(theta[one])}
            if not stand_in:
                break
            model -= stand_in
        return model

    def compositions(self, rival: Scored) -> list[Scored]:
        """Return none: what acts on the joints adds up."""
        return []

    def siblings(self, one: Scored) -> list[Scored]:
        """Return models without each law of a model, and with another in its place."""
        model: Model = one.found[0]
        near = [model - {term} for term in model]
        for k, j in enumerate(self.gram.joints):
            judge = JointJudge(self, model, k)
            mine = frozenset(judge.local)
            least = judge.scores([mine]).get(mine, -np.inf) - _NEAR
            for term in sorted(mine):
                scores = judge.scores((mine - {term} | {other} for other in self._can_add(
                    mine - {term}, self._local[j]) if other != term), least)
                likely = sorted(scores, key=lambda other: -scores[other])[:_BESIDES]
                near += [model - mine | other for other in likely]
        for term in self._shared:  # what several joints have alike may be the arm's
            alike = {one for one in model if one.place is not None and term.place is None
                     and JOINT_EFFECTS[one.effect].name == term.effect}
            near += [self._refined(model - alike | {term})] if alike else []
        for term in sorted(model & self._shared_laws):
            instead = [*self._shared, *self._local.get(term.place, ())]
            near += [model - {term} | {other}
                     for other in self._can_add(model - {term}, instead) if other != term]
        return self._known(near)

    def to_the_end(self, one: Scored) -> Scored | None:
        """Return a model: all are fitted to the end."""
        return one

    def without(self, one: Scored, names: Sequence[str]) -> Scored | None:
        """Return a model without some of its laws."""
        model: Model = one.found[0]
        return self._scored(frozenset(term for term in model if label(term) not in names))

    def _known(self, models: Iterable[Model]) -> list[Scored]:
        return [one for one in map(self._scored, models) if one is not None]


def _is_rotor(gram: Gram, term: Term) -> bool:
    """Return whether all that shows of a link is an inertia about its own joint."""
    shown = [np.einsum('bpp->p', gram.G[k])[at[term]] > 0.0
             for k, at in enumerate(gram.at) if term in at]
    return term.effect == 'link_inertia' and int(np.count_nonzero(shown)) <= 1


def label(term: Term) -> str:
    """Return a name with its place: what one law is told apart by."""
    place = 'arm' if term.place is None else term.place
    if isinstance(place, tuple):
        place = f'{place[0]}{"+" if place[2] > 0 else "-"}{place[1]}'
    return f'{term.effect}@{place}' + (f' in file {term.file}' if term.file >= 0 else '')


def family_of(term: Term) -> str:
    """Return kind of law and place, of which a model has one."""
    group, place, file = group_of(term)
    return f'{group}@{place}' + (f'#{file}' if file >= 0 else '')


def _rank(term: Term) -> tuple[int, str, float]:
    return _ORDER[term.effect], label(term), term.shape
