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


"""The named effects with their laws and parameters."""

from __future__ import annotations

from typing import Any

from .inputs import Inputs
from ....parameters.specification import specifications
from ....physics import EFFECTS


def prepare(inputs: Inputs) -> dict[str, Any] | None:
    """Return the effects and what their parameters mean; None without effects."""
    effects = inputs.diagnosis.effects
    if not effects:
        return None
    descriptions = {
        effect.name: {spec.name: spec.description
                      for spec in specifications(EFFECTS[effect.name].Parameters)}
        for effect in effects
    }
    return {'effects': effects, 'descriptions': descriptions}
