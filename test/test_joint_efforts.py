# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Force without a force sensor: the wrench at the contact from the torques of the joints."""

from functools import lru_cache
import json
from math import nan
from pathlib import Path
from typing import Any, Sequence

import contact_estimation as ce
from contact_estimation.commands.convert import main as convert
from contact_estimation.commands.replay import main as replay
from contact_estimation.parameters import build
from contact_estimation.pipeline.axes import Result
from contact_estimation.pipeline.inputs import MessageInputs
from contact_estimation.pipeline.joint_torques import Joints, JointTorques
from contact_estimation.pipeline.parameters import EstimationParameters
from contact_estimation.pipeline.session import ContactSession
from contact_estimation.recordings.encoding import encode_arm
from effort_worlds import (
    B_E, described, K_E, location, messages, model, motion, parameters, POINT)
import numpy as np
from numpy.typing import NDArray
import pytest
from reference_messages import write
from run_commands import Command

pytest.importorskip('pinocchio')


def run(
    urdf: str, rows: Sequence[tuple[int, bytes]], **changes: Any
) -> tuple[ContactSession, list[Result]]:
    """Process joint states as the node does."""
    session = ContactSession(build(EstimationParameters, parameters(**changes)))
    session.describe(urdf)
    inputs = MessageInputs(session)
    return session, [result for _, raw in rows for result in inputs.process_motion(raw)]


def run_once(
    friction: float = 1.0, mass: float = 1.0, velocity: bool = True, std: float = 0.05
) -> tuple[ContactSession, list[Result]]:
    """Process a touch; equal requests share one run, however they are written."""
    return _run_once(friction, mass, velocity, std)


@lru_cache(maxsize=None)
def _run_once(
    friction: float, mass: float, velocity: bool, std: float
) -> tuple[ContactSession, list[Result]]:
    return run(described(friction, mass), messages(velocity), joint_torques_std=std)


def force_error(results: Sequence[Result]) -> float:
    """Return the rms of the error of the force in contact [N]."""
    arm, truth = motion()
    t = np.array([1e-9 * one.sample.stamp_ns - 1.0 for one in results])
    force = np.array([one.sample.force for one in results])
    pressed: NDArray[np.bool_] = (t > 2.0) & (t < 5.0)
    return float(np.sqrt(np.mean((force - np.interp(t, arm.t, truth))[pressed] ** 2)))


def test_friction_of_the_description_takes_the_error_out_of_the_force() -> None:
    # Frictionless; friction as diagnose finds it, 10 % off, with masses 2 % off; the true one.
    errors = [force_error(run_once(*share)[1]) for share in ((0.0, 1.0), (1.1, 1.02), (1.0, 1.0))]
    assert errors[0] > 30.0 and errors[1] < 7.0 and errors[2] < 1.5


@pytest.mark.parametrize('friction, mass, velocity, told', [
    (1.0, 1.0, True, True), (1.1, 1.02, True, True), (0.95, 0.98, False, True),
    (1.0, 1.0, True, False)])
def test_stiffness_is_within_its_band(
    friction: float, mass: float, velocity: bool, told: bool
) -> None:
    session, results = run_once(friction, mass, velocity) if told else run(
        described(), messages(), **{'environment.location': nan})
    last = [one.estimate for one in results if one.estimate.status.value == 'estimating'][-1]
    assert last.stiffness == pytest.approx(K_E, rel=0.05)
    assert abs(last.stiffness - K_E) < 2.0 * last.stiffness_std < 0.2 * K_E
    assert abs(last.damping - B_E) < 2.0 * last.damping_std
    assert not session.rejected


def test_bands_contain_the_doubt_of_the_description() -> None:
    sure, unsure = (
        [one.estimate for one in run_once(std=std)[1]
         if one.estimate.status.value == 'estimating'][-1].stiffness_std for std in (0.05, 0.2))
    assert unsure > 1.5 * sure


def test_wrench_of_a_resting_arm_is_that_of_statics() -> None:
    arm, q = model(), np.array(motion()[0].q[0])
    torques = JointTorques(described(0.0), arm, POINT)
    R, _ = arm.pose(q)
    force, lever = np.array([3.0, -4.0, 20.0]), R @ POINT
    J = arm.jacobian(q)
    zero = np.zeros(6)
    tau = torques.arm.torque(q[None], zero[None], zero[None])[0] - J.T @ np.r_[
        force, np.cross(lever, force)]
    found = None
    for k in range(6):
        found = torques.add(Joints(2_000_000 * k, q, zero, tau)) or found
    assert found is not None and found.stamp_ns == 5_000_000
    np.testing.assert_allclose(R @ found.wrench[:3], force, atol=0.02)
    np.testing.assert_allclose(R @ found.wrench[3:], np.cross(lever, force), atol=0.02)


@pytest.fixture(scope='module')
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a recording of joint states alone, and beside it parameters."""
    folder = tmp_path_factory.mktemp('efforts')
    (folder / 'arm.urdf').write_text(described())
    rows = '\n'.join(f'    {name}: {value}' for name, value in parameters(
        robot_description_file=str(folder / 'arm.urdf')).items() if name != 'sample_rate')
    (folder / 'arm.yaml').write_text(f'/**:\n  ros__parameters:\n{rows}\n')
    return write(folder / 'run.mcap', [('/joint_states', *message) for message in messages()])


def test_replay_gives_what_the_node_gives(
    recorded: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    summary = recorded.with_name('a.json')
    Command('replay', replay, capfd)(
        recorded, '--params', recorded.with_name('arm.yaml'), '--json', summary)
    _, results = run_once()
    assert json.loads(summary.read_text())['stiffness'] == results[-1].estimate.stiffness


def test_a_description_that_is_off_is_to_be_identified(
    recorded: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / 'off.urdf').write_text(described(1.1, 1.02))
    text = recorded.with_name('arm.yaml').read_text().replace(
        str(recorded.with_name('arm.urdf')), str(tmp_path / 'off.urdf'))
    (tmp_path / 'off.yaml').write_text(text)
    said = Command('replay', replay, capfd)(recorded, '--params', tmp_path / 'off.yaml')
    assert 'diagnose --nominal-robot' in said.err and 'calibrate_tool' not in said.err


def test_joint_efforts_survive_a_table(
    recorded: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    found = []
    Command('convert', convert, capfd)(recorded, tmp_path / 'a.csv')
    Command('convert', convert, capfd)(tmp_path / 'a.csv', tmp_path / 'b.mcap')
    for path in (recorded, tmp_path / 'b.mcap'):
        Command('replay', replay, capfd)(
            path, '--params', recorded.with_name('arm.yaml'), '--json', tmp_path / 'a.json')
        summary = json.loads((tmp_path / 'a.json').read_text())
        found.append((summary['stiffness'], summary['damping'], summary['samples']))
    assert found[0] == found[1]


def test_diagnosis_reads_the_same_force(recorded: Path) -> None:
    found = ce.read_recording(recorded, parameters=parameters(
        robot_description_file=str(recorded.with_name('arm.urdf')))).signals
    _, results = run_once()
    force = np.array([one.sample.force for one in results])
    np.testing.assert_allclose(found.force[:len(force)], force, atol=0.2)


def test_diagnosis_blames_no_wall_for_a_description_that_is_off(
    recorded: Path, tmp_path: Path
) -> None:
    (tmp_path / 'off.urdf').write_text(described(0.9, 0.98))
    recording = ce.read_recording(recorded, parameters=parameters(
        robot_description_file=str(tmp_path / 'off.urdf'), joint_torques_std=0.1))
    assert 1.0 < recording.sensor_error < 10.0
    nominal = build(ce.PlantParameters, {
        'environment.stiffness': K_E, 'environment.damping': B_E,
        'environment.location': location()})
    assert not ce.diagnose([recording], nominal).effects


@pytest.mark.parametrize('changes, text', [
    ({'kinematics.tip': ''}, 'wrench_source joint_efforts needs an arm'),
    ({'force_sensor.axes': 'base'}, 'leave out force_sensor.frame')])
def test_parameters_that_contradict_each_other_are_refused(
    changes: dict[str, Any], text: str
) -> None:
    with pytest.raises(ce.ContactEstimationError, match=text):
        build(EstimationParameters, parameters(**changes))


def test_joint_states_without_efforts_are_named() -> None:
    raw = encode_arm(1, model().joint_names, np.zeros(6), np.zeros(6), np.zeros(0))
    session, _ = run(described(), [(1, raw)])
    text = session.rejection_texts['joint_states_effort_missing']
    assert 'let the driver publish effort' in text
