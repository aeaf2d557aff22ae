# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
The evidence for models: how well each predicts parts that it was not fitted on.

Residuals of a part are white noise of known size, n samples, plus a discrepancy of unknown size
that is slow, so that it has k degrees of freedom at most (M. C. Kennedy and A. O'Hagan, Bayesian
calibration of computer models, J. R. Stat. Soc. B 63, 2001). Noise has only k / n of its energy
there. With the scale-invariant prior 1 / s of the size s of the discrepancy, residuals of mean
square m, in that of noise, have the marginal likelihood

    (1 + n d / k)^(-k/2),    d = max(m - 1, 0) + d_0,

where no discrepancy is believed to be smaller than d_0. Laws that are exact leave noise alone,
of which the likelihood is exp(-n (m - 1) / 2), and which is white. That of a model is the sum of
both.

On some motions two laws are the same force, as a bias and an offset of an attached spring are.
Rounding alone, which differs between processors, would then decide which of them is named: where
scores are equal, a prior order of the effects decides.
"""

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Callable, Iterable, Mapping, NamedTuple, Protocol, Sequence, TypeVar

import numpy as np

from .constants import CONSTANTS, Constants
from ..observe.model import names_of
from ..observe.shares import SLIGHT
from ...physics import EFFECTS
from ...physics.numeric import Array

ZEROS = ('force_bias', 'contact_offset')
"""Constants of sensor and surface that every rig has to some extent."""

NUISANCES = (*ZEROS, 'robot_friction')
"""What every rig has to some extent."""

DRAWS = 400
"""Of bootstraps and permutations: probabilities to two and a half per cent at worst."""

TIE = 1e-6
"""
Relative difference up to which scores are equal, and absolute one of scores below 1.

A search ends at this relative gain, and sums of squares in variances of the noise that differ by
less than 1 are equally likely for any data.
"""

NOISE_IS_KNOWN = 1.2
"""Factor by which noise may be larger than measured."""

_BY_PRIOR = (*ZEROS, *(name for name in EFFECTS if name not in ZEROS))


class HasName(Protocol):
    """What adds one effect to a model."""

    @property
    def name(self) -> str:
        """Return the name of that effect."""


Item = TypeVar('Item')
Law = TypeVar('Law', bound=HasName)


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


_TWO_SIDED = 1.96  # standard deviations of a 95 % interval
_ALL_IN_ONE = 1e-3  # share of the misfit in all parts but one: a jackknife tells nothing
_OUTWEIGHS = 2.0  # times the median misfit of the parts, beyond which a part counts no more


@dataclass(frozen=True, eq=False)
class Scored:
    """A fitted model, and its errors on P parts in C channels."""

    effects: tuple[str, ...]  # its effects in the order in which they were found
    # the family of each; '' for those of the nominal model, which are no names
    families: tuple[str, ...]
    rank: tuple[Any, ...]  # where it comes among models of equal score
    # left_out, fitted (P, C): mean squares of the errors on each part, as predicted by the fit on
    # the others and as fitted, in those of noise
    left_out: Array
    fitted: Array
    counts: Array  # (P, C) number of residuals
    # parameters, laws, curves: number of free values beyond those of the nominal model (those that
    # data determine, where some are known beforehand); laws other than zeros; curves among them
    parameters: float
    laws: int
    curves: int
    found: Any = field(repr=False, default=None)  # the fit
    # further log prior odds against it: its place among many, values of a calibration [nat]
    penalty: float = 0.0
    white: bool = True  # whether what the force leaves is mostly white, as an exact law's is
    # (2, P, C) left_out and fitted of an exact law, of which large errors are outliers; by default
    # the same
    as_exact: Array | None = None

    @property
    def key(self) -> frozenset[str]:
        """Return its effects in no order."""
        return frozenset(self.effects)

    @property
    def named(self) -> frozenset[str]:
        """Return the families of its names."""
        return frozenset(self.families) - {''}

    def errors(self, exact: bool) -> tuple[Array, Array]:
        """Return left_out and fitted of an inexact law, or of an exact one."""
        if exact and self.as_exact is not None:
            return self.as_exact[0], self.as_exact[1]
        return self.left_out, self.fitted

    def expected(self, constants: Constants = CONSTANTS, exact: bool = False) -> Array:
        """Return the mean squares to expect on further data, shape (P, C)."""
        share, (left_out, fitted) = constants.left_out, self.errors(exact)
        return share * left_out + (1.0 - share) * fitted


@dataclass(frozen=True, eq=False)
class Evidence:
    """What models are compared against."""

    base: Scored  # the nominal model, recalibrated
    instrument: Array  # (C,) mean square of the discrepancy of every instrument, in that of noise
    # (C,) mean square of noise in each channel as that of a force, by which channels are added up
    as_force: Array
    constants: Constants = CONSTANTS  # prior and error model
    # (P, C) mean square of noise, in that which was measured beforehand; 1 by default
    noise: Array | None = None
    level: Scored | None = None  # the base with the zeros that it asks for; the base by default
    # whether noise is white; otherwise a bound of all that may be slow, too, and n = k
    white: bool = True

    def informed_by(self, models: Iterable[Scored]) -> 'Evidence':
        """Return the evidence with what further models tell of noise and zeros."""
        every = list(models)
        least = np.min([one.errors(exact=True)[1] for one in every], axis=0)
        level = self.ranked([one for one in every if not one.laws])[0]
        return replace(self, noise=np.clip(least, 1.0, NOISE_IS_KNOWN**2), level=level)

    @cached_property
    def misfit(self) -> tuple[Array, Array]:
        """Return what zeros leave beyond noise, (C,), for inexact laws and for exact ones."""
        level = self.level or self.base
        counts = level.counts
        every = np.maximum(counts.sum(axis=0), 1.0)
        inexact, exact = (
            np.sum(counts * np.maximum(level.expected(self.constants, exact) - 1.0, 0.0), axis=0)
            / every for exact in (False, True))
        return inexact, exact

    @property
    def usual(self) -> float:
        """Return what every instrument leaves on all parts together, as a force squared."""
        return float(self.base.counts[:, 0].sum() * self.instrument[0] * self.as_force[0])

    def log_likelihoods(self, one: Scored) -> tuple[Array, Array]:
        """Return the log likelihood of each part, shape (P,), as exact and with a discrepancy."""
        c, expected, n = self.constants, one.expected(self.constants), one.counts
        noise = self._noise_on(expected) * (1.0 + c.exact * self.misfit[1])
        noise = noise + (c.accuracy / c.instrument) ** 2 * self.instrument
        white = one.expected(c, exact=True)
        exact = -0.5 * n * np.maximum(white / noise - 1.0, 0.0)
        k = np.minimum(n, c.independent)
        d = np.maximum(expected - 1.0, 0.0) + self.instrument + c.ideal * self.misfit[0]
        inexact = -0.5 * k * np.log1p((n / np.maximum(k, 1.0) if self.white else 1.0) * d)
        if not (self.white and one.white):
            exact = np.full(exact.shape, -np.inf)  # what is slow, or may be, is no noise alone
        return exact.sum(axis=1), inexact.sum(axis=1)

    def _noise_on(self, parts: Array) -> Array | float:
        """Return the noise on parts, shape (P, C), or its mean if these are others."""
        if self.noise is None:
            return 1.0
        alike = self.noise.shape == parts.shape
        return self.noise if alike else np.asarray(self.noise.mean(axis=0))

    def log_prior(self, one: Scored) -> float:
        """Return the log prior of a model but for a constant."""
        c = self.constants
        return (-c.parameter * one.parameters - c.law * one.laws - c.curve * one.curves
                - one.penalty)

    def score(self, one: Scored) -> float:
        """Return the log posterior of a model but for a constant."""
        exact, inexact = self.log_likelihoods(one)
        likelihood = np.logaddexp(exact.sum(), inexact.sum())
        return float(likelihood) + self.log_prior(one)

    def ranked(self, models: Iterable[Scored]) -> list[Scored]:
        """Sort models by score, the best first; equal scores by their prior order."""
        return ranked_by(models, lambda one: -self.score(one), lambda one: one.rank)

    def is_exact(self, one: Scored) -> bool:
        """Return whether a model is likelier without a discrepancy than with one."""
        exact, inexact = self.log_likelihoods(one)
        return bool(exact.sum() > inexact.sum())

    def weights(self, models: Sequence[Scored], seed: int) -> Array:
        """Return the posterior weight of each model, shape (M,)."""
        # Averaged over a Bayesian bootstrap of the parts, so that few parts prove little
        # (pseudo-BMA+: Y. Yao, A. Vehtari, D. Simpson and A. Gelman, Bayesian Analysis 13, 2018).
        both = [self.log_likelihoods(one) for one in models]
        exact, inexact = (np.array([pair[k] for pair in both]) for k in (0, 1))
        parts = exact.shape[1]
        drawn = parts * np.random.default_rng(seed).dirichlet(np.ones(parts), DRAWS)
        scores = np.logaddexp(drawn @ exact.T, drawn @ inexact.T)
        scores += [self.log_prior(one) for one in models]
        scores = scores / self.constants.temperature
        scores -= scores.max(axis=1, keepdims=True)
        each = np.exp(scores)
        return np.asarray((each / each.sum(axis=1, keepdims=True)).mean(axis=0))


def of_families(models: Sequence[Scored], weights: Array) -> Mapping[str, float]:
    """Return the probability of each family: the weight of the models that have it."""
    found = dict[str, float]()
    for one, weight in zip(models, weights.tolist()):
        for family in sorted(one.named):
            found[family] = found.get(family, 0.0) + weight
    return found


class Share(NamedTuple):
    """The part of a misfit that a model takes away on parts that it was not fitted on."""

    share: float  # 1 for all of it
    interval: tuple[float, float]  # 95 %, by the jackknife over parts
    parts: Array  # (P,) share of each part


def misfits(evidence: Evidence, one: Scored, channel: int | None) -> Array:
    """Return what a model leaves beyond noise on each part left out, (P,), as a force squared."""
    beyond = one.counts * (one.left_out - 1.0) * evidence.as_force
    return np.asarray(beyond.sum(axis=1) if channel is None else beyond[:, channel])


def taken(evidence: Evidence, before: Scored, after: Scored, channel: int | None = None) -> Array:
    """Return the misfit that is left before a law and not after it, shape (P,) [N^2]."""
    return misfits(evidence, before, channel) - misfits(evidence, after, channel)


def share_of(evidence: Evidence, gain: Array, channel: int | None = None) -> Share:
    """Return a misfit that is taken away, shape (P,) [N^2], as a share of that of the base."""
    base = misfits(evidence, evidence.base, channel)
    noise = (evidence.base.counts * evidence.as_force).sum(axis=1)
    base = np.maximum(base, max(SLIGHT * float(base.mean()), SLIGHT * float(noise.mean())))
    weights = np.minimum(1.0, _OUTWEIGHS * np.median(base) / base)
    gained, whole = weights * gain, weights * base
    share = float(gained.sum() / whole.sum())
    count, others = len(base), whole.sum() - whole
    if count < 2 or float(others.min()) <= _ALL_IN_ONE * float(whole.sum()):
        return Share(share, (-np.inf, np.inf), gain / base)
    without = (gained.sum() - gained) / others
    reach = _TWO_SIDED * float(np.sqrt((count - 1) / count * np.sum(
        (without - without.mean()) ** 2)))
    return Share(share, (share - reach, share + reach), gain / base)


def explained(evidence: Evidence, one: Scored, channel: int | None = None) -> Share:
    """Return the share of the misfit of the base that a model takes away; see `share_of`."""
    return share_of(evidence, taken(evidence, evidence.base, one, channel), channel)
