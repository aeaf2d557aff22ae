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


"""Where the mismatch sits: port, time, motion, and on what the residuals depend."""

from __future__ import annotations

from typing import Any

from .inputs import Inputs
from ..figures import plot_dependences, plot_plane
from ..wording import significant, tested_dependences
from ...fit.discrepancy import has_discrepancy


def prepare(inputs: Inputs) -> dict[str, Any]:
    """Return the location, and figures of residuals over motion and other quantities."""
    d = inputs.diagnosis
    tested = tested_dependences(d)
    return {
        'location': d.location,
        'unexplained': d.verdict == 'unexplained' and not d.effects,
        # With a discrepancy residuals are in its size, not in that of the noise.
        'mean_square': None if has_discrepancy(d.recordings) else d.residual_power,
        'channel': d.located_channel,
        'significant': {name: significant(found) for name, found in tested.items()},
        'plane': plot_plane(inputs.plots),
        'dependences': plot_dependences(tested) if tested else None,
    }
