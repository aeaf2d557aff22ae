# Copyright 2026 contact_estimation authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

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

_LEAST_CONTACT_S = 0.2
_FEW = 3  # episodes, from which on a whole one can be spared
_STILL = 0.3  # of the longest path of a block: less motion tells little
_NEAR = 0.02  # of the range: such places are the same
_MOSTLY_LATE = 0.5  # of the path in the last block: such a test grows
_BLOCKS = 5  # of a single episode or an attached wall; the fourth is held out


class HeldOut(NamedTuple):
    """
    The part of a recording that is excluded from fitting.

    Attributes
    ----------
    name : str
        Such as 'episode 2'.
    samples : ndarray of bool, shape (N,)
        Its samples.

    """

    name: str
    samples: Flags


def episodes(model: Model, observed: Observed) -> list[tuple[int, int]]:
    """
    Find the contacts; short ones are left out.

    Parameters
    ----------
    model : Model
        Defines where the surface is.
    observed : Observed
        The recording.

    Returns
    -------
    episodes : list of (int, int)
        First sample and the one after the last.

    """
    o = observed
    law = model.laws().contact
    if not law.unilateral:
        return []
    inside = law.contact(o.t, o.x, o.v).astype(int)
    edges = np.flatnonzero(np.diff(inside, prepend=0, append=0))
    pairs = list(zip(edges[::2].tolist(), edges[1::2].tolist()))
    least = _LEAST_CONTACT_S * o.pace
    return [pair for pair in pairs if (pair[1] - pair[0]) * o.h >= least]


def require_contact(model: Model, observed: Observed, name: str) -> None:
    """
    Check that the recording has a contact.

    Parameters
    ----------
    model : Model
        Nominal.
    observed : Observed
        The recording.
    name : str
        For the error message.

    Raises
    ------
    RecordingError
        If the tool never reaches the wall.

    """
    if model.nominal.environment.unilateral and not episodes(model, observed):
        location = model.nominal.environment.location
        raise RecordingError(
            f'{name} has no contact of {_LEAST_CONTACT_S * observed.pace:g} s or more: expected x '
            f'beyond {location:g} m (environment.location), got at most '
            f'{np.max(observed.x):.6g} m; record a contact, or correct the location in the model'
        )


def hold_out(model: Model, observed: Observed) -> HeldOut:
    """
    Choose the part of a recording that is held out: a whole episode, or a late block.

    Never the deepest episode, which would be extrapolation; the middle one, or the one before it.
    One or two episodes give a block of the last one's second half, where possible one with motion
    and at depths that occur in the rest too: a law is not known from half of two touches. Blocks
    have the same duration or, where most of the motion comes late, as with growing amplitudes, the
    same path.

    Parameters
    ----------
    model : Model
        Defines where the surface is.
    observed : Observed
        The recording.

    Returns
    -------
    part : HeldOut
        Name and samples.

    """
    o = observed
    found = episodes(model, o)
    samples = np.zeros(len(o.t), bool)
    if len(found) >= _FEW:
        depth = [float(np.max(o.x[first:stop])) for first, stop in found]
        deepest = int(np.argmax(depth))
        middle = len(found) // 2
        chosen = middle if middle != deepest else middle - 1
        first = (found[chosen - 1][1] + found[chosen][0]) // 2 if chosen else 0
        last = chosen + 1 == len(found)
        stop = len(o.t) if last else (found[chosen][1] + found[chosen + 1][0]) // 2
        samples[first:stop] = True
        return HeldOut(f'episode {chosen + 1}', samples)
    first, stop = found[-1] if found else (0, len(o.t))
    travel = np.concatenate(([0.0], np.cumsum(np.abs(np.diff(o.x[first:stop])))))
    block = (stop - first) // _BLOCKS
    edges = stop - block * np.arange(_BLOCKS, -1, -1)
    if travel[edges[-2] - first] < (1.0 - _MOSTLY_LATE) * travel[-1]:
        edges[:-1] = first + np.searchsorted(travel, travel[-1] * np.arange(_BLOCKS) / _BLOCKS)
    blocks = [(int(edges[-k - 1]), int(edges[-k])) for k in (2, 1, 3)]
    moved = [travel[end - 1 - first] - travel[begin - first] for begin, end in blocks]
    known = [pair for pair in blocks if _visited(o.x, *pair)]
    moving = [pair for pair, path in zip(blocks, moved) if path >= _STILL * max(moved)]
    begin, end = next(iter([pair for pair in known if pair in moving] or known or blocks))
    samples[begin:end] = True
    digits = max(1, 1 + ceil(-log10(o.pace)))
    return HeldOut(f'{o.t[begin]:.{digits}f} to {o.t[end - 1]:.{digits}f} s', samples)


def _visited(x: Array, begin: int, end: int) -> bool:
    """Return whether most places of a block are visited elsewhere too."""
    rest = np.sort(np.concatenate((x[:begin], x[end:])))
    here, near = x[begin:end], _NEAR * float(np.ptp(x))
    count = np.searchsorted(rest, here + near) - np.searchsorted(rest, here - near)
    return float(np.mean(count > 0)) > 0.5
