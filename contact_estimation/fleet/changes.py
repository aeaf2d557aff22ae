# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Changes over time: from which recording on an effect is named, or no longer named."""

from __future__ import annotations

from typing import Any, NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.special import xlogy
from scipy.stats import fisher_exact

from .entry import distinct, Entry
from .trends import by_group

_DRAWS = 4000  # permutations
_LEVEL = 0.05
_LEAST = 8  # recordings
_NEAR = 1.92  # half the 95 % point of chi-square with one degree of freedom


class Change(NamedTuple):
    """A change of how often a family is named in a group."""

    # group, family: of the effects
    group: str
    family: str
    entry: Entry  # the first recording after the change
    number: int  # of that recording in its group, from 1
    # earliest, latest: 95 % interval of `number`, by the likelihood ratio
    earliest: int
    latest: int
    # before, after: recordings with the name, and all recordings, on each side of the change
    before: tuple[int, int]
    after: tuple[int, int]
    # probability of a change as clear in any group and family, if the order of the recordings says
    # nothing: permutation test of the largest likelihood ratio, corrected by Holm's method for the
    # number of groups and families
    chance: float


def changes(entries: Sequence[Entry], seed: int = 0) -> list[Change]:
    """Find the changes of what is named."""
    candidates = []
    for group, members in by_group(entries).items():
        known = [entry for entry in distinct(members) if entry.report is not None]
        families = sorted({family for entry in known for family in entry.families})
        for family in families if len(known) >= _LEAST else ():
            named = np.array([family in entry.families for entry in known])
            if not named.all():
                candidates.append((group, family, known, members, named))
    rng = np.random.default_rng(seed)
    chances = holm([_chance(named, rng) for *_, named in candidates])
    found = [_change(*candidate, chance)
             for candidate, chance in zip(candidates, chances) if chance < _LEVEL]
    return sorted(found, key=lambda one: one.chance)


def holm(chances: Sequence[float]) -> list[float]:
    """Correct p-values for their number (Holm 1979)."""
    order = np.argsort(chances)
    factors = len(chances) - np.arange(len(chances))
    raised = np.minimum(1.0, np.maximum.accumulate(np.asarray(chances)[order] * factors))
    corrected = np.empty(len(chances))
    corrected[order] = raised
    return [float(value) for value in corrected]


def _change(
    group: str, family: str, known: list[Entry], members: list[Entry],
    named: NDArray[np.bool_], chance: float,
) -> Change:
    gain = _gains(named[None])[0]
    best = int(np.argmax(gain)) + 1
    near = np.flatnonzero(gain >= gain.max() - _NEAR) + 1
    first, before_earliest, latest = (
        members.index(known[int(index)]) + 1 for index in (best, near[0] - 1, near[-1]))
    earliest = before_earliest + 1  # a recording without a diagnosis may be the first
    return Change(group, family, known[best], first, earliest, latest,
                  (int(named[:best].sum()), best),
                  (int(named[best:].sum()), len(named) - best), chance)


def _chance(named: NDArray[np.bool_], rng: np.random.Generator) -> float:
    """
    Return the probability that a random order shows a change as clear.

    By permutations; where none does, by Fisher's exact test times the number of places, a bound
    that may be far smaller than one over the number of permutations.
    """
    gain = _gains(named[None])[0]
    drawn = rng.permuted(np.tile(named, (_DRAWS, 1)), axis=1)
    as_clear = int(np.sum(_gains(drawn).max(axis=1) >= gain.max() - 1e-9))
    chance = (1 + as_clear) / (1 + _DRAWS)
    if as_clear:
        return chance
    best = int(np.argmax(gain)) + 1
    counts = [[int(side.sum()), int((~side).sum())] for side in (named[:best], named[best:])]
    return min(chance, len(gain) * float(fisher_exact(counts)[1]))


def _gains(named: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Return the log-likelihood that a change before each recording but the first gains."""
    count = named.shape[1]
    n = np.arange(1, count)
    before = np.cumsum(named, axis=1)[:, :-1]
    total = named.sum(axis=1, keepdims=True)
    return np.asarray(_log_likelihood(before, n) + _log_likelihood(total - before, count - n)
                      - _log_likelihood(total, count))


def _log_likelihood(hits: NDArray[Any], n: NDArray[Any] | int) -> NDArray[np.float64]:
    """Return that of the most likely rate."""
    rate = hits / n
    return np.asarray(xlogy(hits, rate) + xlogy(n - hits, 1.0 - rate))
