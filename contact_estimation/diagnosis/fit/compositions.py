# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
Starts of laws that act on each other: the relaxation of a curved elastic force.

Neither foretells what both explain: a curve alone does not relax, and what relaxes alone is
straight. Beside a relaxing branch of a known share of the spring and of a known rate, the force is
linear in the elastic law (Y. C. Fung, Biomechanics, 1993, section 7.6), whose best values follow
from one linear least squares (G. Golub and V. Pereyra, Inverse Problems 19, 2003).
"""

from functools import lru_cache
from itertools import product
from typing import Callable, Iterator, NamedTuple, Sequence, TypeVar

import numpy as np
from scipy.optimize import lsq_linear

from ..observe.model import Model, names_of
from ...parameters import own_specifications
from ...physics import EFFECTS
from ...physics.numeric import Array
from ...physics.prior import Scales

_LARGER = (1.0, 5.0, 25.0)  # than at the start of a prior: what relaxes, beside what does not
_LEAST = 0.01  # of the spring: of none, nothing would be a share

Item = TypeVar('Item')


class Composed(NamedTuple):
    """A pair of laws with values."""

    model: Model  # the present model with both
    residuals: Array  # (R,) foretold


def compose(
    present: Model, names: Sequence[str], scales: Scales, residuals: Callable[[Model], Array]
) -> Iterator[list[Composed]]:
    """
    Yield each elastic law with each memory of the elastic force.

    Each pair at several shapes, with the values of the elastic law that fit best.
    """
    residuals = lru_cache(maxsize=128)(residuals)  # without a curve, all curves are the same
    memories = [name for name in names if getattr(EFFECTS[name], 'relaxes', False)]
    curves = [name for name in names if EFFECTS[name].changes & {'spring', 'elastic'}]
    for memory, curve in product(memories, curves):
        rates, shapes = (_spread(EFFECTS[name].prior(scales).starts) for name in (memory, curve))
        yield [_fitted(present, (curve, memory), shape, (larger * amount / scales.spring, *rate),
                       scales, residuals)
               for shape, (amount, *rate), larger in product(shapes, rates, _LARGER)]


def _fitted(
    present: Model, pair: tuple[str, str], curve: tuple[float, ...], memory: tuple[float, ...],
    scales: Scales, residuals: Callable[[Model], Array],
) -> Composed:
    """Fit K_e, B_e and what the curve is linear in; the memory's first value is one by K_e."""
    own = np.array([name in EFFECTS[pair[0]].linear() for name in names_of(pair[0])])
    share, *rate = memory
    is_bent = 'spring' in EFFECTS[pair[0]].changes  # K_e stays as it is

    def at(factors: Array) -> Model:
        """Return the pair with multiples of the usual K_e, B_e and linear values of the curve."""
        K_e, B_e = scales.spring * factors[0], scales.damper * factors[1]
        made = present.at((K_e, B_e, *present.values[2:]))
        if is_bent or factors[2:].any():
            values = np.array(curve)
            values[own] *= factors[2:]
            made = made.with_effect(pair[0], tuple(values.tolist()))
        return made.with_effect(pair[1], (share * K_e, *rate))

    usual = np.array([1.0, 0.0, *np.zeros(np.count_nonzero(own))])
    low = np.array([_LEAST - 1.0, 0.0, *(
        -np.inf if one.minimum is None else 0.0
        for one, is_own in zip(own_specifications(EFFECTS[pair[0]]), own) if is_own)])
    free = np.ones(len(usual), bool)
    free[0] = not is_bent
    here = residuals(at(usual))
    columns = np.column_stack([
        residuals(at(usual + one)) - here for one in np.eye(len(usual))[free]])
    # Of the triangle of a QR decomposition alone: many thousand residuals are a few.
    q, r = np.linalg.qr(columns)
    change = lsq_linear(r, -(q.T @ here), (low[free], np.inf), method='bvls').x
    found = usual.copy()
    found[free] += change
    return Composed(at(found), here + columns @ change)


def _spread(items: Sequence[Item]) -> list[Item]:
    """Return the first, the middle and the last of some items."""
    return [items[k] for k in sorted({0, len(items) // 2, len(items) - 1})]
