# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Trends of K_e and B_e, changes of named effects over time, robots that differ."""

from itertools import combinations
from typing import Any, Callable, NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.special import xlogy
from scipy.stats import fisher_exact, mannwhitneyu, theilslopes

from .table import distinct, Entry
from ..physics.numeric import Array

QUANTITIES = {'stiffness': ('K_e', 'N/m'), 'damping': ('B_e', 'N s/m')}
_LEAST_POINTS = 6  # recordings: fewer have no 95 % interval of Sen's kind worth the name
_CONFIDENCE = 0.95
_RESOLVED = 2.0  # standard deviations of one recording: less may be the model's own error
_DAY_NS = 86_400e9


class Trend(NamedTuple):
    """The trend of a quantity in a group."""

    # group, quantity: the latter a key of `QUANTITIES`
    group: str
    quantity: str
    numbers: NDArray[np.int64]  # (N,) recording in the group, from 1
    # values, stds (N,): of the corrected models
    values: Array
    stds: Array
    slope: float  # median slope per recording (Theil-Sen); NaN with too few recordings
    # low, high: its 95 % interval (Sen 1968)
    low: float
    high: float
    intercept: float  # of the line, at number 0
    per_day: float  # median slope per day; NaN where the stamps do not tell days
    # whether the interval at a level corrected for the number of trends (Bonferroni) excludes 0,
    # and the change over all recordings is resolved
    significant: bool

    @property
    def first(self) -> float:
        """Value of the line at the first recording."""
        return self.intercept + self.slope * float(self.numbers[0])

    @property
    def in_days(self) -> bool:
        """Whether the stamps tell days."""
        return bool(np.isfinite(self.per_day))

    def percent(self, slope: float) -> float:
        """Convert a slope."""
        return 100.0 * slope / abs(self.first)


def trends(entries: Sequence[Entry]) -> list[Trend]:
    """Fit the trends of all groups."""
    groups = by_group(entries)
    count = len(groups) * len(QUANTITIES)
    found = [_trend(group, quantity, members, count)
             for group, members in groups.items() for quantity in QUANTITIES]
    return [trend for trend in found if trend is not None]


def is_resolved(change: float, stds: Array) -> bool:
    """Return whether a change is more than what single recordings leave open."""
    return abs(change) > _RESOLVED * float(np.median(stds))


def by_group(entries: Sequence[Entry]) -> dict[str, list[Entry]]:
    """Sort recordings into their groups."""
    return {group: [entry for entry in entries if entry.group == group]
            for group in sorted({entry.group for entry in entries})}


def _trend(group: str, quantity: str, members: Sequence[Entry], count: int) -> Trend | None:
    used = {id(entry) for entry in distinct(members)}
    known = [(number, entry.outcome['start_ns'], *value)
             for number, entry in enumerate(members, 1)
             if id(entry) in used and (value := entry.corrected(quantity)) is not None]
    if not known:
        return None
    numbers, starts, values, stds = (np.array(column) for column in zip(*known))
    slope = low = high = intercept = per_day = np.nan
    significant = False
    if len(known) >= _LEAST_POINTS:
        slope, intercept, low, high = theilslopes(values, numbers, _CONFIDENCE)
        _, _, *corrected = theilslopes(values, numbers, 1.0 - (1.0 - _CONFIDENCE) / count)
        change = abs(slope) * (numbers[-1] - numbers[0])
        significant = bool((corrected[0] > 0.0 or corrected[1] < 0.0)
                           and is_resolved(change, stds))
        if len(set(starts.tolist())) == len(starts):
            per_day = theilslopes(values, (starts - starts[0]) / _DAY_NS)[0]
    return Trend(group, quantity, numbers, values, stds, float(slope), float(low), float(high),
                 float(intercept), float(per_day), significant)


_DRAWS = 4000  # permutations
_LEVEL = 0.05
_LEAST_RECORDINGS = 8  # recordings
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

    @property
    def rises(self) -> bool:
        """Whether the family is named more often after the change."""
        return self.before[0] * self.after[1] < self.after[0] * self.before[1]


def changes(entries: Sequence[Entry], seed: int = 0) -> list[Change]:
    """Find the changes of what is named."""
    candidates = []
    for group, members in by_group(entries).items():
        known = [entry for entry in distinct(members) if entry.report is not None]
        families = sorted({family for entry in known for family in entry.families})
        for family in families if len(known) >= _LEAST_RECORDINGS else ():
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
    """Return the probability that a random order shows a change as clear."""
    # By permutations; where none does, by Fisher's exact test times the number of places, a bound
    # that may be far smaller than one over the number of permutations.
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


_LEAST_OF_GROUP = 4  # recordings of a group: the least with which a pair can differ at all

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
    """Find the groups that differ from more than half of the other groups."""
    # Each pair of groups is tested for K_e and B_e (Mann-Whitney) and for each family of effects
    # (Fisher's exact test); all tests together are corrected by Holm's method. Medians that single
    # recordings do not resolve do not differ.
    groups = {group: known for group, members in by_group(entries).items()
              if len(known := [one for one in distinct(members) if one.report]) >= _LEAST_OF_GROUP}
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
        (own, own_std), (other, other_std) = (_values(members, quantity) for members in (a, b))
        if min(len(own), len(other)) >= _LEAST_OF_GROUP:
            between = float(np.median(own) - np.median(other))
            resolved = is_resolved(between, np.append(own_std, other_std))
            chance = float(mannwhitneyu(own, other).pvalue) if resolved else 1.0
            pairs.append(_Pair(quantity, (first, second), chance))
    for family in families:
        counts = [[hits := _named(members, family), len(members) - hits] for members in (a, b)]
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
        (lambda members: float(np.median(_values(members, what)[0]))) if what in QUANTITIES
        else (lambda members: _named(members, what) / len(members)))
    return Difference(group, what, measure(groups[group]), measure(rest), len(differing),
                      len(own), max(pair.chance for pair in differing))


def _values(members: Sequence[Entry], quantity: str) -> NDArray[np.float64]:
    """Return values and their standard deviations, shape (2, N)."""
    return np.array([value for entry in members
                     if (value := entry.corrected(quantity)) is not None]).reshape(-1, 2).T


def _named(members: Sequence[Entry], family: str) -> int:
    return sum(family in entry.families for entry in members)
