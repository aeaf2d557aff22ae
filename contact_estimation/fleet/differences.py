# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Robots that differ from the rest: tests of every pair of groups."""

from __future__ import annotations

from itertools import combinations
from typing import Callable, NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.stats import fisher_exact, mannwhitneyu

from .changes import holm
from .entry import distinct, Entry
from .trends import by_group, is_resolved, QUANTITIES

_LEVEL = 0.05
_LEAST = 4  # recordings of a group: the least with which a pair can differ at all

Members = dict[str, list[Entry]]


class Difference(NamedTuple):
    """A group that differs from most others."""

    group: str  # which
    what: str  # 'stiffness', 'damping', or the family of effects
    # own, others: median of the quantity, or share of the recordings in which the family is named
    own: float
    others: float
    # differs_from, tested: number of other groups that it differs from, and that it was compared
    # with
    differs_from: int
    tested: int
    chance: float  # largest corrected p-value of the pairs that differ

    @property
    def is_quantity(self) -> bool:
        """Whether `own` and `others` are medians, not shares of recordings."""
        return self.what in QUANTITIES


class _Pair(NamedTuple):
    what: str
    groups: tuple[str, str]
    chance: float


def differences(entries: Sequence[Entry]) -> list[Difference]:
    """
    Find the groups that differ from more than half of the other groups.

    Each pair of groups is tested for K_e and B_e (Mann-Whitney) and for each family of effects
    (Fisher's exact test); all tests together are corrected by Holm's method. Medians that single
    recordings do not resolve do not differ.
    """
    groups = {group: known for group, members in by_group(entries).items()
              if len(known := [one for one in distinct(members) if one.report]) >= _LEAST}
    families = sorted({family for members in groups.values()
                       for entry in members for family in entry.families})
    pairs = [pair for first, second in combinations(groups, 2)
             for pair in _pairs(groups, first, second, families)]
    corrected = holm([pair.chance for pair in pairs])
    pairs = [pair._replace(chance=chance) for pair, chance in zip(pairs, corrected)]
    found = [_difference(groups, group, what, pairs)
             for group in groups for what in (*QUANTITIES, *families)]
    return sorted((one for one in found if one is not None), key=lambda one: one.chance)


def _pairs(groups: Members, first: str, second: str, families: Sequence[str]) -> list[_Pair]:
    a, b = groups[first], groups[second]
    pairs = []
    for quantity in QUANTITIES:
        values = [_values(members, quantity) for members in (a, b)]
        if min(map(len, values)) >= _LEAST:
            between = float(np.median(values[0]) - np.median(values[1]))
            resolved = is_resolved(between, _stds([*a, *b], quantity))
            chance = float(mannwhitneyu(*values).pvalue) if resolved else 1.0
            pairs.append(_Pair(quantity, (first, second), chance))
    for family in families:
        counts = [[hits, len(members) - hits] for members in (a, b)
                  for hits in (_named(members, family),)]
        pairs.append(_Pair(family, (first, second), float(fisher_exact(counts)[1])))
    return pairs


def _difference(
    groups: Members, group: str, what: str, pairs: Sequence[_Pair]
) -> Difference | None:
    own = [pair for pair in pairs if pair.what == what and group in pair.groups]
    differing = [pair for pair in own if pair.chance < _LEVEL]
    if not differing or 2 * len(differing) <= len(own):
        return None
    rest = [entry for name, members in groups.items() if name != group for entry in members]
    measure: Callable[[list[Entry]], float] = (
        (lambda members: float(np.median(_values(members, what)))) if what in QUANTITIES
        else (lambda members: _named(members, what) / len(members)))
    return Difference(group, what, measure(groups[group]), measure(rest), len(differing),
                      len(own), max(pair.chance for pair in differing))


def _values(members: Sequence[Entry], quantity: str) -> list[float]:
    return [value[0] for entry in members if (value := entry.corrected(quantity)) is not None]


def _stds(members: Sequence[Entry], quantity: str) -> NDArray[np.float64]:
    return np.array([value[1] for entry in members
                     if (value := entry.corrected(quantity)) is not None])


def _named(members: Sequence[Entry], family: str) -> int:
    return sum(family in entry.families for entry in members)
