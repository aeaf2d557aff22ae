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


"""Errors on held-out data, part by part."""

from __future__ import annotations

from typing import Any

from .inputs import Inputs
from ..wording import improvement


def prepare(inputs: Inputs) -> dict[str, Any]:
    """Return a row of errors for each held-out part and channel."""
    d = inputs.diagnosis
    parts = [(part.name, part.force, part.motion) for part in d.holdouts]
    if len(parts) > 1:
        parts.append(('all parts', d.force, d.motion))
    rows = []
    for name, force, motion in parts:
        rows.append((name, 'force [N]', force, 1.0))
        if motion.nominal is not None:
            rows.append((name, 'free-run position [µm]', motion, 1e6))
    return {'rows': rows, 'noise_floor': d.noise_floor, 'improvement': improvement(d)}
