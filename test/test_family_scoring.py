# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Scores by family, reliability of probabilities, report of the trials on rigs."""

from __future__ import annotations

import json
from typing import Any

from contact_estimation.blind_trials.family_report import family_dict, family_text
from contact_estimation.blind_trials.family_scoring import (
    family_score,
    FamilyScore,
    RIGHT,
    SILENT,
    WRONG,
)

LUGRE: dict[str, Any] = {
    'law': 'lugre_friction', 'port': 'contact', 'families': ['friction'], 'unknown': None,
}
HUM: dict[str, Any] = {
    'law': 'mains_hum', 'port': 'force_sensor', 'families': [],
    'unknown': {'intervals_s': [[1.0, 3.0]]},
}
CLEAN: dict[str, Any] = {'law': '', 'port': '', 'families': [], 'unknown': None}


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


def test_text_and_json_hold_shares_reliability_and_misses() -> None:
    scores = [scored(LUGRE, 'coulomb_friction'), scored(LUGRE, 'force_lag:0.8'), scored(HUM),
              scored(CLEAN, 'force_lag')]
    text = family_text(scores, 'DIR')
    assert 'right family first [%]' in text
    assert 'false alarms in clean worlds [%]' in text
    assert 'lugre_friction (press), 3.0 times; expected friction, diagnosed force_lag 0.80' in text
    study = json.loads(json.dumps(family_dict(scores)))
    assert study['kinds']['foreign']['right'] == 1
    assert len(study['reliability']) == 5
    assert study['trials'][0]['names'][0]['probability'] == 0.95
