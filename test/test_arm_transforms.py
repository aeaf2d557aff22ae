# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Frames by tf: read, and for an arm."""

import json
from pathlib import Path
import struct
import sys
from typing import Any, Iterable, Mapping

from arm_contact import (
    B_E, instants, K_E, LOCATION, messages, MOVING, OF_TF, PARAMETERS, pose, static_bytes,
    tf_messages, transform, urdf)
from contact_estimation.commands import replay
from contact_estimation.diagnosis.observe.signals import read_recording
from contact_estimation.exceptions import (
    MessageError, ModelFileError, ParameterRangeError, UnknownNameError)
from contact_estimation.kinematics.frame_tree import FrameTree, StampedTransform, TransformsDecoder
from contact_estimation.kinematics.transform_model import MovingFrames, TransformModel
from contact_estimation.parameters import build, flatten
from contact_estimation.pipeline.axes import Result
from contact_estimation.pipeline.events import EstimationEvent, event_now, START
from contact_estimation.pipeline.inputs import MessageInputs
from contact_estimation.pipeline.parameters import EstimationParameters
from contact_estimation.pipeline.replay import RecordingReplay
from contact_estimation.pipeline.session import ContactSession
from contact_estimation.recordings import RecordingReader
from contact_estimation.recordings.encoding import encode_string
from contact_estimation.recordings.source import RecordingSource
import numpy as np
import pytest
from reference_messages import deserialized, TF, transforms_bytes, write
from scipy.spatial.transform import Rotation

Message = tuple[str, int, bytes]


class Live:
    """What the node does with messages, and what its recorder writes."""

    def __init__(self, parameters: Mapping[str, Any]) -> None:
        self.session = ContactSession(
            build(EstimationParameters, parameters), generate_reference=False)
        self.inputs = MessageInputs(self.session)
        self.results: list[Result] = []
        self.recorded: list[Message] = []
        self._event(event_now(self.session, START, flatten(self.session.parameters)))

    def take(self, listed: Iterable[Message]) -> 'Live':
        """Process messages, and list them with the events that the node would publish."""
        process = {'/wrench': self.inputs.process_wrench,
                   f'/{self.session.parameters.motion_topic}': self.inputs.process_motion}
        arm = self.inputs.arm
        for topic, stamp_ns, raw in listed:
            self.recorded.append((topic, stamp_ns, raw))
            if topic in process:
                self.results += process[topic](raw)
            elif arm is not None:
                arm.process_static_transforms(raw)
            while arm is not None and arm.events:
                self._event(arm.events.pop(0))
        return self

    def _event(self, event: EstimationEvent) -> None:
        self.recorded.append(('/estimator_node/events', 0, encode_string(event.to_text())))

    def numbers(self) -> list[str]:
        return [repr(result.estimate) for result in self.results]


def replayed(path: Path) -> list[str]:
    run = RecordingReplay(RecordingReader(path), RecordingSource(), {})
    return [repr(estimates[0]) for batch in run.estimates() for estimates in batch]


@pytest.mark.slow
def test_motion_and_force_are_those_along_the_normal() -> None:
    live = Live(OF_TF).take(tf_messages())
    truth = [instant.contact for instant in instants()]
    found = np.array([[r.sample.position, r.sample.force] for r in live.results])
    np.testing.assert_allclose(found, [[s.position + LOCATION, s.force] for s in truth], atol=1e-9)
    assert all(np.isnan(result.sample.velocity) for result in live.results)
    assert not live.session.rejected


@pytest.mark.parametrize('every, split', [(1, False), (4, False), (4, True)])
def test_stiffness_and_damping_are_found_at_any_rate_of_tf(every: int, split: bool) -> None:
    estimate = Live(OF_TF).take(tf_messages(every, split)).results[-1].estimate
    assert estimate.stiffness == pytest.approx(K_E, rel=0.01)
    assert estimate.damping == pytest.approx(B_E, rel=0.1)


def test_poses_of_tf_need_no_pinocchio(monkeypatch: pytest.MonkeyPatch) -> None:
    listed = tf_messages()
    monkeypatch.setitem(sys.modules, 'pinocchio', None)
    assert Live(OF_TF).take(listed).results[-1].estimate.stiffness == pytest.approx(K_E, rel=0.01)


def test_gravity_follows_a_mounting_that_comes_late() -> None:
    first, *others = tf_messages()
    partly = [('/tf_static', 0, static_bytes(['sensor', 'tool']))]
    mounting = [('/tf_static', 0, static_bytes(['base_link']))]
    live = Live(OF_TF).take([*partly, *others[:40], *mounting, *others[40:]])
    truth = {one.contact.stamp_ns: one.contact.force for one in instants()}
    errors = [abs(r.sample.force - truth[r.sample.stamp_ns]) for r in live.results]
    assert max(errors[:5]) > 0.1 and max(errors[30:]) < 1e-9


def test_a_frame_that_tf_lacks_is_the_problem_of_the_session() -> None:
    live = Live({**OF_TF, 'kinematics.tip': 'tcp'}).take(tf_messages()[:21])
    assert "tf has no frame 'tcp' (kinematics.tip)" in live.session.problem
    assert live.session.rejected == {'transforms_missing': 10}


def test_a_mounting_that_changes_in_contact_is_refused_with_a_reason() -> None:
    live = Live(OF_TF).take(tf_messages())
    assert live.session.pipeline.contact
    arm = live.session.arm
    live.take([('/tf_static', 0, transforms_bytes(
        [(0, 'sensor', 'tool', (0.0, 0.0, 0.3, 0.0, 0.0, 0.0, 1.0))]))])
    assert live.session.arm is arm and live.session.rejected['tf_static_changed'] == 1


def test_poses_of_tf_need_a_tip() -> None:
    with pytest.raises(ParameterRangeError, match='pose_source tf needs the frames of an arm'):
        build(EstimationParameters, {'pose_source': 'tf'})


@pytest.mark.parametrize('every, split', [(1, False), (4, True)])
def test_replay_repeats_the_node_bit_for_bit(tmp_path: Path, every: int, split: bool) -> None:
    live = Live(OF_TF).take(tf_messages(every, split))
    assert replayed(write(tmp_path / 'a.mcap', live.recorded)) == live.numbers()


def test_replay_refuses_what_the_node_refused_before_it_knew_the_arm(tmp_path: Path) -> None:
    static, *others = tf_messages(4, True)
    live = Live(OF_TF).take([*others[:203], static, *others[203:]])
    assert len(live.results) < len(instants()) - 100
    assert replayed(write(tmp_path / 'a.mcap', live.recorded)) == live.numbers()
    # Without events the recording is that of any recorder: everything is used.
    bag = [message for message in live.recorded if message[0] != '/estimator_node/events']
    file = tmp_path / 'params.json'
    file.write_text(json.dumps({'estimator_node': {'ros__parameters': OF_TF}}))
    assert replay.main([str(write(tmp_path / 'b.mcap', bag)), '--params', str(file),
                        '--json', str(tmp_path / 'b.json')]) == 0
    summary = json.loads((tmp_path / 'b.json').read_text())
    assert summary['samples'] > len(live.results) + 90
    assert summary['stiffness'] == pytest.approx(K_E, rel=0.01)


def test_diagnosis_reads_motion_and_force_along_the_normal(tmp_path: Path) -> None:
    live = Live(OF_TF).take(tf_messages())
    signals = read_recording(write(tmp_path / 'a.mcap', live.recorded)).signals
    truth = [one.contact for one in instants()]
    np.testing.assert_allclose(signals.position, [s.position + LOCATION for s in truth], atol=1e-9)
    np.testing.assert_allclose(signals.force, [s.force for s in truth], atol=1e-9)


# The sensor of a driver, turned by 0.4 about z from the link `sensor`.
MOUNTING = (0.0, 0.0, 0.0, 0.0, 0.0, np.sin(0.2), np.cos(0.2))
CELL = transforms_bytes([(0, 'sensor', 'cell', MOUNTING)])


def test_a_sensor_that_the_description_lacks_is_found_in_tf(tmp_path: Path) -> None:
    pytest.importorskip('pinocchio')
    (tmp_path / 'arm.urdf').write_text(urdf())
    parameters = {**PARAMETERS, 'force_sensor.frame': 'cell',
                  'robot_description_file': str(tmp_path / 'arm.urdf')}
    live = Live(parameters).take(messages()[:200])
    assert live.session.rejected == {'wrench_frame_unknown': 100}
    text = live.session.rejection_texts['wrench_frame_unknown']
    assert "'cell'" in text and 'publish its mounting on /tf_static' in text
    live.take([('/tf_static', 0, CELL), *messages()[200:]])
    assert live.session.rejected == {'wrench_frame_unknown': 100}
    turned = Live({**parameters, 'force_sensor.frame': 'sensor',
                   'force_sensor.rpy': [0.0, 0.0, 0.4]}).take(messages())
    forces = [[r.sample.force for r in run.results[-200:]] for run in (live, turned)]
    np.testing.assert_allclose(forces[0], forces[1], atol=1e-9)
    recording = write(tmp_path / 'a.mcap', live.recorded)
    assert replay.main([str(recording), '--json', str(tmp_path / 'a.json')]) == 1  # no description
    described = EstimationEvent('robot_description', -(2**63), {'text': urdf()})
    event = ('/estimator_node/events', 0, encode_string(described.to_text()))
    recording = write(tmp_path / 'b.mcap', [live.recorded[0], event, *live.recorded[1:]])
    assert replayed(recording) == live.numbers()
    signals = read_recording(recording).signals
    np.testing.assert_allclose(signals.force[-200:], forces[0], atol=1e-9)


RANDOM = np.random.default_rng(5)


def random_pose() -> tuple[float, ...]:
    turned = Rotation.random(random_state=int(RANDOM.integers(1 << 30))).as_quat()
    return (*RANDOM.normal(size=3).tolist(), *turned.tolist())


def tree_of(q: tuple[float, ...]) -> tuple[FrameTree, list[StampedTransform]]:
    tree, decoder = FrameTree(), TransformsDecoder()
    tree.add_fixed(decoder.decode(static_bytes()))
    moving = decoder.decode(transforms_bytes([transform(q, link, 7) for link in MOVING]))
    tree.add_moving(moving)
    return tree, moving


@pytest.mark.parametrize('little_endian', [True, False])
@pytest.mark.parametrize('count', [0, 1, 3])
def test_transforms_are_read_as_rosbags_reads_them(count: int, little_endian: bool) -> None:
    decoder = TransformsDecoder()
    for length in range(4):  # of the names, which move all that follows
        sent = [(10**18 + 5 * k, 'base' + 'x' * length, f'child_{k}' + 'y' * k, random_pose())
                for k in range(count)]
        raw = transforms_bytes(sent, little_endian)
        expected = [
            (t.header.stamp.sec * 10**9 + t.header.stamp.nanosec, t.header.frame_id,
             t.child_frame_id, *(getattr(t.transform.translation, axis) for axis in 'xyz'),
             *(getattr(t.transform.rotation, axis) for axis in 'xyzw'))
            for t in deserialized(raw, TF).transforms]
        for _ in range(2):  # the second time by the layout found
            assert [(*one[:3], *one.pose) for one in decoder.decode(raw)] == expected


def test_bytes_that_are_no_transforms_are_refused() -> None:
    raw = transforms_bytes([(1, 'base', 'tip', random_pose())])
    for wrong in (raw[:-80], raw[:4], b'', raw[:4] + struct.pack('<I', 10**6) + raw[8:]):
        with pytest.raises(MessageError, match='tf2_msgs/msg/TFMessage'):
            TransformsDecoder().decode(wrong)


@pytest.mark.parametrize('base, frame', [
    ('base_link', 'tool'), ('world', 'sensor'), ('tool', 'base_link'), ('link_2', 'finger')])
def test_poses_are_those_of_hand_written_transforms(base: str, frame: str) -> None:
    q = (0.4, -0.5, 0.6)
    tree, moving = tree_of(q)
    model = TransformModel(tree, base, frame)
    ((_, row),) = MovingFrames(model.joint_names, 0.5).add(moving)
    R, p = model.pose(row)
    expected = np.linalg.inv(pose(q, base, 'world')) @ pose(q, frame, 'world')
    np.testing.assert_allclose(np.c_[R, p], expected[:3], atol=1e-9)
    np.testing.assert_allclose(model.root_axes, pose(q, base, model.root)[:3, :3], atol=1e-9)


def test_frames_that_lack_are_named() -> None:
    tree, _ = tree_of((0.1, 0.2, 0.3))
    with pytest.raises(ModelFileError, match=r"no frame 'flange' \(kinematics.tip\); it has base"):
        TransformModel(tree, 'base_link', 'flange')
    tree.add_moving([StampedTransform(0, 'camera', 'marker', random_pose())])
    with pytest.raises(ModelFileError, match="they hang from 'world' and 'camera'"):
        TransformModel(tree, 'base_link', 'marker')
    with pytest.raises(ModelFileError, match='only static transforms lie between'):
        TransformModel(tree, 'link_3', 'tool')
    model = TransformModel(tree, 'base_link', 'sensor')
    with pytest.raises(ModelFileError, match="'finger' moves with finger"):
        model.in_tip('finger')
    with pytest.raises(UnknownNameError, match='tol'):
        model.in_tip('tol')


def part(stamp_ns: int, *children: str) -> list[StampedTransform]:
    return [StampedTransform(stamp_ns, 'base', child, (float(stamp_ns), *[0.0] * 5, 1.0))
            for child in children]


def test_turning_frames_are_interpolated_the_short_way() -> None:
    moving = MovingFrames(['a', 'b'], 1.0)
    turns = [Rotation.from_euler('z', angle).as_quat() for angle in (0.0, 0.02)]
    poses = [(0.0, 0.0, 0.0, *turns[0].tolist()), (0.0, 0.0, 0.0, *(-turns[1]).tolist())]
    moving.add([StampedTransform(0, 'base', 'a', poses[0]), *part(0, 'b')])
    rows = moving.add([StampedTransform(10, 'base', 'a', poses[1]), *part(5, 'b')])
    rows += moving.add(part(10, 'b'))
    tree = FrameTree()
    tree.add_moving([StampedTransform(0, 'base', 'a', poses[0])])
    halfway = TransformModel(tree, 'base', 'a').pose(rows[0][1][:7])[0]
    assert rows[0][0] == 5
    np.testing.assert_allclose(halfway, Rotation.from_euler('z', 0.01).as_matrix(), atol=1e-9)
