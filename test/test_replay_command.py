# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The command replay: its output files, and one line on stderr for unreadable input."""

import json
from math import isnan
from pathlib import Path

import contact_estimation as ce
from contact_estimation.commands import replay
from contact_estimation.estimators.estimate import Estimate
from contact_estimation.pipeline.parameters import EstimationParameters
from contact_estimation.pipeline.session import ContactSession
from contact_estimation.recordings import RecordingWriter
from contact_estimation.recordings.encoding import JointStateEncoder, WrenchEncoder
from core_runs import contact_samples
import numpy as np
import pytest
from run_commands import Command

SAMPLES = contact_samples(1.0, force_noise=0.5)
BEGIN_NS = 1_750_000_000_000_000_000
WRENCH, JOINT_STATE = 'geometry_msgs/msg/WrenchStamped', 'sensor_msgs/msg/JointState'
COLUMNS = ('stiffness', 'damping', 'stiffness_std', 'damping_std')


@pytest.fixture
def command(capfd: pytest.CaptureFixture[str]) -> Command:
    return Command('replay', replay.main, capfd)


def write_recording(
    path: Path, wrench: str = '/wrench', joints: str = '/joint_states', axis: int = 0
) -> Path:
    """Record the samples at 500 Hz."""
    wrenches = WrenchEncoder('tool')
    positions = JointStateEncoder('tool', 'contact_x', True)
    with RecordingWriter.file(path) as writer:
        for stamp_ns, position, velocity, force in SAMPLES:
            stamp_ns += BEGIN_NS
            motion = positions.encode(stamp_ns, position, velocity)
            writer.write(joints, JOINT_STATE, motion, stamp_ns)
            forces = [5.0, 5.0, 5.0]
            forces[axis] = force
            writer.write(wrench, WRENCH, wrenches.encode(stamp_ns, *forces), stamp_ns)
    return path


def expected() -> list[Estimate]:
    """Pass the samples through a session."""
    session, estimates = ContactSession(EstimationParameters()), []
    for stamp_ns, position, velocity, force in SAMPLES:
        session.add_motion(stamp_ns + BEGIN_NS, position, velocity)
        estimates += [r.estimate for r in session.add_wrench(stamp_ns + BEGIN_NS, force)]
    return estimates


@pytest.fixture(scope='module')
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_recording(tmp_path_factory.mktemp('replay') / 'a.mcap')


def test_csv_has_one_row_per_sample_with_exact_numbers(
    recording: Path, tmp_path: Path, command: Command
) -> None:
    assert command(recording, '--csv', tmp_path / 'a.csv').code == 0
    header, *rows = (tmp_path / 'a.csv').read_text().splitlines()
    assert header == 't,stiffness,damping,stiffness_std,damping_std,status'
    for row, estimate in zip(rows, expected(), strict=True):
        t, *numbers, status = row.split(',')
        assert int(t.replace('.', '')) == estimate.stamp_ns
        assert numbers == [repr(getattr(estimate, name)) for name in COLUMNS]
        assert status == estimate.status.value


def test_json_has_the_documented_keys(recording: Path, tmp_path: Path, command: Command) -> None:
    assert command(recording, '--json', tmp_path / 'a.json').code == 0
    summary = json.loads((tmp_path / 'a.json').read_text())
    assert {
        'estimator', 'samples', 'stiffness', 'damping', 'location', 'status', 'recorded_s',
        'wall_s', 'model_fit',
    } <= set(summary)
    last = expected()[-1]
    assert (summary['stiffness'], summary['samples']) == (last.stiffness, len(SAMPLES))
    assert summary['recorded_s'] == pytest.approx(0.002 * (len(SAMPLES) - 1))


def test_mcap_output_is_read_by_rosbags(recording: Path, tmp_path: Path, command: Command) -> None:
    rosbags = pytest.importorskip('rosbags.highlevel')
    store = pytest.importorskip('rosbags.typesys')
    assert command(recording, '--output', tmp_path / 'out.mcap').code == 0
    typestore = store.get_typestore(store.Stores.ROS2_JAZZY)
    with rosbags.AnyReader([tmp_path / 'out.mcap'], default_typestore=typestore) as reader:
        connections = [c for c in reader.connections if c.topic == '/estimator_node/stiffness']
        vectors = [
            reader.deserialize(raw, c.msgtype).vector
            for c, _, raw in reader.messages(connections)]
    assert [vector.x for vector in vectors] == [e.stiffness for e in expected()]
    assert all(isnan(vector.y) and isnan(vector.z) for vector in vectors)


@pytest.mark.parametrize('name, content', [
    ('a.db3.zstd', b''), ('a.bag', b'#ROSBAG'), ('damaged.MCAP', b''),
    ('a', b'\x28\xb5\x2f\xfd..'), ('bag/notes.json', b'{}'), ('bag/new.json', None)])
def test_what_may_be_a_recording_is_never_overwritten(
    recording: Path, tmp_path: Path, command: Command, name: str, content: bytes | None
) -> None:
    (tmp_path / 'bag').mkdir()
    (tmp_path / 'bag/metadata.yaml').write_text('rosbag2_bagfile_information: {version: 5}')
    if content is not None:
        (tmp_path / name).write_bytes(content)
    assert 'recordings are never' in command.refusal(recording, '--json', tmp_path / name)
    assert not (tmp_path / name).exists() or (tmp_path / name).read_bytes() == content


def test_topics_and_axis_can_be_chosen(tmp_path: Path, command: Command) -> None:
    path = write_recording(tmp_path / 'a.mcap', '/fts/wrench', '/robot/joints', axis=2)
    ended = command(
        path, '--topic', 'wrench:=/fts/wrench', '--topic', 'joint_states:=/robot/joints', '--axis',
        'z', '--joint', 'contact_x', '--json', tmp_path / 'a.json')
    assert ended.code == 0
    summary = json.loads((tmp_path / 'a.json').read_text())
    assert summary['stiffness'] == expected()[-1].stiffness


@pytest.mark.parametrize('share', [0.99, 0.7, 0.5, 0.35])
def test_recording_cut_short_is_read_up_to_the_cut_with_a_note(
    recording: Path, tmp_path: Path, command: Command, share: float
) -> None:
    path, whole = tmp_path / 'cut.mcap', recording.read_bytes()
    path.write_bytes(whole[:int(share * len(whole))])
    ended = command(path, '--csv', tmp_path / 'a.csv')
    assert ended.code == 0
    assert 'cut short' in ended.err
    stiffness = [row.split(',')[1] for row in (tmp_path / 'a.csv').read_text().splitlines()[1:]]
    assert stiffness == [repr(e.stiffness) for e in expected()][:len(stiffness)]


@pytest.mark.parametrize('text, part', [
    ('estimator_node: [', 'cannot be read: '),
    ('estimator_node: 5', 'ros__parameters'),
    ('estimator_node: {ros__parameters: {estimater: rls}}', "did you mean 'estimator'"),
    ('estimator_node: {ros__parameters: {sample_rate: -1.0}}', 'sample_rate'),
    ('estimator_node: {ros__parameters: {sample_rate: fast}}', 'sample_rate')])
def test_wrong_parameter_file_is_refused(
    recording: Path, tmp_path: Path, command: Command, text: str, part: str
) -> None:
    file = tmp_path / 'parameters.yaml'
    file.write_text(text)
    assert part in command.refusal(recording, '--params', file)


def test_a_force_that_is_no_contact_is_said_with_its_reason(
    tmp_path: Path, command: Command
) -> None:
    t = np.arange(0.0, 6.0, 0.002)
    noise = np.random.default_rng(1).normal(0.0, 0.3, len(t))
    write = {'t_ns': np.round(1e9 * t).astype(np.int64), 'joint.x': -0.1 + 0.002 * t,
             'wrench.force.x': np.where(t > 2.0, 5.0, 0.0) + noise}  # pulls
    ce.write_recording(tmp_path / 'pull.mcap', write)
    refusal = command.refusal(tmp_path / 'pull.mcap')
    assert 'no contact seen' in refusal
    assert refusal.count('a force that is neither that of free flight nor of the wall') == 1


def test_an_estimate_that_is_withheld_at_the_end_is_said_to_be(
    tmp_path: Path, command: Command
) -> None:
    t = np.arange(0.0, 14.0, 0.005)
    x = 0.005 * np.sin(t) + 0.001 * np.sin(15.0 * t)
    noise = np.random.default_rng(1).normal(0.0, 0.1, len(t))
    force = np.minimum(0.0, -4000.0 * x) + noise
    force[t > 8.0] = -7.0  # the sensor is lost
    ce.write_recording(tmp_path / 'a.mcap', {
        't_ns': np.round(1e9 * t).astype(np.int64), 'joint.x': x, 'wrench.force.x': force})
    ended = command(tmp_path / 'a.mcap', '--json', tmp_path / 'a.json')
    assert ended.code == 0 and 'exactly -7 N' in ended.err
    assert 'the estimate is withheld, see the warnings' in ended.out
    summary = json.loads((tmp_path / 'a.json').read_text())
    assert summary['stiffness_std'] is None and 'exactly -7 N' in summary['reason']


def test_a_scale_that_reads_what_it_is_pressed_with_is_told_to_have_the_wrong_sign(
    tmp_path: Path, command: Command
) -> None:
    t = np.arange(0.0, 8.0, 0.01)
    x = np.maximum(0.0, 0.004 * np.sin(np.pi * t / 4.0))
    noise = np.random.default_rng(1).normal(0.0, 0.01, len(t))
    ce.write_recording(tmp_path / 'a.mcap', {
        't_ns': np.round(1e9 * t).astype(np.int64), 'joint.x': x,
        'wrench.force.x': 500.0 * x + noise})
    assert 'change the sign of the recorded force' in command.refusal(tmp_path / 'a.mcap')
