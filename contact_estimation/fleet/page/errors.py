# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

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
