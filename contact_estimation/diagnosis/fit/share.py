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

"""The share of a misfit that an effect takes away on parts that it was not fitted on."""

from __future__ import annotations

from typing import NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray

from .parts import above_noise, Part

Array = NDArray[np.float64]

_TWO_SIDED = 1.96  # standard deviations of a 95 % interval


class Share(NamedTuple):
    """
    The part of a misfit that a model takes away on parts that it was not fitted on.

    Attributes
    ----------
    share : float
        Of the squared misfit above the noise, over all parts; below 0 if it predicts worse.
    interval : (float, float)
        95 %, by the jackknife over the parts; a part of which the others determine no prediction
        counts as not predicted, which is no matter of chance.
    parts : ndarray, shape (parts,)
        Part by part.
    harm : float
        What it adds on the parts that it predicts worse, of the same misfit.

    """

    share: float
    interval: tuple[float, float]
    parts: Array
    harm: float = 0.0


def share_of(
    before: Array, after: Array, parts: Sequence[Part], whole: Array, channel: int | None = None,
) -> Share:
    """
    Compute the share of a misfit that a further effect takes away.

    Parameters
    ----------
    before, after : ndarray, shape (parts, CHANNELS)
        `left_out_errors` without and with the effect.
    parts : sequence of Part
        For the noise.
    whole : ndarray, shape (parts, CHANNELS)
        `left_out_errors` of the model whose misfit counts as 1.
    channel : int, optional
        The only one that counts; by default all do.

    Returns
    -------
    share : Share
        Of the effect, at most 1 of all parts together.

    """
    columns = slice(None) if channel is None else slice(channel, channel + 1)
    gain = (before - after)[:, columns].sum(axis=1)
    misfit = above_noise(whole, parts, columns)
    # What is taken away was no noise, however large that was estimated.
    misfit = misfit * max(1.0, float(gain.sum() / misfit.sum()))
    share = float(gain.sum() / misfit.sum())
    harm = float(np.maximum(-gain, 0.0).sum() / misfit.sum())
    known = gain != 0.0
    count, seen = int(np.count_nonzero(known)), float(misfit[known].sum())
    if count < 2:
        return Share(share, (-np.inf, np.inf), gain / misfit, harm)
    without = (gain.sum() - gain[known]) / (seen - misfit[known]) * (seen / misfit.sum())
    spread = float(np.sqrt((count - 1) / count * np.sum((without - without.mean()) ** 2)))
    reach = _TWO_SIDED * spread
    return Share(share, (share - reach, share + reach), gain / misfit, harm)
