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

import numpy as np

from .criteria import penalty
from .discrepancy import costs_by_channel
from .fitting import fit
from .model_uncertainty import discounted
from ..observe.model import Model
from ..observe.prepared_recording import Recordings
from ..observe.signals import Recording

_MOTION = 1  # channel
_DELAY = 'command_delay'
_LEAST, _SHARE = 5.0, 0.05  # least gain, and as a share of the misfit of the motion
_PRICE = 2.0  # times the usual one: a delay near half a period fits a little better than the hold
_PERIODS = 1.5  # of the reference: the hold and one cycle of a digital controller
_OF_DELAY = 0.8  # least share of what such a delay explains, for the hold to stand for it
_ALIKE = 0.5  # least share of what a model leaves on straight lines, for it to leave alike
_OF_BEST = 0.2  # least share of what the best model explains, for the hold to matter without it


class ReferenceHold:
    """
    Comparison of a reference that is straight between setpoints with one that is held.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        With the former, without a discrepancy.
    raw, held : sequence of Recording
        As recorded, and with the latter.
    base : Model
        Recalibrated.

    """

    def __init__(
        self, recordings: Recordings, raw: Sequence[Recording], held: Sequence[Recording],
        base: Model,
    ) -> None:
        self._straight, self._base = recordings, base
        self._held = [discounted(one.with_reference_of(other, base), base)
                      for one, other in zip(recordings, held)]
        self._count = sum(one.block_count for one in recordings)
        self._period = min(float(np.median(np.diff(one.signals.reference_t))) for one in raw)

    def is_promising(self, best: Model) -> bool:
        """Return whether a hold explains the motion better, to the base or the best model."""
        of_sampling = self._is_of_sampling(best)
        if of_sampling and self.is_better(best.without(_DELAY), best):
            return True
        if self.is_better(best, best):
            return True
        # Of what is explained down to the noise no selection finds more.
        if not of_sampling and _price(self._straight, best) < self._count:
            return False
        return self.is_better(self._base, self._base) and self._matters_beside(best)

    def _matters_beside(self, best: Model) -> bool:
        """Return whether the hold explains a fair share of what the best model does."""
        before = _price(self._straight, self._base)
        explained = before - _price(self._straight, best)
        return before - _price(self._held, self._base) > _OF_BEST * explained

    def leaves_alike(self, best: Model) -> bool:
        """Return whether a model without a delay leaves as much with a hold, or half of it."""
        straight, held = (fit(each, best).cost - sum(one.residual_count for one in each)
                          for each in (self._straight, self._held))
        return held > _ALIKE * straight and _DELAY not in best.effects

    def instead_of_delay(self, straight: Model) -> Model | None:
        """Return a model without its delay, if the held reference explains more than that."""
        if not self._is_of_sampling(straight):
            return None
        without = straight.without(_DELAY)
        more = _price(self._held, without) < _price(self._straight, straight)
        return without if more else None

    def is_better(self, held: Model, straight: Model) -> bool:
        """Return whether a model explains the held reference better than another the straight."""
        after, price = _price(self._held, held), _price(self._straight, straight)
        fewer = len(held.effects) < len(straight.effects)
        least = _LEAST if fewer else max(_LEAST, _SHARE * (price - self._count))
        if price - after > least:
            return True
        if _DELAY in held.effects or not self._is_of_sampling(straight):
            return False
        before = _price(self._straight, self._base)
        return before - after > _OF_DELAY * (before - price)

    def _is_of_sampling(self, model: Model) -> bool:
        """Return whether a model has a delay that the sampling of the command may cause."""
        if _DELAY not in model.effects:
            return False
        return model.values[model.place(_DELAY).start] <= _PERIODS * self._period


def _price(recordings: Recordings, model: Model) -> float:
    """Return the cost of the motion of a model, and that of its effects."""
    cost = float(costs_by_channel(recordings, fit(recordings, model))[_MOTION])
    return cost + _PRICE * penalty(model)
