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

"""Reports held against truths, and studies summed up."""

from __future__ import annotations

from typing import Any

from blind_setups import answer, truth
from contact_estimation.blind_trials.scoring import Score, score
from contact_estimation.blind_trials.table import as_text
from contact_estimation.blind_trials.totals import confusion, groups, totals
import pytest

FAILED = {'report': None, 'error': 'diagnose: no contact', 'seconds': 0.1}


def scored(told: dict[str, Any], said: dict[str, Any]) -> Score:
    return score('trial_1', told, said)


def total(scores: list[Score], words: str) -> float | None:
    (found,) = [t for t in totals(scores) if words in t.name]
    return found.value


def test_a_name_counts_first_or_among_the_rivals_of_the_first() -> None:
    told = truth('coulomb_friction')
    right = scored(told, answer('coulomb_friction'))
    rival = scored(told, answer('stribeck_friction', rivals=('coulomb_friction',)))
    second = scored(told, answer('cubic_stiffness', 'coulomb_friction'))
    assert [s.named for s in (right, rival, second)] == [True, True, False]
    assert [s.alone for s in (right, rival, second)] == [True, False, False]
    assert [s.surplus for s in (right, rival, second)] == [False, False, True]
    assert right.accused is None


def test_a_name_with_rivals_does_not_stand_alone() -> None:
    said = answer('coulomb_friction', rivals=('stribeck_friction',))
    assert scored(truth('coulomb_friction'), said).alone is False


@pytest.mark.parametrize('said, accused', [
    (answer(), False), (answer(verdict='consistent'), False), (answer('force_bias'), True),
    (answer(verdict='unexplained'), True),
])
def test_a_clean_world_is_accused_by_any_name_or_other_verdict(
    said: dict[str, Any], accused: bool
) -> None:
    clean = scored(truth(), said)
    assert (clean.accused, clean.named, clean.surplus) == (accused, None, None)


def test_parameters_are_held_against_the_departure_from_no_effect() -> None:
    told = truth('power_law_stiffness', parameters={'n': 1.2, 'K_n': 900.0})
    said = answer('power_law_stiffness', parameters={'n': 1.17, 'K_n': 945.0})
    assert scored(told, said).parameter_errors == pytest.approx({'n': 15.0, 'K_n': 5.0})


def test_phase_gamma_and_a_scale_of_one_are_not_counted() -> None:
    moving = {'amplitude': 1e-4, 'frequency': 2.0, 'phase': 0.0}
    told = truth('moving_environment', parameters=moving)
    said = answer('moving_environment', parameters={**moving, 'phase': 1.0})
    assert set(scored(told, said).parameter_errors) == {'amplitude', 'frequency'}
    scales = {'K_t_scale': 0.8, 'B_t_scale': 1.1, 'M_t_scale': 1.0}
    told = truth('impedance_mismatch', 'robot', parameters=scales)
    said = answer('impedance_mismatch', parameters={**scales, 'K_t_scale': 0.9})
    errors = scored(told, said).parameter_errors
    assert errors == pytest.approx({'K_t_scale': 50.0, 'B_t_scale': 0.0})


def test_a_wrong_name_has_no_parameter_errors() -> None:
    told = truth('force_bias', parameters={'bias': 2.0})
    assert scored(told, answer('force_drift', parameters={'rate': 1.0})).parameter_errors == {}


def test_errors_are_those_of_the_corrected_model() -> None:
    one = scored(truth(), answer())
    assert one.stiffness_error == pytest.approx(0.5)
    assert one.damping_error == pytest.approx(-2.0)
    assert one.force_ratio == pytest.approx(1.1)
    assert one.floor_error == pytest.approx(5.0)


@pytest.mark.parametrize('told, corrected, right', [
    (truth(), {'stiffness': {'value': 1.0}, 'damping': {'value': 2.0}}, True),
    (truth(stiffness=None), {'stiffness': {'value': None}, 'damping': {'value': 2.0}}, True),
    (truth(stiffness=None), {'stiffness': {'value': 1.0}, 'damping': {'value': 2.0}}, False),
    (truth(damping=0.0), {'stiffness': {'value': 1.0}, 'damping': {'value': 0.0}}, True),
    (truth(damping=0.0), {'stiffness': {'value': 1.0}, 'damping': {'value': 2.0}}, False),
])
def test_a_wall_without_spring_or_damper_must_be_told_so(
    told: dict[str, Any], corrected: dict[str, Any], right: bool
) -> None:
    assert scored(told, answer(corrected=corrected)).base_right is right


def test_a_right_name_beside_an_unexplained_rest_is_no_right_verdict() -> None:
    told = truth('force_bias')
    assert scored(told, answer('force_bias')).verdict_right
    unsure = scored(told, answer('force_bias', verdict='unexplained'))
    assert (unsure.named, unsure.alone, unsure.verdict_right) == (True, True, False)
    assert 'force_bias, unexplained' in as_text([unsure], 'DIR')
    assert total([unsure], 'verdict right') == 0.0


def test_a_command_that_failed_has_named_nothing() -> None:
    failed = scored(truth('force_lag', parameters={'tau': 0.01}), FAILED)
    assert (failed.named, failed.alone, failed.verdict) == (False, False, '')
    assert (failed.force_ratio, failed.floor_error, failed.base_right) == (None, None, False)
    assert scored(truth(), FAILED).accused is True


def test_shares_and_medians_are_over_the_trials_that_tell() -> None:
    told = truth('force_bias', parameters={'bias': 2.0})
    scores = [
        scored(told, answer('force_bias', parameters={'bias': bias})) for bias in (2.1, 2.2, 3.0)
    ] + [scored(told, answer('force_drift')), scored(truth(), answer())]
    assert total(scores, 'first or among') == 75.0
    assert total(scores, 'accused') == 0.0
    assert total(scores, 'parameter error') == pytest.approx(10.0)
    marks = {t.name: t.met for t in totals(scores)}
    assert marks['true name first or among its rivals [%]'] is False
    assert marks['clean worlds accused [%]'] is True


def test_the_confusion_counts_first_names_and_silence() -> None:
    told = truth('force_bias')
    scores = [scored(told, answer('force_bias')), scored(told, answer()), scored(told, FAILED),
              scored(told, answer(verdict='unexplained')), scored(truth(), answer())]
    assert confusion(scores) == {
        'force_bias': {'force_bias': 1, 'nothing': 1, 'failed': 1, 'unexplained': 1},
        'nothing': {'nothing': 1},
    }


def test_groups_are_by_effect_concealment_and_features() -> None:
    scores = [scored(truth('force_bias', concealed=r), answer('force_bias'))
              for r in (1.4, 2.0, 2.0, 60.0)]
    split = groups(scores)
    assert [len(part) for part in split['concealed'].values()] == [1, 2, 1]
    assert list(split['effect']) == ['force_bias']
    assert len(split['velocity']['not sent']) == 4


def test_the_table_lists_marks_and_misses() -> None:
    scores = [scored(truth('force_bias'), answer('force_drift', rivals=('force_lag',))),
              scored(truth(), FAILED)]
    text = as_text(scores, 'DIR/handed_over')
    assert 'at least 90  MISSED' in text
    assert 'force_bias concealed 2.00 times, rich; said force_drift (or force_lag)' in text
    assert 'clean; failed: diagnose: no contact' in text
