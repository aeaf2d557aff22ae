# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""How much of the misfit models take away on parts that they were not fitted on."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .evidence import Evidence, Scored

Array = NDArray[np.float64]

_TWO_SIDED = 1.96  # standard deviations of a 95 % interval
_LEAST = 0.01  # of the mean misfit, or of noise: the least misfit of a part
_ALL_IN_ONE = 1e-3  # share of the misfit in all parts but one: a jackknife tells nothing
_OUTWEIGHS = 2.0  # times the median misfit of the parts, beyond which a part counts no more


class Share(NamedTuple):
    """
    The part of a misfit that a model takes away on parts that it was not fitted on.

    Attributes
    ----------
    share : float
        1 for all of it.
    interval : tuple of float
        95 %, by the jackknife over parts.
    parts : ndarray, shape (P,)
        Share of each part.

    """

    share: float
    interval: tuple[float, float]
    parts: Array


def _misfits(evidence: Evidence, one: Scored, channel: int | None) -> Array:
    """Return what a model leaves beyond noise on each part left out, as a force squared, (P,)."""
    beyond = one.counts * (one.left_out - 1.0) * evidence.as_force
    return np.asarray(beyond.sum(axis=1) if channel is None else beyond[:, channel])


def share_of(
    evidence: Evidence, before: Scored, after: Scored, channel: int | None = None
) -> Share:
    """Return the share of the misfit of the base that is left before a law and not after it."""
    base = _misfits(evidence, evidence.base, channel)
    noise = (evidence.base.counts * evidence.as_force).sum(axis=1)
    base = np.maximum(base, max(_LEAST * float(base.mean()), _LEAST * float(noise.mean())))
    gain = _misfits(evidence, before, channel) - _misfits(evidence, after, channel)
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
    return share_of(evidence, evidence.base, one, channel)
