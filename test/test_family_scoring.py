# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Scores by family, reliability of probabilities, report of the trials on rigs."""

from __future__ import annotations

from typing import Any

from contact_estimation.studies.blind_trials.family_scoring import (
    family_score, FamilyScore, RIGHT, SILENT, WRONG)

LUGRE: dict[str, Any] = {
    'law': 'lugre_friction', 'port': 'contact', 'families': ['friction'], 'unknown': None,
}


def answer(*names: str, **changes: Any) -> dict[str, Any]:
    """Return a report file; a name may carry its probability and a rival: name:0.8:rival."""
    effects = []
    for words in names:
        name, probability, *rivals = (words + ':0.95').split(':')[:2] + words.split(':')[2:]
        effects.append({'name': name, 'probability': float(probability),
                        'indistinguishable_from': rivals})
    verdict = 'physics_missing' if names else 'unexplained'
    return {'report': {'verdict': verdict, 'effects': effects, **changes}, 'error': '',
            'seconds': 1.0}


def scored(truth: dict[str, Any], *names: str, **changes: Any) -> FamilyScore:
    """Score names against a truth."""
    return family_score('trial_1', {**truth, 'stage': 'press', 'concealed': 3.0},
                        answer(*names, **changes))


def test_the_family_of_the_first_name_decides() -> None:
    for names, outcome, surplus in [
        (['coulomb_friction'], RIGHT, False),
        (['presliding_friction', 'stribeck_friction'], RIGHT, False),
        (['bouc_wen_hysteresis:0.9:coulomb_friction'], RIGHT, False),
        (['coulomb_friction', 'force_lag'], RIGHT, True),
        (['force_lag', 'coulomb_friction'], WRONG, False),
        (['force_bias', 'coulomb_friction'], RIGHT, False),
        (['coulomb_friction', 'contact_offset'], RIGHT, False),
        (['force_bias'], SILENT, False),
        ([], SILENT, False),
    ]:
        score = scored(LUGRE, *names)
        assert (score.outcome, score.surplus, score.kind) == (outcome, surplus, 'foreign'), names
