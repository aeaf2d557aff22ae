# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The command diagnose: what it writes, and one line on stderr for unusable input."""

import json
from pathlib import Path
import re
from typing import Any

import contact_estimation as ce
from contact_estimation.commands import diagnose
from contact_estimation.diagnosis.observe.signals import Signals
from contact_estimation.reference.experiment import Experiment, Segment
from contact_estimation.reference.experiments import experiment_named
from diagnosed_worlds import recorded, with_unknown_force, write_model, write_recording
import numpy as np
import pytest
from run_commands import Command


@pytest.fixture
def command(capfd: pytest.CaptureFixture[str]) -> Command:
    return Command('diagnose', diagnose.main, capfd)


@pytest.fixture(scope='module')
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Hold a model and recordings."""
    folder = tmp_path_factory.mktemp('diagnose')
    write_model(folder / 'model.yaml')
    write_recording(folder / 'clean.mcap', recorded())
    write_recording(folder / 'unknown.mcap', with_unknown_force(recorded()))
    resting = Experiment('free', -0.02, (Segment(1.0, -0.02), Segment(2.0, -0.01)))
    write_recording(folder / 'free.mcap', recorded(resting))
    return folder


def first(signals: Signals, duration: float) -> Signals:
    """Cut signals off."""
    keep = signals.wrench_t < duration
    return Signals(*(part[..., keep] for part in signals))


@pytest.mark.slow
def test_unexplained_recording_writes_all_files(
    folder: Path, tmp_path: Path, command: Command
) -> None:
    pytest.importorskip('matplotlib')
    names = {'--json': 'r.json', '--html': 'r.html', '--write-model': 'm.yaml'}
    options = [part for option, name in names.items() for part in (option, tmp_path / name)]
    ended = command(folder / 'unknown.mcap', '--nominal', folder / 'model.yaml', *options)
    assert ended.code == 0 and ended.out.startswith('unexplained: ')
    report = json.loads((tmp_path / 'r.json').read_text())
    assert report['verdict'] == 'unexplained'
    file = tmp_path / 'r.experiment.yaml'
    assert report['next_experiment']['file'] == str(file)
    assert experiment_named(str(file)).duration > 5.0
    page = (tmp_path / 'r.html').read_text(encoding='utf-8')
    assert 'unknown.mcap' in page and str(file) in page
    assert ce.read_model(tmp_path / 'm.yaml').environment.stiffness > 0.0


@pytest.mark.slow
def test_recording_without_reference_is_diagnosed_in_contact_alone(
    folder: Path, tmp_path: Path, command: Command
) -> None:
    path = tmp_path / 'r.json'
    signals = recorded(physics__coulomb_friction__F_c=2.0)
    recording = write_recording(tmp_path / 'a.mcap', signals, with_reference=False)
    ended = command(recording, '--nominal', folder / 'model.yaml', '--json', path)
    assert ended.code == 0
    report = json.loads(path.read_text())
    assert report['verdict'] == 'physics_missing'
    assert {effect['port'] for effect in report['effects']} <= {'contact', 'force_sensor'}
    assert report['fit']['motion_rmse_m'] is None


BAD_SIGNALS: dict[str, tuple[Any, str]] = {
    'constant force': (lambda s: s._replace(force=np.full(len(s.force), -3.0)),
                       r'wrench is constant at -3, expected a signal that changes'),
    'constant position': (lambda s: s._replace(position=np.full(len(s.position), 0.01)),
                          r'joint_states is constant at 0.01, expected a signal'),
    'few samples': (lambda s: first(s, 0.1), r'wrench must have at least 50 .* stamps, got 25'),
    'no force is finite': (lambda s: s._replace(force=np.full(len(s.force), np.nan)),
                           r'no usable message on wrench in .*: expected finite values'),
}


@pytest.mark.parametrize('name', BAD_SIGNALS)
def test_signals_without_information_are_refused_in_one_line(
    name: str, folder: Path, tmp_path: Path, command: Command
) -> None:
    change, _ = BAD_SIGNALS[name]
    recording = write_recording(tmp_path / 'bad.mcap', change(recorded()))
    assert re.search(BAD_SIGNALS[name][1],
                     command.refusal(recording, '--nominal', folder / 'model.yaml'))


def test_a_force_along_another_axis_is_named(folder: Path, command: Command) -> None:
    line = command.refusal(
        folder / 'clean.mcap', '--nominal', folder / 'model.yaml', '--axis', 'y')
    assert 'is constant along y, but changes along x; set axis (--axis)' in line


def test_missing_options_and_files_are_refused(
    folder: Path, tmp_path: Path, command: Command
) -> None:
    clean, model = folder / 'clean.mcap', folder / 'model.yaml'
    assert '--nominal' in command.refusal(clean)
    assert 'cannot be read' in command.refusal(clean, '--nominal', tmp_path / 'no.yaml')
    assert 'no.mcap' in command.refusal(tmp_path / 'no.mcap', '--nominal', model)
    (tmp_path / 'other.yaml').write_text('estimator_node: {ros__parameters: {}}\n')
    line = command.refusal(clean, '--nominal', tmp_path / 'other.yaml')
    assert 'must have a section plant_node' in line
    assert 'seed must be >= 0' in command.refusal(clean, '--nominal', model, '--seed', -1)


def test_results_that_cannot_be_written_are_refused_before_the_work(
    folder: Path, tmp_path: Path, command: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(diagnose, 'diagnose', None)  # a call would be a traceback
    clean, model = folder / 'clean.mcap', folder / 'model.yaml'
    line = command.refusal(clean, '--nominal', model, '--json', tmp_path / 'no' / 'r.json')
    assert 'does not exist; make it first' in line
    line = command.refusal(clean, '--nominal', model, '--html', clean)
    assert 'recordings are never overwritten' in line
    same = tmp_path / 'r.json'
    line = command.refusal(clean, '--nominal', model, '--json', same, '--html', same)
    assert 'two results cannot both be written' in line


@pytest.mark.slow
def test_file_that_is_cut_short_is_diagnosed_and_told(
    folder: Path, tmp_path: Path, command: Command
) -> None:
    content, cut = (folder / 'clean.mcap').read_bytes(), tmp_path / 'cut.mcap'
    cut.write_bytes(content[:len(content) * 4 // 5])
    ended = command(cut, '--nominal', folder / 'model.yaml')
    assert ended.code == 0
    assert 'Check complete_file: the file is damaged: it ends within its data' in ended.out
    cut.write_bytes(content[:300])
    line = command.refusal(cut, '--nominal', folder / 'model.yaml')
    assert 'it ends before the first topic' in line
