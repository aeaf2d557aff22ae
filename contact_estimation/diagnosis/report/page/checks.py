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


"""The checks for wrong use."""

from __future__ import annotations

from typing import Any

from .inputs import Inputs
from ...checks.check import Check


def prepare(inputs: Inputs) -> dict[str, Any] | None:
    """Return the checks, failed ones first; None if there were none."""
    checks = inputs.diagnosis.checks
    if not checks:
        return None
    failed = [check for check in checks if not check.ok]
    return {
        'rows': [(check, _result(check)) for check in sorted(checks, key=lambda one: one.ok)],
        'failed': len(failed),
        'refused': inputs.diagnosis.refused,
    }


def _result(check: Check) -> str:
    if not check.tested:
        return 'not tested'
    return 'ok' if check.ok else 'failed'
