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

"""Whether a robot holds its reference between setpoints, told by its motion."""

from __future__ import annotations

from typing import Sequence

from .criteria import penalty
from .discrepancy import costs_by_channel
from .fitting import fit
from .model_uncertainty import discounted
from ..observe.model import Model
from ..observe.prepared_recording import Recordings
from ..observe.signals import Recording

_MOTION = 1  # channel
_LEAST, _SHARE = 5.0, 0.05  # least gain, and as a share of the misfit of the motion
_PRICE = 2.0  # times the usual one: a delay near half a period fits a little better than the hold


class ReferenceHold:
    """
    Comparison of a reference that is straight between setpoints with one that is held.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        With the former, without a discrepancy.
    held : sequence of Recording
        The same with the latter.
    model : Model
        Recalibrated.

    """

    def __init__(
        self, recordings: Recordings, held: Sequence[Recording], model: Model
    ) -> None:
        self._straight = recordings
        self._held = [discounted(one.with_reference_of(other, model), model)
                      for one, other in zip(recordings, held)]
        self._count = sum(one.block_count for one in recordings)

    def is_promising(self, models: Sequence[Model]) -> bool:
        """Return whether one of some models explains the motion better if the robot holds."""
        return any(self.is_better(model, model) for model in models)

    def is_better(self, held: Model, straight: Model) -> bool:
        """Return whether a model explains the held reference better than another the straight."""
        price = _price(self._straight, straight)
        least = max(_LEAST, _SHARE * (price - self._count))
        return price - _price(self._held, held) > least


def _price(recordings: Recordings, model: Model) -> float:
    """Return the cost of the motion of a model, and that of its effects."""
    cost = float(costs_by_channel(recordings, fit(recordings, model))[_MOTION])
    return cost + _PRICE * penalty(model)
