# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The benchmark on records: which files belong together, classes of reports, and the table."""

from __future__ import annotations

from typing import Any

from contact_estimation.benchmarks.record_score import class_of

FRICTION = {'acceptable_names': ['coulomb_friction']}
CLEAN: dict[str, Any] = {'effects': []}


def report(*names: str) -> dict[str, Any]:
    """Return a report with names; a name may carry a rival: name:rival."""
    effects = []
    for words in names:
        name, *rivals = words.split(':')
        effects.append({'name': name, 'probability': 0.9, 'indistinguishable_from': rivals})
    return {'effects': effects}


def test_the_family_of_the_first_name_decides() -> None:
    for truth, names, expected in [
        (FRICTION, ['coulomb_friction'], 'right alone'),
        (FRICTION, ['presliding_friction', 'robot_friction'], 'right alone'),
        (FRICTION, ['bouc_wen_hysteresis'], 'right alone'),
        (FRICTION, ['force_lag:stribeck_friction'], 'right alone'),
        (FRICTION, ['coulomb_friction', 'force_lag'], 'right with surplus'),
        (FRICTION, ['force_lag', 'coulomb_friction'], 'wrong first'),
        (FRICTION, ['force_bias', 'coulomb_friction', 'contact_offset'], 'right alone'),
        (FRICTION, ['force_bias'], 'silent'),
        ({'acceptable_names': ['force_bias']}, ['force_bias'], 'right alone'),
        ({'acceptable_names': ['force_bias']}, ['force_drift'], 'wrong first'),
        ({'acceptable_names': ['dead_zone']}, ['contact_offset'], 'silent'),
        ({'effects': [{'name': 'force_lag', 'also': ['force_bias']}]}, ['force_bias'],
         'right alone'),
        ({'families': ['relaxation']}, ['fractional_relaxation'], 'right alone'),
        (CLEAN, [], 'rightly silent'),
        (CLEAN, ['force_lag'], 'wrong first'),
        (CLEAN, ['contact_offset'], 'rightly silent'),
    ]:
        assert class_of(truth, report(*names)) == expected, (truth, names, expected)
