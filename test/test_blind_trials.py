# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Blind trials: worlds, rigs, scores and studies."""

import json
from pathlib import Path
from typing import Any

from contact_estimation.diagnosis.fit.constants import Constants
from contact_estimation.parameter_files import read_parameter_file
from contact_estimation.physics import EFFECTS
from contact_estimation.physics.prior import Scales
from contact_estimation.plant.plant_parameters import RobotParameters, WallParameters
from contact_estimation.reference.experiment import Experiment, Segment
from contact_estimation.scheduling import Finished
from contact_estimation.studies.blind_trials import running
from contact_estimation.studies.blind_trials.command import (
    main, plan_effects, plan_study, PlannedTrial)
from contact_estimation.studies.blind_trials.concealment import residual
from contact_estimation.studies.blind_trials.running import run_trial, TrialFiles, write_json
from contact_estimation.studies.blind_trials.scoring import (
    as_text, RIGHT, Score, score, SILENT, WRONG)
from contact_estimation.studies.blind_trials.settings import EFFECTS_OF_A_WALL, IDEAL, RIGS
from contact_estimation.studies.blind_trials.trial import Trial, write_trial
from contact_estimation.studies.blind_trials.world import Run, SensorModel, World
import numpy as np
from numpy.typing import NDArray
import pytest

Array = NDArray[np.float64]

WALL = WallParameters(stiffness=4000.0, damping=100.0)
ROBOT = RobotParameters(mass=20.0, damping=600.0, stiffness=4000.0)
EXPERIMENT = Experiment('short', -0.01, (
    Segment(0.3, -0.01), Segment(0.5, 0.03), Segment(0.6, 0.03), Segment(0.4, 0.02),
    Segment(0.5, 0.02), Segment(0.5, -0.01), Segment(0.3, -0.01),
))
WORLD = World('short', WALL, ROBOT, SensorModel(), EXPERIMENT, 0.015)


def short_trial(effect: str = '', **values: float) -> Trial:
    """Return a trial of three seconds."""
    nominal = WallParameters(stiffness=4400.0, damping=80.0)
    return Trial(IDEAL, WORLD, effect, values, nominal, 1.0)


def synthetic_run(sensed: Array | None = None, count: int = 4000) -> Run:
    """Return sines in and out of the wall, with the force of a spring-damper."""
    t = np.arange(count) / 500.0
    d = 0.01 * np.sin(3.0 * t) + 0.004 * np.sin(11.0 * t)
    v = 0.03 * np.cos(3.0 * t) + 0.044 * np.cos(11.0 * t)
    force = np.where(d > 0.0, np.minimum(0.0, -4000.0 * d - 100.0 * v), 0.0)
    still = np.zeros(count)
    return Run(t, d, v, force, force if sensed is None else sensed, still, still, still)


def truth(effect: str = '', port: str = 'contact', **changes: Any) -> dict[str, Any]:
    """Return the content of a truth file."""
    return {
        'kind': 'library' if effect else 'clean', 'law': effect, 'port': port,
        'families': [EFFECTS[effect].family] if effect else [],
        'acceptable_names': [effect] if effect else [], 'parameters': {}, 'intervals_s': None,
        'stiffness': 4000.0, 'damping': 100.0, 'concealed': 2.0, 'stage': 'rich', **changes}


def answer(*names: str, rivals: tuple[str, ...] = (), **changes: Any) -> dict[str, Any]:
    """Return the content of a report file."""
    parameters = changes.pop('parameters', {})
    effects = [{'name': name, 'probability': 0.95, 'indistinguishable_from': [],
                'parameters': {key: {'value': value} for key, value in parameters.items()}}
               for name in names]
    if effects:
        effects[0]['indistinguishable_from'] = list(rivals)
    report = {
        'verdict': 'physics_missing' if names else 'recalibrate', 'effects': effects,
        'corrected': {'stiffness': {'value': 4020.0}, 'damping': {'value': 98.0}}, **changes}
    return {'report': report, 'error': '', 'seconds': 1.0}


SCALES = Scales(0.02, 0.1, 80.0, 150.0, 0.0, 15.0, 4000.0, 100.0, 20.0)


def rms_of(in_motion: bool, world: World, run: Run) -> float:
    """Return the RMS residual of the contact, or that in the motion of the robot."""
    return float(np.sqrt(np.nanmean(residual(in_motion, world, run) ** 2)))


# -- random draws ---------------------------------------------------------------------------


def test_a_plan_has_every_effect_once_before_any_comes_twice() -> None:
    count = len(EFFECTS_OF_A_WALL)
    effects = plan_effects(2 * count, 5)
    assert sorted(effects[:count]) == sorted(effects[count:]) == sorted(EFFECTS_OF_A_WALL)
    assert plan_effects(7, 5) == effects[:7]


def test_parameters_move_away_from_neutral_as_the_strength_grows() -> None:
    for name in EFFECTS:
        strength = EFFECTS[name].draw(SCALES, np.random.default_rng(1))
        neutral = EFFECTS[name].neutral()

        def distance(s: float) -> float:
            values = strength(s)
            if 'limit' in values:
                return max(SCALES.force, SCALES.control) - values['limit']
            return sum(abs(v - neutral.get(k, 0.0)) for k, v in values.items() if k != 'K_n')

        assert distance(0.2) < distance(0.4), name
        assert EFFECTS[name](**strength(0.3)).is_possible(SCALES.stiffness, SCALES.damping), name


# -- concealment ----------------------------------------------------------------------------


def test_contact_residual_matches_the_normal_equations() -> None:
    run = synthetic_run()
    extra = np.where(run.force < 0.0, -0.7 * np.tanh(run.v / 4e-4), 0.0)
    on = (run.force < 0.0) & (run.x > 0.0)
    touching = run.x > 0.0
    A = np.column_stack((run.x, run.v))[on]
    K, B = np.linalg.solve(A.T @ A, -A.T @ (run.force + extra)[on])
    predicted = np.minimum(0.0, -K * run.x - B * run.v)[touching]
    rms = float(np.sqrt(np.mean(((run.force + extra)[touching] - predicted) ** 2)))
    assert rms_of(False, WORLD, synthetic_run(run.force + extra)) == pytest.approx(rms)


def test_the_simulators_of_both_settings_agree_where_neither_adds_anything() -> None:
    plant, rig = IDEAL.simulate(WORLD, '', {}), RIGS.simulate(WORLD, '', {})
    x, force = (np.interp(plant.t, rig.t, signal) for signal in (rig.x, rig.force))
    assert np.max(np.abs(x - plant.x)) < 1e-3 * WORLD.depth
    assert np.max(np.abs(force - plant.force)) < 1e-3 * np.max(np.abs(plant.force))


# -- plan and files ---------------------------------------------------------------------------


@pytest.mark.slow
def test_only_write_leaves_recordings_and_truths(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ['--count', '0', '--foreign', '1', '--unknown', '1', '--seed', '5', '--only-write',
             '--output', str(tmp_path)]
    assert main(words) == 0
    assert 'wrote 2 trials' in capsys.readouterr().out
    recordings = sorted(path.stem for path in (tmp_path / 'handed_over').glob('*.mcap'))
    truths = sorted(path.name for path in (tmp_path / 'sealed').glob('*.truth.json'))
    assert truths == [f'{name}.truth.json' for name in recordings]
    assert not (tmp_path / 'reports').exists()
    first = (tmp_path / 'sealed' / truths[0]).read_text()
    assert main([*words[:-1], str(tmp_path / 'again')]) == 0
    assert (tmp_path / 'again' / 'sealed' / truths[0]).read_text() == first


LUGRE = {**truth(), 'kind': 'foreign', 'law': 'lugre_friction', 'families': ['friction'],
         'acceptable_names': [name for name, cls in EFFECTS.items() if cls.family == 'friction']}


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
    ([], (), SILENT, False)])
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
    (answer(verdict='unexplained'), WRONG)])
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


PLANNED = PlannedTrial('trial_x', 'force_bias', (0, 0, 0))


@pytest.fixture(scope='module')
def files(tmp_path_factory: pytest.TempPathFactory) -> TrialFiles:
    """Write the files of a short trial."""
    paths = TrialFiles.of(tmp_path_factory.mktemp('study'), 'trial_x')
    paths.recording.parent.mkdir()
    write_json(paths.truth, write_trial(
        short_trial('force_bias', bias=2.0), paths, np.random.default_rng(0)))
    return paths


def test_the_diagnosis_command_does_not_contain_the_truth(
    files: TrialFiles, monkeypatch: pytest.MonkeyPatch
) -> None:
    said: list[str] = []

    def refused(words: list[str], timeout_s: float) -> Finished:
        said.extend(words)
        return Finished(1.0, 1.0, 'refused')

    monkeypatch.setattr(running, 'finished', refused)
    run_trial(files.truth.parents[1], PLANNED)
    assert str(files.recording) in said
    assert not any('truth' in word or files.truth.parent.name in word for word in said)
    assert files.truth.parent not in (files.recording.parent, files.nominal.parent)
    assert json.loads(files.report.read_text())['error'] == 'refused'
    files.report.unlink()


def test_neither_name_nor_model_file_reveals_the_effect(files: TrialFiles) -> None:
    names = {planned.name for planned in plan_study(30, 10, 3)}
    assert len(names) == 40
    assert not any(effect in name for name in names for effect in EFFECTS)
    assert {len(name) for name in names} == {len('trial_') + 8}
    assert 'physics' not in files.nominal.read_text()
    assert read_parameter_file(str(files.nominal), 'plant_node') == {
        'environment.stiffness': 4400.0, 'environment.damping': 80.0,
        'environment.location': 0.0, 'robot.mass': 20.0, 'robot.damping': 600.0,
        'robot.stiffness': 4000.0,
    }


def test_finished_steps_of_a_trial_are_not_repeated(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    calls: list[str] = []

    def write(planned: PlannedTrial, files: TrialFiles) -> dict[str, Any]:
        calls.append('write')
        return truth()

    def refused(words: list[str], timeout_s: float) -> Finished:
        calls.append('diagnose')
        return Finished(1.0, 1.0, 'refused')

    monkeypatch.setattr(PlannedTrial, 'write', write)
    monkeypatch.setattr(running, 'finished', refused)
    run_trial(tmp_path, PLANNED)
    assert calls == ['write', 'diagnose']
    calls.clear()
    run_trial(tmp_path, PLANNED)
    assert calls == []
    PLANNED.files(tmp_path).report.unlink()
    run_trial(tmp_path, PLANNED)
    assert calls == ['diagnose']


def test_a_finished_study_of_rigs_is_scored_by_family(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (planned,) = plan_study(0, 0, 0, foreign=1)
    files = TrialFiles.of(tmp_path, planned.name)
    write_json(files.truth, LUGRE)
    write_json(files.report, answer('coulomb_friction'))
    target = tmp_path / 'scores.json'
    words = ['--count', '0', '--foreign', '1', '--output', str(tmp_path), '--json', str(target)]
    assert main(words) == 0
    assert 'right family first, no surplus name [%]' in capsys.readouterr().out
    assert json.loads(target.read_text())['kinds'] == {'foreign': {
        'trials': 1, 'right': 1, 'wrong': 0, 'silent': 0, 'failed': 0, 'surplus': 0}}


def test_trials_of_another_version_are_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (planned,) = plan_study(0, 1, 0)
    files = TrialFiles.of(tmp_path, planned.name)
    write_json(files.truth, {'effects': []})
    write_json(files.report, answer())
    assert main(['--clean', '1', '--output', str(tmp_path)]) == 1
    assert 'must hold trials of this version' in capsys.readouterr().err


@pytest.mark.slow
def test_the_command_draws_diagnoses_and_scores_trials(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    target, constants = tmp_path / 'scores.json', tmp_path / 'constants.json'
    words = ['--count', '0', '--clean', '1', '--seed', '3', '--output', str(tmp_path / 'study'),
             '--json', str(target), '--calibrate', str(constants)]
    assert main(words) == 0
    said = capsys.readouterr().out
    assert 'clean: nothing missing' in said and 'constants of the decision' in said
    assert set(json.loads(constants.read_text())) == set(Constants._fields)
    told = json.loads(target.read_text())
    assert (told['kinds']['clean']['trials'], told['seed']) == (1, 3)
    assert told['trials'][0]['error'] == ''
    assert (tmp_path / 'study' / 'table.txt').exists()


@pytest.mark.parametrize('words, message', [
    (['--count', '0'], 'all 0'), (['--count', '-1'], '--count must be >= 0, got -1'),
    (['--count', '0', '--unknown', '-1'], '--unknown must be >= 0'),
    (['--count', '1', '--jobs', '0'], '--jobs must be >= 1')])
def test_the_command_refuses_invalid_counts(
    words: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(words) == 1
    assert message in capsys.readouterr().err
