# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Scores by family, reliability of probabilities, report of the trials on rigs."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from contact_estimation.studies.blind_trials.family_scoring import (
    FAILED, family_dict, family_groups, family_score, family_text, FamilyScore, outcomes,
    overlap_of, plot_reliability, reliability, RIGHT, SILENT, WRONG)
import pytest

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


@pytest.mark.parametrize('names, outcome, surplus', [
    (['coulomb_friction'], RIGHT, False),
    (['presliding_friction', 'stribeck_friction'], RIGHT, False),
    (['bouc_wen_hysteresis:0.9:coulomb_friction'], RIGHT, False),
    (['coulomb_friction', 'force_lag'], RIGHT, True),
    (['force_lag', 'coulomb_friction'], WRONG, False),
    (['force_bias', 'coulomb_friction'], RIGHT, False),
    (['coulomb_friction', 'contact_offset'], RIGHT, False),
    (['force_bias'], SILENT, False),
    ([], SILENT, False),
])
def test_the_family_of_the_first_name_decides(
    names: list[str], outcome: str, surplus: bool
) -> None:
    score = scored(LUGRE, *names)
    assert (score.outcome, score.surplus, score.kind) == (outcome, surplus, 'foreign')


def test_a_bias_counts_where_the_sensor_zero_is_the_family() -> None:
    truth = {**LUGRE, 'law': 'settling_bias', 'families': ['sensor_zero']}
    assert scored(truth, 'force_bias').outcome == RIGHT


def test_any_name_is_wrong_where_no_family_describes_the_law() -> None:
    assert (scored(HUM, 'force_lag').outcome, scored(CLEAN, 'force_lag').outcome) == (WRONG, WRONG)
    assert not scored(HUM).is_miss
    assert not scored(CLEAN).is_miss
    assert scored(CLEAN, 'force_lag').is_miss


def test_location_of_an_unknown_law_is_compared_with_the_truth() -> None:
    location = {'port': 'force_sensor', 'intervals_s': [[2.0, 4.0]]}
    score = scored(HUM, location=location)
    assert score.port_right
    assert score.overlap == pytest.approx(1.0 / 3.0)
    assert scored(CLEAN, location=location).port_right is None
    assert overlap_of([], [[0.0, 1.0]]) == 0.0


def test_a_failed_diagnosis_is_neither_silent_nor_wrong() -> None:
    failed = family_score('trial_1', {**LUGRE, 'stage': 'drive', 'concealed': 2.0},
                          {'report': None, 'error': 'no contact', 'seconds': 1.0})
    assert (failed.outcome, failed.verdict) == (FAILED, '')
    assert 'failed: no contact' in family_text([failed], 'DIR')


def test_reliability_counts_every_name_in_its_bin() -> None:
    scores = [scored(LUGRE, 'coulomb_friction:0.95'), scored(LUGRE, 'force_lag:1.0'),
              scored(LUGRE, 'coulomb_friction:0.75', 'force_lag:0.72'),
              scored(CLEAN, 'force_lag:0.6'), scored(LUGRE)]
    table = reliability(scores)
    assert [row.names for row in table] == [0, 1, 2, 0, 2]
    assert [row.share_right for row in table] == [None, 0.0, 0.5, None, 0.5]
    assert table[4].mean == pytest.approx(0.975)


def test_reliability_is_plotted(tmp_path: Path) -> None:
    pytest.importorskip('matplotlib')
    scores = [scored(LUGRE, 'coulomb_friction:0.95'), scored(LUGRE, 'force_lag:0.6')]
    assert plot_reliability(scores, tmp_path / 'reliability.png').stat().st_size > 1000


def test_outcomes_are_counted_by_law_family_and_experiment() -> None:
    two = {**LUGRE, 'law': 'maxwell_slip', 'families': ['hysteresis', 'friction']}
    scores = [scored(LUGRE, 'coulomb_friction'), scored(two), scored(HUM)]
    split = family_groups(scores)
    assert {label: len(part) for label, part in split['family'].items()} == {
        'friction': 2, 'hysteresis': 1, 'unknown': 1}
    assert outcomes(split['experiment']['press']) == {
        'trials': 3, RIGHT: 1, WRONG: 0, SILENT: 2, FAILED: 0, 'surplus': 0}


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
