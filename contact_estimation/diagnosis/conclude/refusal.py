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

"""The result of recordings that must be put right before anything can be diagnosed."""

from __future__ import annotations

from math import nan
from typing import Sequence

from .result import Diagnosis, Errors, Value
from ..checks.check import Check
from ..observe.model import Model

_NOTHING = Errors(None, None, None)


def refuse(checks: Sequence[Check], nominal: Model) -> Diagnosis:
    """Return a diagnosis without names, fits and recordings."""
    failed = [check.text for check in checks if not check.ok and check.fatal]
    return Diagnosis(
        verdict='unexplained', effects=[], location=None, remainder=None, nominal=nominal,
        recalibrated=nominal, corrected=nominal, stiffness=Value(nominal.stiffness, nan, 'N/m'),
        damping=Value(nominal.damping, nan, 'N s/m'), noise_floor=nan, force=_NOTHING,
        motion=_NOTHING, improvement=None, holdouts=[],
        next_experiment=f'Put this right and repeat: {"; ".join(failed)}.', rivals={},
        evidence={}, residual_power=nan, dependences={}, recordings=[],
        free_runs={}, checks=list(checks),
    )
