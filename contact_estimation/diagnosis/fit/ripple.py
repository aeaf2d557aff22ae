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

"""
Positions that ripple: an encoder whose error repeats with the angle.

What no mass follows is then most of the misfit of single samples, coloured but with little power
at low frequencies, and hides a friction that every longer mean of them shows.
"""

from __future__ import annotations

import numpy as np

from ..observe.channel import sum_blocks
from ..observe.model import Model
from ..observe.prepared_recording import PreparedRecording
from ..observe.residuals import residuals

_FAR = 4.0  # times the noise: power of the residuals
_MEAN_S, _BLOCK_S = 0.04, 0.1  # tells ripple, and averages it
_WHITE = 0.3  # power of such a mean, in that of residuals that are all of one sign


def without_ripple(recording: PreparedRecording, model: Model) -> PreparedRecording:
    """Average the innovations of a driven wall over longer blocks if its positions ripple."""
    one, size = recording, round(_MEAN_S * recording.observed.pace / recording.block_s)
    if not one.driven_by_force(model) or size < 2:
        return one
    left = residuals(one, model, robust=False)
    full = sum_blocks(one.motion.filled.astype(float), size) == size
    power = float(np.mean(sum_blocks(left**2, size)[full])) / size if full.any() else 0.0
    if power < _FAR or float(np.mean(sum_blocks(left, size)[full] ** 2)) > (
            _WHITE * power * size**2):
        return one
    return one.in_blocks(round(_BLOCK_S * one.observed.pace / one.observed.h), model)
