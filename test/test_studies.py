# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The studies: their help, reproduction of the paper, on-line worlds and calibration."""

import json
from pathlib import Path
from typing import Any, Callable

from contact_estimation.diagnosis.fit.beam import Compared
from contact_estimation.diagnosis.fit.constants import CONSTANTS
from contact_estimation.diagnosis.fit.evidence import Evidence, Scored
from contact_estimation.studies import reproduce as table_module
from contact_estimation.studies.__main__ import main as studies, STUDIES
from contact_estimation.studies.blind_trials import calibration as calibration_module
from contact_estimation.studies.blind_trials.calibration import calibrate, JudgedTrial, loss
from contact_estimation.studies.online_study import as_markdown, scored as scored_world, summary
from contact_estimation.studies.paper_cases import ALL_CASES, BEST, Case, Errors, PAPER, STEP
from contact_estimation.studies.reproduce import main, row_of
import numpy as np
import pytest


@pytest.mark.parametrize('name', STUDIES)
def test_every_study_has_a_help(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit, match='0'):
        studies([name, '--help'])
    assert len(capsys.readouterr().out) > 200


@pytest.mark.parametrize('estimator', ['multiple_model', 'kalman'])
def test_estimators_find_the_stiffness_of_a_world(estimator: str) -> None:
    score = scored_world(estimator, 'end_of_contact_as_told', 0, 0)
    assert abs(score.K_error) < 0.01
    assert '| touch | 1 | 1 of 1 |' in as_markdown([summary('touch', [score])])


KEYS = {
    'case', 'estimator', 'law', 'seeds', 'stiffness_error_percent', 'damping_error_percent',
    'stiffness_bound_percent', 'damping_bound_percent', 'paper_stiffness_error_percent',
    'paper_damping_error_percent'}


def case(name: str, estimator: str) -> Case:
    """Find a case."""
    return next(c for c in ALL_CASES if (c.case, c.estimator) == (name, estimator))


def test_every_error_printed_in_the_paper_has_a_row() -> None:
    assert set(PAPER) <= {(c.case, c.estimator) for c in ALL_CASES}


def test_row_has_the_documented_keys_and_the_median_of_absolute_errors() -> None:
    errors = [Errors(-1.0, 2.0, 0.1, 0.2), Errors(3.0, -4.0, 0.1, 0.2), Errors(2.0, 1.0, 0.1, 0.2)]
    row = row_of(ALL_CASES[0], errors)
    assert KEYS <= set(row)
    assert (row['stiffness_error_percent'], row['damping_error_percent']) == (2.0, 2.0)


@pytest.mark.slow
@pytest.mark.parametrize('name', ['simulation_sine', 'simulation_none', 'simulation_prbs'])
def test_best_estimator_is_within_four_bounds(name: str) -> None:
    errors = case(name, BEST).run(11)
    assert abs(errors.stiffness) < 4.0 * errors.stiffness_bound
    assert abs(errors.damping) < 4.0 * errors.damping_bound


def once_for_each_law(simulate: Callable[..., Any]) -> Callable[..., Any]:
    """Keep the first run of each law in each world."""
    runs: dict[tuple[bool, str], Any] = {}

    def kept(case: Case, seed: int) -> Any:
        key = case.on_testbed, case.law
        if key not in runs:
            runs[key] = simulate(case, seed)
        return runs[key]

    return kept


@pytest.mark.slow
def test_command_writes_table_and_figures(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    # The tests above, and those of the testbed, run the cases; here one run stands for a law.
    cases = [c for c in ALL_CASES if c.case == 'simulation_prbs' or c.law == STEP]
    monkeypatch.setattr(table_module, 'ALL_CASES', cases)
    monkeypatch.setattr(Case, 'simulate', once_for_each_law(Case.simulate))
    table, figures = tmp_path / 'table.json', tmp_path / 'figures'
    assert main(['--seeds', '1', '--json', str(table), '--output', str(figures)]) == 0
    assert len(json.loads(table.read_text())['cases']) == len(cases) == 9
    assert len(list(figures.glob('figure_*.png'))) == 13
    assert 'signal_processing_refined' in capsys.readouterr().out


def within_a_factor_of_two(error: float, paper: float) -> bool:
    """Compare sizes."""
    return 0.5 * paper <= abs(error) <= 2.0 * paper


@pytest.mark.slow
@pytest.mark.parametrize('name, estimator', [
    ('testbed_sine', 'indirect_adaptive'), ('testbed_none', 'rls')])
def test_plain_algorithm_errs_as_in_the_paper(name: str, estimator: str) -> None:
    errors = case(name, estimator).run(0)
    assert within_a_factor_of_two(errors.stiffness, PAPER[name, estimator].stiffness)
    assert within_a_factor_of_two(errors.damping, PAPER[name, estimator].damping)


@pytest.mark.slow
@pytest.mark.parametrize('name, stiffness, damping', [
    ('testbed_sine', 1.0, 5.0), ('testbed_none', 2.0, 10.0), ('testbed_prbs', 1.0, 5.0)])
def test_best_estimator_is_accurate_on_the_testbed(
    name: str, stiffness: float, damping: float
) -> None:
    errors = case(name, BEST).run(12)
    assert abs(errors.stiffness) < stiffness
    assert abs(errors.damping) < damping


PARTS = 6


def scored(left: float, *effects: str) -> Scored:
    """Make a model that leaves so much, in squares of noise, of every part."""
    squares = np.column_stack((np.full(PARTS, left), np.ones(PARTS)))
    return Scored(effects, tuple(f'family of {one}' for one in effects), (len(effects), effects),
                  squares, squares, np.full((PARTS, 2), 50.0), len(effects), len(effects), 0)


def trial(right: frozenset[str], before: float, **after: float) -> JudgedTrial:
    """Judge models that each leave so much, against the base."""
    base = scored(before)
    models = [base, *(scored(left, name) for name, left in after.items())]
    evidence = Evidence(base, np.zeros(2), np.ones(2)).informed_by(models)
    return JudgedTrial(Compared(evidence, evidence.ranked(models)), right)


FRICTION = frozenset({'coulomb_friction', 'stribeck_friction'})
TRIALS = [
    *(trial(frozenset(), before, cubic_stiffness=0.7 * before) for before in (20.0, 60.0, 90.0)),
    *(trial(FRICTION, before, coulomb_friction=0.05 * before, cubic_stiffness=0.3 * before)
      for before in (40.0, 100.0, 200.0)),
]


def test_loss_is_the_logarithmic_score_of_the_truth() -> None:
    for one in TRIALS:
        weights = one.compared.evidence.weights(one.compared.models, 0)
        of_right = sum(float(weight) for weight, model in zip(weights, one.compared.models)
                       if (model.key & FRICTION if one.effects else not model.effects))
        assert loss([one], CONSTANTS) == pytest.approx(-np.log(max(of_right, 0.02)))
    assert loss(TRIALS, CONSTANTS) == pytest.approx(
        np.mean([loss([one], CONSTANTS) for one in TRIALS]))


@pytest.mark.parametrize('wrong', [{'law': 0.3, 'parameter': 0.3}, {'temperature': 3.0}])
def test_wrong_constants_are_corrected(
    monkeypatch: pytest.MonkeyPatch, wrong: dict[str, float]
) -> None:
    start = CONSTANTS._replace(**wrong)
    monkeypatch.setattr(calibration_module, 'CONSTANTS', start)
    found = calibrate(TRIALS)
    assert found.trials == len(TRIALS)
    assert found.before == pytest.approx(loss(TRIALS, start))
    assert found.after == pytest.approx(loss(TRIALS, found.constants))
    assert found.after < 0.8 * found.before
    if 'law' in wrong:
        assert found.constants.law + found.constants.parameter > start.law + start.parameter
    else:
        assert found.constants.temperature < start.temperature
