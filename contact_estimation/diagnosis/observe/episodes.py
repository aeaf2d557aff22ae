# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Contact episodes, and which of them are held out."""

from __future__ import annotations

from math import ceil, log10
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .model import Model
from .observed import Observed
from ...exceptions import RecordingError

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

_LEAST_CONTACT_S, _LEAST_SAMPLES = 0.2, 30
_FEW = 3  # episodes, from which on a whole one can be spared
_STILL = 0.3  # of the longest path of a block: less motion tells little
_NEAR = 0.02  # of the range: such places are the same
_FELT = 0.005  # of the range of the force
_MOSTLY_LATE = 0.5  # of the path in the last block: such a test grows
_THIRDS, _BLOCKS = 3, 5  # of a single episode or an attached wall; blocks of each
_LATE = (3, 4, 2)  # those that may be held out, the best place first


class HeldOut(NamedTuple):
    """The part of a recording that is excluded from fitting."""

    name: str  # such as 'episode 2' or '1.0 to 1.3, 2.0 to 2.3, 3.0 to 3.3 s'
    samples: Flags  # (N,) its samples


def episodes(model: Model, observed: Observed) -> list[tuple[int, int]]:
    """Find the contacts; short ones are left out, unless all are."""
    o = observed
    law = model.laws().contact
    if not law.unilateral:
        return []
    inside = law.contact(o.t, o.x, o.v).astype(int)
    edges = np.flatnonzero(np.diff(inside, prepend=0, append=0))
    pairs = list(zip(edges[::2].tolist(), edges[1::2].tolist()))
    least = _LEAST_CONTACT_S * o.pace / o.h
    if not any(stop - first >= least for first, stop in pairs):
        least = min(least, _LEAST_SAMPLES)  # a probe that touches briefly, sampled fast
    return [(first, stop) for first, stop in pairs if stop - first >= least]


def require_contact(model: Model, observed: Observed, name: str) -> None:
    """Check that the recording has a contact."""
    if model.nominal.environment.unilateral and not episodes(model, observed):
        location = model.nominal.environment.location
        raise RecordingError(
            f'{name} has no contact of {_LEAST_SAMPLES} samples or more: expected x '
            f'beyond {location:g} m (environment.location), got at most '
            f'{np.max(observed.x):.6g} m; record a contact, or correct the location in the model'
        )


def hold_out(model: Model, observed: Observed) -> HeldOut:
    """
    Choose what is held out of a recording: a whole episode, or a late block of each third.

    Never the deepest episode, which would be extrapolation; the nearest to the middle.
    Of one or two episodes the last, or an attached wall, each third spares a block of its last
    three fifths, a fifteenth of the whole: one block alone may lie where any model is right.
    Blocks are chosen, where possible, with motion and at depths that occur in the rest too. They
    have the same duration or, where most of the motion under a force comes late, as with growing
    amplitudes, the same path.
    """
    o = observed
    found = episodes(model, o)
    if len(found) < _FEW:
        return _late_blocks(o, *(found[-1] if found else (0, len(o.t))))
    depth = [float(np.max(o.x[first:stop])) for first, stop in found]
    others, middle = set(range(len(found))) - {int(np.argmax(depth))}, len(found) // 2
    chosen = min(others, key=lambda k: (abs(k - middle), k))
    first = (found[chosen - 1][1] + found[chosen][0]) // 2 if chosen else 0
    last = chosen + 1 == len(found)
    stop = len(o.t) if last else (found[chosen][1] + found[chosen + 1][0]) // 2
    samples = np.zeros(len(o.t), bool)
    samples[first:stop] = True
    return HeldOut(f'episode {chosen + 1}', samples)


def _late_blocks(o: Observed, first: int, stop: int) -> HeldOut:
    """Hold out a late block of each third."""
    count = _THIRDS * _BLOCKS
    if stop - first < count:  # a contact of fewer samples than blocks
        first, stop = 0, len(o.t)
    # A tool that has left tells nothing.
    felt = np.abs(o.force[first + 1:stop]) > _FELT * o.force_range
    travel = np.concatenate(([0.0], np.cumsum(felt * np.abs(np.diff(o.x[first:stop])))))
    block = (stop - first) // count
    edges = stop - block * np.arange(count, -1, -1)
    if travel[edges[-1 - _THIRDS] - first] < (1.0 - _MOSTLY_LATE) * travel[-1]:
        edges[:-1] = first + np.searchsorted(travel, travel[-1] * np.arange(count) / count)
    samples, names = np.zeros(len(o.t), bool), []
    digits = max(1, 1 + ceil(-log10(o.pace)))
    for third in range(_THIRDS):
        numbers = [third * _BLOCKS + k for k in _LATE]
        blocks = [(int(edges[k]), int(edges[k + 1])) for k in numbers]
        moved = [travel[end - 1 - first] - travel[begin - first] for begin, end in blocks]
        known = [pair for pair in blocks if _visited(o.x, *pair)]
        moving = [pair for pair, path in zip(blocks, moved) if path >= _STILL * max(moved)]
        begin, end = next(iter([pair for pair in known if pair in moving] or known or blocks))
        samples[begin:end] = True
        names.append(f'{o.t[begin]:.{digits}f} to {o.t[end - 1]:.{digits}f}')
    return HeldOut(f'{", ".join(names)} s', samples)


def _visited(x: Array, begin: int, end: int) -> bool:
    """Return whether most places of a block are visited elsewhere too."""
    rest = np.sort(np.concatenate((x[:begin], x[end:])))
    here, near = x[begin:end], _NEAR * float(np.ptp(x))
    count = np.searchsorted(rest, here + near) - np.searchsorted(rest, here - near)
    return float(np.mean(count > 0)) > 0.5
