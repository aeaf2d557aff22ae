# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Recordings of a fleet with results made up: what statistics and page of the fleet look at."""

from typing import Any, Sequence

from contact_estimation.fleet.table import Entry, in_time

FAMILIES = {'coulomb_friction': 'friction', 'force_bias': 'sensor_zero'}
DAY_NS = 86_400 * 10**9
BEGIN_NS = 1_750_000_000 * 10**9


def report(stiffness: float | None = 4800.0, names: Sequence[str] = ()) -> dict[str, Any]:
    """Return a report of `diagnose` with the given stiffness and names."""
    errors = {'nominal': 3.0, 'recalibrated': 2.0, 'corrected': 0.4}
    return {
        'verdict': 'physics_missing' if names else 'recalibrate',
        'effects': [{
            'name': name, 'family': FAMILIES[name], 'probability': 0.9, 'share': 0.8,
            'share_interval': [0.7, 0.9],
            'parameters': {'p': {'value': 6.0, 'std': 0.1, 'unit': 'N'}},
        } for name in names],
        'location': None, 'remainder': None,
        'checks': [{'name': 'force_sign', 'ok': True, 'text': 'as expected'}],
        'nominal': {'stiffness': 4300.0, 'damping': 260.0},
        'recalibrated': {'stiffness': 4790.0, 'damping': 202.0},
        'corrected': {'stiffness': {'value': stiffness, 'std': 1.0},
                      'damping': {'value': 200.0, 'std': 0.5}},
        'fit': {'noise_floor_n': 0.3, 'force_rmse_n': errors, 'motion_rmse_m': None,
                'improvement_interval': None, 'holdouts': []},
    }


def outcome(
    report: dict[str, Any] | None, start_ns: int | None = 0, **more: Any
) -> dict[str, Any]:
    """Return the outcome of a worker."""
    return {'version': '1', 'start_ns': start_ns, 'duration_s': 8.0, 'episodes': [],
            'diagnosed_s': 8.0, 'report': report, 'error': '', **more}


def group_of(name: str, reports: Sequence[dict[str, Any] | None]) -> list[Entry]:
    """Return a recording a day for each report; one without a report is broken."""
    return [
        Entry(f'{name}/run_{k}.mcap', f'/archive/{name}/run_{k}.mcap', name, f'{name}{k}',
              outcome(None, None, error='broken') if one is None
              else outcome(one, BEGIN_NS + k * DAY_NS))
        for k, one in enumerate(reports)]


def archive(**groups: Sequence[dict[str, Any] | None]) -> list[Entry]:
    """Return the groups' recordings, numbered in time."""
    return in_time(entry for name, reports in groups.items() for entry in group_of(name, reports))
