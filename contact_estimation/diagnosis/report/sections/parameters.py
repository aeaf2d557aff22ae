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


"""K_e, B_e and M_e of the three models."""

from __future__ import annotations

from typing import Any

from .inputs import Inputs


def prepare(inputs: Inputs) -> dict[str, Any]:
    """Return a row for each parameter; `std` is None where an effect replaces it."""
    d = inputs.diagnosis
    rows = [
        {'symbol': symbol, 'unit': value.unit, 'nominal': d.nominal.values[place],
         'recalibrated': d.recalibrated.values[place],
         'corrected': value if d.corrected.free[place] else None}
        for place, (symbol, value) in enumerate((('K_e', d.stiffness), ('B_e', d.damping)))
    ]
    inertia = None
    if d.nominal.with_inertia:
        inertia = [model.values[2] for model in (d.nominal, d.recalibrated, d.corrected)]
    return {'rows': rows, 'inertia': inertia}
