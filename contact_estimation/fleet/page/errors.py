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

"""Recordings that could not be used, and those refused by a check."""

from __future__ import annotations

from typing import Any

from .wording import words
from ..run import Fleet


def prepare(fleet: Fleet) -> dict[str, Any] | None:
    """Return the recordings with an error or a failed check; None if there are none."""
    failed = [(entry, entry.outcome['error']) for entry in fleet.failed]
    refused = [(entry, _failed_checks(entry.outcome['report'])) for entry in fleet.entries
               if entry.outcome['report'] and entry.report is None]
    return {'failed': failed, 'refused': refused} if failed or refused else None


def _failed_checks(report: dict[str, Any]) -> str:
    return '; '.join(f'{words(check["name"])}: {check["text"]}' for check in report['checks']
                     if not check['ok'])
