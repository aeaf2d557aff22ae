# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The names that a comparison supports."""

from __future__ import annotations

from math import inf
from typing import Callable, NamedTuple, Sequence

from .beam import Compared
from .evidence import Evidence, explained, of_families, ranked_by, Scored, Share, share_of, ZEROS

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


class Part(NamedTuple):
    """What a name takes away."""

    share: Share  # of the misfit of the base
    # before, after: the model without this name and those that follow it, and with this name
    before: Scored
    after: Scored


def name(compared: Compared, seed: int, without: Without) -> Named:
    """Name the families that are likely, and worth a name; see `likely` and `Part`."""
    return _worth(compared, likely(compared, seed), without)


def likely(compared: Compared, seed: int) -> Named:
    """Name the families that are likely."""
    evidence, models = compared.evidence, compared.models
    weights = evidence.weights(models, seed)
    families = of_families(models, weights)
    probable = {family for family, weight in families.items()
                if weight >= evidence.constants.named}
    order = ranked_by(
        range(len(models)), lambda k: -float(weights[k]), lambda k: models[k].rank)
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


def _as_ideal(evidence: Evidence, model: Scored, other: Scored) -> bool:
    """Return whether a law explains as much as another, if neither is exact."""
    if evidence.is_exact(model):
        return False
    lacks = explained(evidence, model).share - explained(evidence, other).share
    return lacks <= 2.0 * evidence.constants.ideal  # both idealise


def _worth(compared: Compared, named: Named, without: Without) -> Named:
    """
    Drop names of which the share is too little, or not above 0 with 95 % over the parts.

    What is little of a law is told by what the zeros leave. Those stay in the model of a law, as
    every rig has some: without them the law would bend to make up for them.
    """
    evidence = compared.evidence
    c = evidence.constants
    least = c.worth_exact if evidence.is_exact(named.model) else c.worth
    told = parts(compared, named, without)
    of_zeros = sum(part.share.share for effect, part in told.items() if effect in ZEROS)
    of_laws = 1.0 - min(max(of_zeros, 0.0), 1.0)
    little = [effect for effect, (share, *_) in told.items()
              if share.share < least * (1.0 if effect in ZEROS else of_laws)
              or _may_be_none(share) and _may_be_none(
                  _beside(compared, named, effect, without) or share)]
    fewer = _dropped(compared, named, little, without, ZEROS) if little else None
    if fewer is not None:
        return _worth(compared, fewer, without)
    listed = {one for each in named.names for one in each.alike}
    return named._replace(rivals={one: named.rivals[one] for one in named.rivals if one in listed})


def _may_be_none(share: Share) -> bool:
    """Return whether a share may be 0: its 95 % interval holds 0, and not every part gains."""
    return -inf < share.interval[0] <= 0.0 and bool(share.parts.min() < 0.0)


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
    if not any(one.effect not in ZEROS for one in kept):  # nothing is left that needs them
        gone = sorted(_own(named.model) - {one.effect for one in kept})
    model = _known(compared, named.model, gone, without)
    return None if model is None else named._replace(model=model, names=kept)


def parts(compared: Compared, named: Named, without: Without) -> dict[str, Part]:
    """
    Divide what is explained among the names: zeros first, then the law that takes away most.

    Zeros that are not named count with the first law, which needs them.
    """
    left, found = [one.effect for one in named.names], dict[str, Part]()
    zeros = sorted(_own(named.model) & {*ZEROS} - {*left})
    present = _known(compared, named.model, [*left, *zeros], without)
    while left and present is not None:
        shares = dict[str, tuple[Share, Scored]]()
        for one in [one for one in left if one in ZEROS] or left:
            after = _known(
                compared, named.model, [other for other in left if other != one], without)
            if after is None:
                return {}
            shares[one] = share_of(compared.evidence, present, after), after
        first = ranked_by(shares, lambda one: -shares[one][0].share)[0]
        found[first] = Part(shares[first][0], present, shares[first][1])
        present = shares[first][1]
        left.remove(first)
    for effect, part in found.items():
        last = _beside(compared, named, effect, without)
        if last is not None and part.share.share < compared.evidence.constants.worth:
            found[effect] = max(part, part._replace(share=last), key=lambda one: one.share.share)
    return found


def _own(model: Scored) -> set[str]:
    """Return the effects of a model that the nominal one has not."""
    return {effect for effect, family in zip(model.effects, model.families) if family}


def _beside(compared: Compared, named: Named, effect: str, without: Without) -> Share | None:
    """Return the share of a name beside all others: it may help beside them alone."""
    rest = _known(compared, named.model, [effect], without)
    return None if rest is None else share_of(compared.evidence, rest, named.model)


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
