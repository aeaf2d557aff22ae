# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""`diagnose --nominal-robot`: what it writes, and one line on stderr for unusable input."""

import json
from pathlib import Path
from typing import Any

from arm_worlds import arm_recording, motion, URDF
from contact_estimation.commands import diagnose
from contact_estimation.kinematics.arm_dynamics import ArmDynamics
from contact_estimation.plant.arm_models import TIP
from contact_estimation.plant.arm_simulation import ArmLaw, SimulatedArm
from contact_estimation.plant.plant_parameters import read_model
from contact_estimation.studies.blind_trials import command as blind_trials
from contact_estimation.studies.blind_trials.arm_trials import scored, write_arm_recording
import numpy as np
import pytest
from run_commands import Command
import yaml


@pytest.fixture
def command(capfd: pytest.CaptureFixture[str]) -> Command:
    return Command('diagnose', diagnose.main, capfd)


@pytest.fixture(scope='module')
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Hold a description, and recordings of an arm with a heavy rotor."""
    folder = tmp_path_factory.mktemp('arm')
    (folder / 'arm.urdf').write_text(URDF)
    for seed in (1, 2):
        one = arm_recording([ArmLaw('reflected_inertia', [2.0], 0)], seed)
        write_arm_recording(folder / f'run_{seed}.mcap', one.joints,
                            SimulatedArm(one.t, one.q, one.v, one.tau))
    return folder


def test_it_writes_report_page_description_and_motion(
    folder: Path, tmp_path: Path, command: Command
) -> None:
    pytest.importorskip('matplotlib')
    names = {'--json': 'r.json', '--html': 'r.html', '--write-urdf': 'c.urdf',
             '--write-trajectory': 'm.csv'}
    options = [part for option, name in names.items() for part in (option, tmp_path / name)]
    ended = command(folder / 'run_1.mcap', '--nominal-robot', folder / 'arm.urdf', '--holdout',
                    folder / 'run_2.mcap', *options)
    assert ended.code == 0, ended.err
    assert ended.out.startswith('physics missing: the description lacks reflected inertia at')
    report = json.loads((tmp_path / 'r.json').read_text())
    first = report['effects'][0]
    assert (first['name'], first['joint']) == ('reflected_inertia', 'joint_1')
    assert first['parameters']['I_r']['value'] == pytest.approx(2.0, rel=0.1)
    held_out = report['fit']['holdouts'][0]
    assert held_out['share']['joint_1'] > 0.99 > held_out['share_nominal']['joint_1']
    assert 'run_1.mcap' in (tmp_path / 'r.html').read_text()
    assert 'armature="' in (tmp_path / 'c.mjcf').read_text()
    again = command(folder / 'run_2.mcap', '--nominal-robot', tmp_path / 'c.urdf')
    assert again.code == 0
    assert (tmp_path / 'm.csv').read_text().startswith('t,position.joint_1,')
    trajectory = yaml.safe_load((tmp_path / 'm.yaml').read_text())
    last = trajectory['points'][-1]
    assert trajectory['joint_names'] == ['joint_1', 'joint_2', 'joint_3']
    assert last['time_from_start'] == {'sec': 19, 'nanosec': 990000000}
    assert len(last['positions']) == len(last['velocities']) == 3


def test_a_payload_of_one_of_two_recordings_is_named_with_its_recording(
    folder: Path, command: Command
) -> None:
    body = [1.0, 0.1, 0.02, 0.05, 0.01, -0.002, 0.02, -0.005, -0.001, 0.02]
    one = arm_recording([ArmLaw('payload', body, 2), ArmLaw('reflected_inertia', [2.0], 0)], 2)
    write_arm_recording(folder / 'loaded.mcap', one.joints,
                        SimulatedArm(one.t, one.q, one.v, one.tau))
    ended = command(folder / 'run_1.mcap', folder / 'loaded.mcap', '--nominal-robot',
                    folder / 'arm.urdf', '--holdout', folder / 'run_2.mcap')
    assert ended.code == 0 and 'reflected_inertia at joint_1' in ended.out
    assert 'payload at link_3 in loaded.mcap' in ended.out
    held_out = ended.out[ended.out.index('not fitted'):]
    assert 'joint_1 9' in held_out or 'joint_1 100' in held_out


def test_what_an_arm_touches_is_diagnosed_beside_its_joints(
    folder: Path, tmp_path: Path, command: Command
) -> None:
    wanted, arm, n = motion(), ArmDynamics(URDF), np.array([1.0, 0.0, 0.0])
    x = np.array([arm.pose(q, TIP)[1] @ n for q in wanted.q])
    v = np.gradient(x, wanted.t)
    location = float(np.percentile(x, 60.0))
    force = -np.where(x > location, np.maximum(300.0 * (x - location) + 20.0 * v, 0.0), 0.0)
    pressed = np.hstack([np.array([arm.pose(q, TIP)[0].T @ n for q in wanted.q]) * force[:, None],
                         np.zeros((len(x), 3))])
    one = arm_recording(pressed=pressed)
    assert one.wrench is not None
    write_arm_recording(folder / 'touch.mcap', one.joints,
                        SimulatedArm(one.t, one.q, one.v, one.tau, one.wrench.measured))
    for name, node, values in (
            ('wall', 'plant_node', {'environment': {
                'stiffness': 250.0, 'damping': 20.0, 'location': location}}),
            ('arm', 'estimator_node', {'kinematics': {'base': 'base', 'tip': TIP},
                                       'contact': {'normal': n.tolist()}})):
        (tmp_path / f'{name}.yaml').write_text(yaml.safe_dump({node: {'ros__parameters': values}}))
    ended = command(
        folder / 'touch.mcap', '--nominal-robot', folder / 'arm.urdf', '--nominal',
        tmp_path / 'wall.yaml', '--params', tmp_path / 'arm.yaml', '--json', tmp_path / 'r.json',
        '--write-model', tmp_path / 'c.yaml', '--write-comparison', tmp_path / 'c.json')
    assert ended.code == 0, ended.err
    report = json.loads((tmp_path / 'r.json').read_text())
    assert {one['family'] for one in report['effects']} == {'friction'}
    assert report['contact']['verdict'] == 'recalibrate' and not report['contact']['effects']
    corrected = read_model(tmp_path / 'c.yaml').environment
    assert corrected.stiffness == pytest.approx(300.0, rel=0.01)
    assert 'What the tip touches' in ended.out and 'Apparent mass' in ended.out
    assert len(json.loads((tmp_path / 'c.json').read_text())['models']) > 10


def test_what_the_recording_of_a_simulator_has_is_not_named(
    folder: Path, command: Command
) -> None:
    body = [1.0, 0.1, 0.02, 0.05, 0.01, -0.002, 0.02, -0.005, -0.001, 0.02]
    one = arm_recording([ArmLaw('payload', body, 2), ArmLaw('reflected_inertia', [2.0], 0)], 2)
    write_arm_recording(folder / 'real.mcap', one.joints,
                        SimulatedArm(one.t, one.q, one.v, one.tau))
    ended = command(folder / 'real.mcap', '--nominal-robot', folder / 'arm.urdf', '--simulation',
                    folder / 'run_1.mcap')
    simulation, _, report = ended.out.partition('\n\n')
    assert ended.code == 0 and 'reflected inertia at joint_1' in simulation
    assert report.startswith('physics missing: the description lacks payload at link_3.')


@pytest.mark.parametrize('options, message', [
    (['--nominal-robot', 'arm.urdf', '--nominal', 'x.yaml'], 'needs a wrench'),
    (['--nominal-robot', 'arm.urdf', '--axis', 'x'], '--axis belongs to the diagnosis'),
    (['--nominal-robot', 'arm.urdf', '--write-model', 'x.yaml'], '--write-model needs --nominal'),
    (['--nominal-robot', 'run_1.mcap'], 'expected text in UTF-8, got other data'),
    (['--nominal-robot', 'arm.urdf', '--topic', 'joint_states:=/other'], '/other'),
    (['--write-urdf', 'c.urdf', '--nominal', 'x.yaml'], '--write-urdf needs --nominal-robot'),
    ([], 'one of --nominal MODEL.yaml')])
def test_wrong_use_is_one_line(
    options: list[str], message: str, folder: Path, command: Command,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(folder)
    assert message in command.refusal('run_1.mcap', *options)


@pytest.mark.slow
def test_a_study_of_arms_scores_blind_diagnoses(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    study = Command('blind_trials', blind_trials.main, capfd)
    ended = study('--arms', 1, '--seed', 1, '--output', tmp_path)
    assert ended.code == 0, ended.err
    assert ended.out.splitlines()[0].split() == [
        'concealed', 'worlds', 'right', 'wrong', 'silent', 'accused']
    assert json.loads((tmp_path / 'arms.json').read_text())[0]['outcome'] == 'right'


@pytest.mark.parametrize('named, outcome', [
    ([('payload', 'load', ['joint_3'])], 'right'), ([('base_tilt', 'robot', [])], 'wrong'),
    ([], 'silent'), ([('coulomb_friction', 'friction', ['joint_1'])], 'silent')])
def test_trials_count_the_first_name_beyond_friction(named: list[Any], outcome: str) -> None:
    truth = {'kind': 'payload', 'arm': 'planar_3r',
             'effects': [{'name': 'payload', 'family': 'load', 'place': None}]}
    report = {'verdict': 'physics_missing', 'joints': [], 'effects': [
        {'name': name, 'family': family, 'joints': joints, 'place': ''}
        for name, family, joints in named]}
    assert scored(truth, {'report': report, 'error': ''}, 'world')['outcome'] == outcome
