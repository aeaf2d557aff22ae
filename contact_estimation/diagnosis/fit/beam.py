# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The search for models: a beam from the nominal model outwards."""

from dataclasses import replace
from typing import Any, Callable, Mapping, NamedTuple, Protocol, Sequence

import numpy as np

from .constants import Constants
from .evidence import Evidence, ranked_by, Scored

_WIDE, _DEEP = 3, 4  # models that are extended at a time, and how often
LAWS = 3  # of a model of one contact
# Extensions that are fitted to the end, since a law may prove exact only there; beside a law
# those so many nats below the best at most.
_REFINED, _FAR = 2, 10.0
_NEAR = 3.0  # nats below the best: a twentieth of its weight
_MOST = 60  # models in a file: the others weigh nothing


class Space(Protocol):
    """The models that are compared."""

    def evidence(self) -> Evidence:
        """Return what models are compared against, with the recalibrated nominal model."""

    def extensions(self, one: Scored) -> list[Scored]:
        """Return the most promising models with one more effect."""

    def compositions(self, rival: Scored) -> list[Scored]:
        """Return pairs of laws of which one acts on the other that fit better than a model."""

    def siblings(self, one: Scored) -> list[Scored]:
        """Return models without each effect, and with another law in the place of each law."""

    def to_the_end(self, one: Scored) -> Scored | None:
        """Fit a model to the end; None if its values are not possible."""


class Compared(NamedTuple):
    """The models of a search."""

    evidence: Evidence  # what they are compared against
    models: list[Scored]  # the best first

    @property
    def score(self) -> float:
        """Return the score of the best model."""
        return self.evidence.score(self.models[0])


def search(
    space: Space, progress: Callable[[str], None], known: Compared | None = None, laws: int = LAWS
) -> Compared:
    """Extend the best models as long as the gain that is left could pay for a further law."""
    evidence, models = known or refit(space, [])
    pool = {one.key: one for one in models}
    done, wide, composed = set[frozenset[str]](), 1 if known else _WIDE, False
    for _ in range(2 * _DEEP):
        ranked = evidence.ranked(pool.values())
        frontier = [one for one in ranked[:wide] if one.key not in done and one.laws < laws
                    and (not done or _may_matter(evidence, one, ranked[0]))]
        if not frontier and not composed and _may_matter(evidence, ranked[0], ranked[0]):
            # Neither of such a pair need be worth anything alone.
            composed = True
            for one in space.compositions(ranked[0]):
                _keep(evidence, pool, one)
        elif not frontier:
            break
        for one in frontier:
            progress(', '.join(one.effects) or 'nominal model')
            done.add(one.key)
            extended = evidence.ranked(space.extensions(one))
            for rough in extended:
                _keep(evidence, pool, rough)
            best = evidence.score(evidence.ranked(pool.values())[0])
            for rough in extended[:_REFINED]:
                if not one.laws or evidence.score(rough) > best - _FAR:
                    _keep(evidence, pool, space.to_the_end(rough))
        evidence = evidence.informed_by(pool.values())
    first = evidence.ranked(pool.values())[0]
    lawful = [one for one in pool.values() if one.laws]
    if lawful and not first.laws and not evidence.is_exact(first):
        # An inexact law may not be worth its prior where an exact one beside it is.
        first = ranked_by(lawful, lambda one: -evidence.log_likelihoods(one)[0].sum(),
                          lambda one: -evidence.score(one))[0]
    for _ in range(_DEEP):
        for sibling in space.siblings(first):
            _keep(evidence, pool, sibling)
        before, first = first, evidence.ranked(pool.values())[0]
        if first.key in (before.key, evidence.base.key):
            break
    return Compared(evidence, evidence.ranked(pool.values()))


def refit(space: Space, models: Sequence[Scored]) -> Compared:
    """Fit models of another space again, beside the nominal model of this one."""
    evidence = space.evidence()
    pool = {evidence.base.key: evidence.base}
    for one in models:
        if one.key != evidence.base.key:
            _keep(evidence, pool, space.to_the_end(one))
    evidence = evidence.informed_by(pool.values())
    return Compared(evidence, evidence.ranked(pool.values()))


def _keep(evidence: Evidence, pool: dict[frozenset[str], Scored], one: Scored | None) -> None:
    """Keep a model that is possible unless a better fit of the same effects is known."""
    if one is None:
        return
    key = one.key
    if key not in pool or evidence.score(one) > evidence.score(pool[key]):
        pool[key] = one


def _may_matter(evidence: Evidence, one: Scored, best: Scored) -> bool:
    """Return whether a law that explained all that is left would pay, and come near the best."""
    perfect = replace(one, left_out=np.minimum(one.left_out, 1.0), as_exact=None, white=True,
                      fitted=np.minimum(one.fitted, 1.0), penalty=0.0)
    c = evidence.constants
    least = float(evidence.log_likelihoods(perfect)[1].sum()) + evidence.log_prior(perfect)
    return least - c.parameter - c.law > max(evidence.score(one), evidence.score(best) - _NEAR)


def as_dict(compared: Compared) -> dict[str, Any]:
    """Return the errors of all likely models on parts left out, ready for JSON."""
    evidence, likely = compared.evidence, compared.models[:_MOST]
    return {
        'instrument': evidence.instrument.tolist(), 'as_force': evidence.as_force.tolist(),
        'white': evidence.white,
        'base': _scored(evidence.base),
        'models': [_scored(one) for one in likely if one is not evidence.base],
    }


def _scored(one: Scored) -> dict[str, Any]:
    return {
        'effects': list(one.effects), 'families': list(one.families), 'rank': one.rank,
        'left_out': one.left_out.tolist(), 'fitted': one.fitted.tolist(),
        'counts': one.counts.tolist(), 'parameters': one.parameters, 'laws': one.laws,
        'curves': one.curves,
        'as_exact': None if one.as_exact is None else one.as_exact.tolist(), 'white': one.white,
    }


def of_dict(data: Mapping[str, Any], constants: Constants) -> Compared:
    """Return compared models, as they are with certain constants."""
    base, *others = (
        Scored(tuple(one['effects']), tuple(one['families']), tuple(one['rank']),
               np.array(one['left_out']), np.array(one['fitted']), np.array(one['counts']),
               one['parameters'], one['laws'], one['curves'], white=one['white'], as_exact=(
                   None if one['as_exact'] is None else np.array(one['as_exact'])))
        for one in (data['base'], *data['models']))
    evidence = Evidence(base, np.array(data['instrument']), np.array(data['as_force']), constants,
                        white=data['white'])
    evidence = evidence.informed_by([base, *others])
    return Compared(evidence, evidence.ranked([base, *others]))
