# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Scores of reports against truths, and the metrics of a study."""

from __future__ import annotations

from typing import Any

from blind_worlds import answer, truth
from contact_estimation.studies.blind_trials.exact_scoring import metrics, Score, score
import pytest


def scored(truth: dict[str, Any], answer: dict[str, Any]) -> Score:
    return score('trial_1', truth, answer)


def metric(scores: list[Score], words: str) -> float | None:
    (found,) = [t for t in metrics(scores) if words in t.name]
    return found.value


def test_true_name_counts_first_or_among_the_alternatives_of_the_first() -> None:
    told = truth('coulomb_friction')
    right = scored(told, answer('coulomb_friction'))
    rival = scored(told, answer('stribeck_friction', rivals=('coulomb_friction',)))
    second = scored(told, answer('cubic_stiffness', 'coulomb_friction'))
    assert [s.found for s in (right, rival, second)] == [True, True, False]
    assert [s.found_alone for s in (right, rival, second)] == [True, False, False]
    assert [s.extra_names for s in (right, rival, second)] == [False, False, True]
    assert right.false_alarm is None


@pytest.mark.parametrize('said, false_alarm', [
    (answer(), False), (answer(verdict='consistent'), False), (answer('force_bias'), True),
    (answer(verdict='unexplained'), True),
])
def test_any_name_or_other_verdict_in_a_clean_world_is_a_false_alarm(
    said: dict[str, Any], false_alarm: bool
) -> None:
    clean = scored(truth(), said)
    assert (clean.false_alarm, clean.found, clean.extra_names) == (false_alarm, None, None)


def test_parameter_errors_are_relative_to_the_distance_from_no_effect() -> None:
    told = truth('power_law_stiffness', parameters={'n': 1.2, 'K_n': 900.0})
    said = answer('power_law_stiffness', parameters={'n': 1.17, 'K_n': 945.0})
    assert scored(told, said).parameter_errors == pytest.approx({'n': 15.0, 'K_n': 5.0})


@pytest.mark.parametrize('told, corrected, right', [
    (truth(), {'stiffness': {'value': 1.0}, 'damping': {'value': 2.0}}, True),
    (truth(stiffness=None), {'stiffness': {'value': None}, 'damping': {'value': 2.0}}, True),
    (truth(stiffness=None), {'stiffness': {'value': 1.0}, 'damping': {'value': 2.0}}, False),
    (truth(damping=0.0), {'stiffness': {'value': 1.0}, 'damping': {'value': 0.0}}, True),
    (truth(damping=0.0), {'stiffness': {'value': 1.0}, 'damping': {'value': 2.0}}, False),
])
def test_stiffness_and_damping_must_be_given_exactly_where_the_truth_has_them(
    told: dict[str, Any], corrected: dict[str, Any], right: bool
) -> None:
    assert scored(told, answer(corrected=corrected)).base_right is right


def test_metrics_cover_the_trials_to_which_they_apply() -> None:
    told = truth('force_bias', parameters={'bias': 2.0})
    scores = [
        scored(told, answer('force_bias', parameters={'bias': bias})) for bias in (2.1, 2.2, 3.0)
    ] + [scored(told, answer('force_drift')), scored(truth(), answer())]
    assert metric(scores, 'first or among') == 75.0
    assert metric(scores, 'false alarms') == 0.0
    assert metric(scores, 'parameter error') == pytest.approx(10.0)
    met = {t.name: t.met for t in metrics(scores)}
    assert met['true name first or among its alternatives [%]'] is False
    assert met['false alarms in clean worlds [%]'] is True
