# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""One law for each group: several recordings together, each predicted by the others."""

from __future__ import annotations

from typing import Any

from .wording import words
from ..pooling import PooledResult
from ..run import Fleet


def prepare(fleet: Fleet) -> dict[str, Any] | None:
    """Return the pooled diagnosis of each group; None if there is none."""
    return {'groups': [_group(one) for one in fleet.pooled]} if fleet.pooled else None


def _group(result: PooledResult) -> dict[str, Any]:
    report = result.whole['report']
    families = _families(report)
    rows = [{'entry': entry, **_left_out(outcome, families)}
            for entry, outcome in zip(result.pool.members, result.left_out)]
    return {
        'name': result.pool.group, 'since': result.pool.since, 'page': result.page,
        'report': report, 'error': result.whole['error'], 'rows': rows,
        'verdict': words(report['verdict']) if report else '',
        'same': sum(row['same'] for row in rows),
    }


def _left_out(outcome: dict[str, Any], families: list[str]) -> dict[str, Any]:
    """Return what the other recordings name, and how they predict the one left out."""
    report = outcome['report']
    return {
        'names': [words(effect['name']) for effect in report['effects']] if report else [],
        'same': report is not None and _families(report) == families,
        'force': report['fit']['force_rmse_n'] if report else None,
        'noise': report['fit']['noise_floor_n'] if report else None,
        'error': outcome['error'],
    }


def _families(report: dict[str, Any] | None) -> list[str]:
    return sorted({effect['family'] for effect in report['effects']}) if report else []
