# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Scores of reports against truths."""

from __future__ import annotations

from typing import Any

from blind_worlds import answer, truth
from contact_estimation.studies.blind_trials.scoring import (
    as_text, RIGHT, Score, score, SILENT, WRONG)
import pytest

LUGRE: dict[str, Any] = {
    'law': 'lugre_friction', 'port': 'contact', 'families': ['friction'], 'unknown': None,
    'stage': 'press', 'concealed': 3.0,
}


def scored(truth: dict[str, Any], answer: dict[str, Any]) -> Score:
    return score('trial_1', truth, answer)


@pytest.mark.parametrize('names, rivals, outcome, surplus', [
    (['coulomb_friction'], (), RIGHT, False),
    (['presliding_friction', 'stribeck_friction'], (), RIGHT, False),
    (['bouc_wen_hysteresis'], ('coulomb_friction',), RIGHT, False),
    (['coulomb_friction', 'force_lag'], (), RIGHT, True),
    (['force_lag', 'coulomb_friction'], (), WRONG, False),
    (['force_bias', 'coulomb_friction'], (), RIGHT, False),
    (['coulomb_friction', 'contact_offset'], (), RIGHT, False),
    (['force_bias'], (), SILENT, False),
    ([], (), SILENT, False),
])
def test_on_a_rig_the_family_of_the_first_name_decides(
    names: list[str], rivals: tuple[str, ...], outcome: str, surplus: bool
) -> None:
    one = scored(LUGRE, answer(*names, rivals=rivals))
    assert (one.outcome, one.surplus, one.kind) == (outcome, surplus, 'foreign')


def test_true_name_counts_first_or_among_the_alternatives_of_the_first() -> None:
    told = truth('coulomb_friction')
    right = scored(told, answer('coulomb_friction'))
    rival = scored(told, answer('stribeck_friction', rivals=('coulomb_friction',)))
    second = scored(told, answer('cubic_stiffness', 'coulomb_friction'))
    relative = scored(told, answer('stribeck_friction'))
    assert [s.outcome for s in (right, rival, second, relative)] == [RIGHT, RIGHT, WRONG, WRONG]
    assert scored(told, answer('coulomb_friction', 'force_bias')).surplus


@pytest.mark.parametrize('said, outcome', [
    (answer(), SILENT), (answer(verdict='consistent'), SILENT), (answer('force_bias'), WRONG),
    (answer(verdict='unexplained'), WRONG),
])
def test_any_name_or_accusation_in_a_clean_world_is_a_false_alarm(
    said: dict[str, Any], outcome: str
) -> None:
    clean = scored(truth(), said)
    assert (clean.kind, clean.outcome, clean.is_miss) == ('clean', outcome, outcome == WRONG)


def test_parameter_errors_are_relative_to_the_distance_from_no_effect() -> None:
    told = truth('power_law_stiffness', parameters={'n': 1.2, 'K_n': 900.0})
    said = answer('power_law_stiffness', parameters={'n': 1.17, 'K_n': 945.0})
    assert scored(told, said).parameter_errors == pytest.approx({'n': 15.0, 'K_n': 5.0})


def test_the_table_counts_each_kind_by_itself() -> None:
    told = truth('force_bias', parameters={'bias': 2.0})
    scores = [
        scored(told, answer('force_bias', parameters={'bias': bias})) for bias in (2.1, 2.2, 3.0)
    ] + [scored(told, answer('force_drift')), scored(truth(), answer())]
    lines = [line.split() for line in as_text(scores, '').splitlines()]
    assert [*'75 of 4'.split()] in [line[-3:] for line in lines]
    assert '10 of 3'.split() in [line[-3:] for line in lines if line[:3] == [
        'median', 'parameter', 'error']]
    assert '0 of 1'.split() in [line[-3:] for line in lines if line[:2] == ['false', 'alarms']]
