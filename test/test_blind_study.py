# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Studies of blind_trials: files of a trial, separation of the truth, resuming."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from blind_worlds import answer, short_trial, truth
from contact_estimation.diagnosis.fit.constants import Constants
from contact_estimation.parameter_files import read_parameter_file
from contact_estimation.physics import EFFECTS
from contact_estimation.studies.blind_trials import command as study
from contact_estimation.studies.blind_trials.command import (
    diagnose_command, main, plan_study, PlannedTrial, run_trial)
from contact_estimation.studies.blind_trials.trial import TrialFiles, write_json, write_trial
import numpy as np
import pytest

PLANNED = PlannedTrial('trial_x', 'force_bias', (0, 0, 0))


@pytest.fixture(scope='module')
def files(tmp_path_factory: pytest.TempPathFactory) -> TrialFiles:
    """Write the files of a short trial."""
    paths = TrialFiles.of(tmp_path_factory.mktemp('study'), 'trial_x')
    write_trial(short_trial('force_bias', bias=2.0), paths, np.random.default_rng(0))
    return paths


def done(folder: Path, planned: PlannedTrial, said: dict[str, Any]) -> TrialFiles:
    """Write the files of a finished trial."""
    files = TrialFiles.of(folder, planned.name)
    told = truth(planned.effect) if planned.effect else truth()
    write_json(files.truth, told)
    write_json(files.report, said)
    return files


def test_the_diagnosis_command_does_not_contain_the_truth(files: TrialFiles) -> None:
    words = diagnose_command(files.recording, files.nominal, Path('out.json'))
    assert not any('truth' in word or files.truth.parent.name in word for word in words)
    assert files.truth.parent not in (files.recording.parent, files.nominal.parent)


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
    monkeypatch.setattr(study, 'draw_trial', lambda *_: calls.append('draw'))
    monkeypatch.setattr(study, 'write_trial', lambda *_: calls.append('write'))
    monkeypatch.setattr(study, 'diagnose_blind', lambda _: calls.append('diagnose'))
    run_trial(tmp_path, PLANNED)
    assert calls == ['draw', 'write', 'diagnose']
    calls.clear()
    files = done(tmp_path, PLANNED, answer('force_bias'))
    run_trial(tmp_path, PLANNED)
    assert calls == []
    files.report.unlink()
    run_trial(tmp_path, PLANNED)
    assert calls == ['diagnose']


def test_a_finished_study_of_rigs_is_scored_by_family(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (planned,) = plan_study(0, 0, 0, foreign=1)
    files = TrialFiles.of(tmp_path, planned.name)
    told = {'law': planned.effect, 'port': 'contact', 'families': ['friction'], 'unknown': None,
            'stage': 'press', 'concealed': 3.0}
    write_json(files.truth, told)
    write_json(files.report, answer('coulomb_friction'))
    target = tmp_path / 'scores.json'
    words = ['--count', '0', '--foreign', '1', '--output', str(tmp_path), '--json', str(target)]
    assert main(words) == 0
    assert 'right family first, no surplus name [%]' in capsys.readouterr().out
    assert json.loads(target.read_text())['kinds'] == {'foreign': {
        'trials': 1, 'right': 1, 'wrong': 0, 'silent': 0, 'failed': 0, 'surplus': 0}}


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
    assert (tmp_path / 'study' / 'reliability.png').stat().st_size > 1000
    assert (tmp_path / 'study' / 'table.txt').exists()


@pytest.mark.parametrize('words, message', [
    (['--count', '0'], 'all 0'), (['--count', '-1'], '--count must be >= 0, got -1'),
    (['--count', '0', '--unknown', '-1'], '--unknown must be >= 0'),
    (['--count', '1', '--jobs', '0'], '--jobs must be >= 1'),
])
def test_the_command_refuses_invalid_counts(
    words: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(words) == 1
    assert message in capsys.readouterr().err
