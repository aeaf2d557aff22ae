# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The names that a comparison supports."""

from itertools import combinations
from math import inf
from typing import Callable, Mapping, NamedTuple, Sequence

import numpy as np

from .beam import Compared
from .evidence import (
    Evidence, explained, misfits, NUISANCES, of_families, ranked_by, Scored, Share, share_of,
    taken, ZEROS)
from ..observe.shares import SLIGHT
from ...physics import EFFECTS
from ...physics.numeric import Array

_LISTED = 3  # effects in the place of one, at most


class Name(NamedTuple):
    """A name."""

    effect: str  # key of EFFECTS
    probability: float  # of its family
    alike: list[str]  # effects that may as well stand in its place, the likeliest first


class Named(NamedTuple):
    """The model whose effects are named."""

    model: Scored  # the likeliest with exactly the families that are named
    names: list[Name]  # of its effects
    # the likeliest model with another effect in the place of one, by that effect
    rivals: dict[str, Scored]


Without = Callable[[Scored, Sequence[str]], 'Scored | None']
"""Returns a model without some of its effects; None where that is not known."""


class Contribution(NamedTuple):
    """What a name takes away."""

    gain: Array  # (P,) of the misfit on each part [N^2]
    # share, beside: of the misfit of the base; the same, beside all other names
    share: Share
    beside: Share
    # before, after: the model without this name and those that follow it, and with this name;
    # laws follow zeros
    before: Scored
    after: Scored


def name(compared: Compared, seed: int, without: Without) -> Named:
    """Name the families that are likely, and worth a name; see `likely` and `Contribution`."""
    return _worth(compared, likely(compared, seed), without)


def likely(compared: Compared, seed: int) -> Named:
    """Name the families that are likely."""
    evidence, models = compared.evidence, compared.models
    weights = evidence.weights(models, seed)
    families = of_families(models, weights)
    order = ranked_by(range(len(models)), lambda k: -float(weights[k]), lambda k: models[k].rank)
    probable = _probable([models[k] for k in order], weights[order], evidence.constants.named)
    exactly = [k for k in order if models[k].named == probable]
    with_more = [k for k in order if probable <= models[k].named]
    of_them = [k for k in order if models[k].named <= probable]  # two may tie in one place
    best = next(iter([*exactly, *with_more, *of_them, models.index(evidence.base)]))
    model = models[best]
    names, rivals = list[Name](), dict[str, Scored]()
    for effect, family in zip(model.effects, model.families):
        if family not in probable:
            continue
        rest, alike = model.key - {effect}, list[str]()
        least = evidence.constants.listed * float(weights[best])
        for k in order:
            other = models[k]
            if not rest < other.key or len(other.effects) != len(model.effects):
                continue
            instead, = other.key - rest
            of_family = other.families[other.effects.index(instead)] == family
            if instead != effect and instead not in alike and (
                    weights[k] >= least or of_family and _as_ideal(evidence, model, other)):
                alike.append(instead)
                rivals.setdefault(instead, other)
        names.append(Name(effect, families[family], alike[:_LISTED]))
    return Named(model, names, rivals)


def _probable(models: Sequence[Scored], weights: Array, least: float) -> set[str]:
    """
    Return the probable families, of models in the order of their weights.

    Several may share a place, and none of them be probable where it is that something is there:
    that of the likeliest model then stands for them.
    """
    probable = {family for family, weight in of_families(models, weights).items()
                if weight >= least}
    laws = min((one.laws for one in models if one.named == probable), default=len(probable))
    more = [k for k, one in enumerate(models) if one.laws > laws and probable < one.named]
    if more[:1] == [0] and weights[more].sum() >= least:
        probable |= models[0].named
    return probable


def _as_ideal(evidence: Evidence, model: Scored, other: Scored) -> bool:
    """Return whether a law explains as much as another, if neither is exact."""
    if evidence.is_exact(model):
        return False
    lacks = explained(evidence, model).share - explained(evidence, other).share
    return lacks <= 2.0 * evidence.constants.ideal  # both idealise


def _worth(compared: Compared, named: Named, without: Without) -> Named:
    """
    Drop names of which the share is too little, or not above 0 with 95 % over the parts.

    What is little of a law is told by what the zeros leave: where that is within the discrepancy
    of every force sensor, none is named but exact ones and those of a robot, which the motion
    tells. What every rig has is worth a name if it is more than that, and stays in the model of a
    law in any case: without it the law would bend to make up for it.
    """
    evidence = compared.evidence
    c = evidence.constants
    exact = evidence.is_exact(named.model)
    least = c.worth_exact if exact else c.worth
    usual = 0.0 if exact else evidence.usual
    told = parts(compared, named, without)
    of_zeros = sum(part.share.share for effect, part in told.items() if effect in ZEROS)
    of_laws = 1.0 - min(max(of_zeros, 0.0), 1.0)
    told_by_force = float(misfits(evidence, evidence.base, None).sum()) * of_laws >= usual
    little = [effect for effect, part in told.items()
              if part.share.share < least * (1.0 if effect in ZEROS else of_laws)
              or (part.gain.sum() < usual if effect in NUISANCES
                  else not told_by_force and EFFECTS[effect].port != 'robot')
              or _may_be_none(part.share) and _may_be_none(part.beside)]
    fewer = _dropped(compared, named, little, without, NUISANCES) if little else None
    if fewer is not None:
        return _worth(compared, fewer, without)
    listed = {one for each in named.names for one in each.alike}
    return named._replace(rivals={one: named.rivals[one] for one in named.rivals if one in listed})


def _may_be_none(share: Share) -> bool:
    """Return whether a share may be 0: its 95 % interval holds 0, and a part is harmed."""
    return -inf < share.interval[0] <= 0.0 and bool(share.parts.min() < -SLIGHT)


def without_least(compared: Compared, named: Named, without: Without) -> Named:
    """Drop the name that takes away least."""
    told = parts(compared, named, without)
    least = ranked_by(told, lambda effect: told[effect].share.share)[:1]
    fewer = _dropped(compared, named, least, without) if len(told) > 1 else None
    return fewer or Named(compared.evidence.base, [], {})


def _dropped(
    compared: Compared, named: Named, effects: Sequence[str], without: Without,
    stays: Sequence[str] = (),
) -> Named | None:
    """Drop names, and from the model what does not stay; None where that is not known."""
    kept = [one for one in named.names if one.effect not in effects]
    gone = [effect for effect in effects if effect not in stays]
    if not any(one.effect not in NUISANCES for one in kept):  # nothing is left that needs them
        gone = sorted(_own(named.model) - {one.effect for one in kept})
    model = _known(compared, named.model, gone, without)
    return None if model is None else named._replace(model=model, names=kept)


def parts(compared: Compared, named: Named, without: Without) -> dict[str, Contribution]:
    """
    Divide what is explained among the names: first among zeros, and the rest among laws.

    Each gets the mean of what it takes away beside every number of others (the value of L. S.
    Shapley, A value for n-person games, 1953), which need not be used: two that help only together
    share alike. What is little so is what it is beside all others. Nuisances that are not named
    count with the laws, which need them.
    """
    evidence, names = compared.evidence, [one.effect for one in named.names]
    unnamed = sorted(_own(named.model) & {*NUISANCES} - {*names})

    def with_only(kept: Sequence[str]) -> Scored | None:
        dropped = [one for one in names if one not in kept]
        return _known(compared, named.model, [*dropped, *(() if kept else unnamed)], without)

    found, kept, floor = dict[str, Contribution](), list[str](), evidence.base
    for group in ([one for one in names if one in ZEROS],
                  [one for one in names if one not in ZEROS]):
        models, best = dict[frozenset[str], Scored](), dict[frozenset[str], Scored]()
        for some in (frozenset(each) for size in range(len(group) + 1)
                     for each in combinations(group, size)):
            model = with_only([*kept, *some])
            if model is None:
                return {}
            models[some] = model
            best[some] = _better(evidence, model, floor, *(best[some - {one}] for one in some))
        for one in group:
            rest = with_only([other for other in names if other != one])
            if rest is None:
                return {}
            rest = _better(evidence, rest, best[frozenset(group) - {one}])
            gain, last = _value(evidence, best, one), taken(evidence, rest, named.model)
            if share_of(evidence, gain).share < evidence.constants.worth:
                gain = max(gain, last, key=np.sum)
            found[one] = Contribution(
                gain, share_of(evidence, gain), share_of(evidence, last),
                models[frozenset(group) - {one}], models[frozenset(group)])
        kept, floor = kept + group, best[frozenset(group)]
    return found


def _better(evidence: Evidence, *models: Scored) -> Scored:
    """Return the model that explains most: a fit with fewer effects may predict better."""
    return max(models, key=lambda one: explained(evidence, one).share)


def _value(evidence: Evidence, best: Mapping[frozenset[str], Scored], one: str) -> Array:
    """Return the Shapley value (P,) of a name, from the best model within each set of names."""
    by_size = dict[int, list[Array]]()
    for some in best:
        if one not in some:
            by_size.setdefault(len(some), []).append(
                taken(evidence, best[some], best[some | {one}]))
    return np.asarray(np.mean([np.mean(gains, axis=0) for gains in by_size.values()], axis=0))


def _own(model: Scored) -> set[str]:
    """Return the effects of a model that the nominal one has not."""
    return {effect for effect, family in zip(model.effects, model.families) if family}


def _known(
    compared: Compared, model: Scored, dropped: Sequence[str], without: Without
) -> Scored | None:
    """Return a model without some of its effects, from those compared if it is among them."""
    key = model.key - set(dropped)
    known = next((one for one in compared.models if one.key == key), None)
    if known is None:
        known = without(model, dropped)
        if known is not None:
            compared.models.append(known)
    return known
