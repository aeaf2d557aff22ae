# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
The order of candidates: by score, and where scores are equal, by a prior order of the effects.

On some motions two laws are the same force, as a bias and an offset of an attached spring are.
Rounding alone, which differs between processors, would then decide which of them is named.
"""

from __future__ import annotations

from typing import Any, Callable, Iterable, Protocol, TypeVar

from ..observe.model import names_of
from ...physics import EFFECTS

ZEROS = ('force_bias', 'contact_offset')
"""Constants of sensor and surface that every rig has to some extent."""

TIE = 1e-6
"""
Relative difference up to which scores are equal, and absolute one of scores below 1.

A search ends at this relative gain, and sums of squares in variances of the noise that differ by
less than 1 are equally likely for any data.
"""

_BY_PRIOR = (*ZEROS, *(name for name in EFFECTS if name not in ZEROS))


class Named(Protocol):
    """What adds one effect to a model."""

    @property
    def name(self) -> str:
        """Return the name of that effect."""


Item = TypeVar('Item')
Law = TypeVar('Law', bound=Named)


def prior(name: str) -> tuple[int, int]:
    """Return the rank of an effect where the data cannot tell it from another."""
    return (len(names_of(name)), _BY_PRIOR.index(name)) if name else (0, 0)


def ranked(laws: Iterable[Law], score: Callable[[Law], float]) -> list[Law]:
    """Sort candidates by score, those with equal scores by their prior order."""
    return ranked_by(laws, score, lambda law: prior(law.name))


def ranked_by(
    items: Iterable[Item], score: Callable[[Item], float],
    first: Callable[[Item], Any] = lambda item: 0,
) -> list[Item]:
    """Sort by score, equal scores by what goes first, else in the order given."""
    given = list(items)
    scores = [score(item) for item in given]
    groups = list[list[int]]()
    for k in sorted(range(len(given)), key=lambda k: scores[k]):
        if groups and is_tie(scores[k], scores[groups[-1][0]]):
            groups[-1].append(k)
        else:
            groups.append([k])
    for group in groups:
        group.sort(key=lambda k: (first(given[k]), k))
    return [given[k] for group in groups for k in group]


def is_tie(score: float, other: float) -> bool:
    """Return whether two scores differ by no more than rounding and the end of a search."""
    return score == other or abs(score - other) <= TIE * max(1.0, abs(other))
