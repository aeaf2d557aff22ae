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


"""Recording and simulations over time, and the residuals before and after the correction."""

from __future__ import annotations

from typing import Any

from .inputs import Inputs
from ..figures import plot_comparison, plot_residuals


def prepare(inputs: Inputs) -> dict[str, Any]:
    """Return the figures of the signals and of their residuals."""
    d, data = inputs.diagnosis, inputs.plots
    return {
        'shown': d.shown,
        'recordings': len(d.recordings),
        'force': plot_comparison(data, data.force),
        'position': None if data.position is None else plot_comparison(data, data.position),
        'residuals': [(one.label, plot_residuals(data, one)) for one in data.residuals],
    }
