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


"""How much of the mismatch each candidate effect alone would explain."""

from __future__ import annotations

from typing import Any

from .inputs import Inputs
from ..figures import plot_evidence


def prepare(inputs: Inputs) -> dict[str, Any] | None:
    """Return the ranking as a figure; None if no candidate was tested."""
    if not inputs.diagnosis.evidence:
        return None
    return {'figure': plot_evidence(inputs.diagnosis)}
