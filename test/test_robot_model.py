# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Kinematics of a description, and arms in recordings."""

import json
from math import nan
from pathlib import Path
import sys

from arm_contact import instants, JOINTS, K_E, LOCATION, messages, NORMAL, PARAMETERS, pose, urdf
from contact_estimation.commands import replay
from contact_estimation.diagnosis.observe.signals import read_recording
from contact_estimation.exceptions import (
    MissingPackageError, ModelFileError, RecordingError, UnknownNameError)
from contact_estimation.kinematics.description import turning_joint
from contact_estimation.kinematics.robot_model import RobotModel
from contact_estimation.kinematics.tool_load import (
    load_regressor, load_vector, specific_force, STANDARD_GRAVITY, ToolParameters)
from contact_estimation.pipeline.events import DESCRIPTION, EstimationEvent
from contact_estimation.recordings.encoding import encode_string
from contact_estimation.recordings.source import RECORD, to_metadata
from contact_estimation.signals.joint_merging import JointMerger
import numpy as np
import pytest
from reference_messages import write
from scipy.spatial.transform import Rotation
import yaml

Q = (0.3, -0.4, 2.7)


@pytest.fixture(scope='module')
def model() -> RobotModel:
    pytest.importorskip('pinocchio')
    return RobotModel(urdf(), 'base_link', 'tool')


@pytest.mark.parametrize('frame', ['tool', 'sensor', 'link_2', 'base_link'])
@pytest.mark.parametrize('q', [Q, (-2.0, 9.0, 0.1)])
def test_pose_is_the_product_of_the_transforms(
    model: RobotModel, frame: str, q: tuple[float, ...]
) -> None:
    R, p = model.pose(q, frame)
    expected = pose(q, frame)
    np.testing.assert_allclose(R, expected[:3, :3], atol=1e-12)
    np.testing.assert_allclose(p, expected[:3, 3], atol=1e-12)


def test_jacobian_is_the_derivative_of_the_pose(model: RobotModel) -> None:
    step = 1e-3
    columns = []
    for joint in np.eye(3):  # five-point formula: error of the order of step^4
        T = {k: pose(tuple(np.array(Q) + k * step * joint)) for k in (-2, -1, 1, 2)}
        rate = (8 * (T[1] - T[-1]) - (T[2] - T[-2])) / (12 * step)
        turning = rate[:3, :3] @ pose(Q)[:3, :3].T
        columns.append([*rate[:3, 3], turning[2, 1], turning[0, 2], turning[1, 0]])
    np.testing.assert_allclose(model.jacobian(Q), np.array(columns).T, atol=1e-9)


def test_only_the_joints_between_base_and_tip_are_asked_for(model: RobotModel) -> None:
    assert model.joint_names == JOINTS
    assert model.continuous == (False, True, False)
    assert RobotModel(urdf(), 'link_1', 'tool').joint_names == JOINTS[1:]


@pytest.mark.parametrize('base, tip, text', [
    ('base_link', 'tol', "unknown link .* 'tol'; did you mean 'tool'"),
    ('world', 'base_link', 'no joint moves kinematics.tip'),
    ('finger', 'tool', 'finger_joint moves the base and not the tip')])
def test_frames_that_cannot_serve_are_named(base: str, tip: str, text: str) -> None:
    pytest.importorskip('pinocchio')
    with pytest.raises((ModelFileError, UnknownNameError), match=text):
        RobotModel(urdf(), base, tip)


def test_a_text_that_is_no_description_is_an_error() -> None:
    pytest.importorskip('pinocchio')
    with pytest.raises(ModelFileError, match='must be a URDF'):
        RobotModel('$(find arm)/arm.xacro', 'base_link', 'tool')


def test_a_missing_library_says_how_to_install_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, 'pinocchio', None)
    with pytest.raises(MissingPackageError, match=r'contact_estimation\[robots\].*ros-jazzy-pin'):
        RobotModel(urdf(), 'base_link', 'tool')


ONE = '<robot name="r"><joint name="mount" type="fixed"/><joint name="only" type="{}"/></robot>'


@pytest.mark.parametrize('names, found', [
    (['elbow'], 'elbow'), (['finger_joint', 'wrist'], 'wrist'), (['finger_joint'], ''),
    (['mount'], ''), (['unknown'], ''), ([''], '')])
def test_a_joint_turns_or_slides_as_described(names: list[str], found: str) -> None:
    assert turning_joint(urdf(), names) == found


@pytest.mark.parametrize('kind, found', [
    ('revolute', 'only'), ('continuous', 'only'), ('prismatic', '')])
def test_an_unnamed_joint_is_the_only_one_that_moves(kind: str, found: str) -> None:
    assert turning_joint(ONE.format(kind), ['']) == found


def test_parts_with_other_stamps_are_interpolated_to_the_one_behind() -> None:
    merger = JointMerger([False, False])
    merger.add(10, (1.0, nan), (0.0, nan))
    merger.add(11, (nan, 2.0), (nan, 0.0))  # the first source has no value at 11 yet
    first = merger.add(14, (3.0, nan), (4.0, nan))
    second = merger.add(12, (nan, 2.5), (nan, 0.0))
    assert first is not None and second is not None
    assert (first[0], second[0]) == (11, 12)
    assert first[1] == pytest.approx([1.5, 2.0, 1.0, 0.0])
    assert second[1] == pytest.approx([2.0, 2.5, 2.0, 0.0])


TOOL = ToolParameters(
    mass=1.2, centre=(0.01, -0.02, 0.06), force_bias=(1.0, -2.0, 3.0),
    torque_bias=(0.1, 0.2, -0.3))
w0, w1 = np.array([0.5, -1.0, 2.0]), np.array([-3.0, 1.5, 0.7])


def orientation(t: float) -> Rotation:
    """Return an accelerating rotation."""
    return Rotation.from_rotvec(w0 * t) * Rotation.from_rotvec(w1 * t * t)


def origin(t: float) -> np.ndarray:
    """Return an accelerating position of the sensor [m]."""
    return np.array([np.sin(3 * t), t**3, np.cos(2 * t)])


def second_difference(function: object, t: float, h: float = 1e-3) -> np.ndarray:
    """Return the second derivative by central differences of fourth order."""
    weights = zip((-2, -1, 0, 1, 2), (-1, 16, -30, 16, -1))
    return sum(k * function(t + i * h) for i, k in weights) / (12 * h * h)  # type: ignore


def angular_velocity(t: float, h: float = 1e-4) -> np.ndarray:
    """Return the angular velocity in the moving frame by central differences [rad/s]."""
    return (orientation(t - h).inv() * orientation(t + h)).as_rotvec() / (2 * h)


def test_force_in_any_motion_is_that_of_a_point_mass_at_the_centre() -> None:
    t, R = 0.4, orientation(0.4).as_matrix()
    centre_acceleration = second_difference(
        lambda s: origin(s) + orientation(s).apply(TOOL.centre), t)
    gravity = np.array([0.0, 0.0, -STANDARD_GRAVITY])
    expected = R.T @ (TOOL.mass * (gravity - centre_acceleration)) + TOOL.force_bias
    alpha = (angular_velocity(t + 1e-4) - angular_velocity(t - 1e-4)) / 2e-4
    felt = specific_force(R, second_difference(origin, t))
    wrench = load_regressor(felt, angular_velocity(t), alpha) @ load_vector(TOOL)
    np.testing.assert_allclose(wrench[:3], expected, atol=1e-5)


pytest.importorskip('pinocchio')


def record(path: Path, every: int = 1, description: str = '', metadata: bool = False) -> Path:
    event = EstimationEvent(DESCRIPTION, 0, {'text': urdf()}).to_text()
    described = {'topic': [('/robot_description', 10**12, encode_string(urdf()))],
                 'event': [('/estimator_node/events', 10**12, encode_string(event))]}
    return write(path, [*messages(every), *described.get(description, [])],
                 {RECORD: to_metadata(PARAMETERS)} if metadata else {})


def parameter_file(folder: Path) -> Path:
    """Write the parameters and the description as files."""
    (folder / 'arm.urdf').write_text(urdf())
    values = {**PARAMETERS, 'robot_description_file': str(folder / 'arm.urdf')}
    file = folder / 'arm.yaml'
    file.write_text(yaml.safe_dump({'estimator_node': {'ros__parameters': values}}))
    return file


def test_replay_takes_an_arm_from_files_of_which_later_ones_override_and_plots_it(
    tmp_path: Path
) -> None:
    pytest.importorskip('matplotlib')
    recording, tool = record(tmp_path / 'a.mcap'), tmp_path / 'tool.yaml'
    tool.write_text(yaml.safe_dump({'/**': {'ros__parameters': {'estimator': 'rls_adaptive'}}}))
    assert replay.main([
        str(recording), '--params', str(parameter_file(tmp_path)), '--params', str(tool),
        '--json', str(tmp_path / 'a.json'), '--picture', str(tmp_path / 'a.png')]) == 0
    summary = json.loads((tmp_path / 'a.json').read_text())
    assert (summary['estimator'], summary['samples']) == ('rls_adaptive', len(instants()))
    assert summary['stiffness'] == pytest.approx(K_E, rel=0.02)
    assert summary['location'] == pytest.approx(LOCATION, abs=1e-4)
    assert (tmp_path / 'a.png').read_bytes().startswith(b'\x89PNG')


@pytest.mark.parametrize('description', ['topic', 'event'])
def test_replay_takes_arm_and_description_from_the_recording(
    tmp_path: Path, description: str
) -> None:
    recording = record(tmp_path / 'a.mcap', description=description, metadata=True)
    assert replay.main([str(recording), '--json', str(tmp_path / 'a.json')]) == 0
    summary = json.loads((tmp_path / 'a.json').read_text())
    assert summary['stiffness'] == pytest.approx(K_E, rel=0.01)


def test_a_recording_without_description_says_what_to_give(tmp_path: Path) -> None:
    recording = record(tmp_path / 'a.mcap', metadata=True)
    with pytest.raises(RecordingError, match='no robot description on /robot_description'):
        read_recording(recording)


@pytest.mark.parametrize('frame', ['base', 'tip'])
def test_diagnosis_reads_motion_and_force_along_the_normal(tmp_path: Path, frame: str) -> None:
    recording = record(tmp_path / 'a.mcap', 4, 'topic', metadata=True)
    normal, truth = NORMAL, instants()
    if frame == 'tip':
        deepest = min(truth, key=lambda instant: instant.contact.force)
        normal = pose(tuple(deepest.q))[:3, :3].T @ NORMAL
    signals = read_recording(recording, parameters={
        'contact.normal': normal.tolist(), 'contact.normal_frame': frame}).signals
    assert len(signals.joint_t) == len(truth[::4])
    np.testing.assert_allclose(
        signals.position, [t.contact.position + LOCATION for t in truth[::4]], atol=1e-4)
    forces = np.array([t.contact.force for t in truth])[:len(signals.force)]
    assert len(forces) > len(truth) - 4  # the last wrenches have no later joint state
    np.testing.assert_allclose(signals.force, forces, atol=0.02)


def test_diagnosis_takes_out_the_inertia_of_a_tool_of_known_mass(tmp_path: Path) -> None:
    recording = record(tmp_path / 'a.mcap', description='topic', metadata=True)
    with_tool, without = (
        read_recording(recording, parameters={'physics.tool_inertia.mass': mass}).signals
        for mass in (2.0, float('nan')))
    t, v = (np.array([getattr(one.contact, name) for one in instants()], float)
            for name in ('stamp_ns', 'velocity'))
    inertia = 2.0 * np.gradient(v, 1e-9 * t)[:len(without.force)]
    jumps = np.abs(np.diff(inertia, prepend=0.0)) > 0.2  # the touch, smeared over 20 ms
    smooth = np.convolve(jumps, np.ones(21), 'same') == 0.0
    taken = (with_tool.force - without.force)[smooth]
    np.testing.assert_allclose(taken, inertia[smooth], atol=0.1 * np.abs(inertia).max())


def test_force_sign_turns_a_recording_of_one_axis(tmp_path: Path) -> None:
    record(tmp_path / 'a.mcap')
    forces = [read_recording(tmp_path / 'a.mcap', joint=name, parameters=given).signals.force
              for name, given in (('wrist', {}), ('wrist', {'force_sign': -1}))]
    np.testing.assert_array_equal(forces[0], -forces[1])
