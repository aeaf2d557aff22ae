# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Transforms of tf: decoding, the tree of frames, merging, and the model of an arm."""

from __future__ import annotations

import struct

from arm_transforms import static_bytes, transform
from contact_estimation.exceptions import MessageError, ModelFileError, UnknownNameError
from contact_estimation.kinematics.frame_tree import FrameTree
from contact_estimation.kinematics.transform_model import MovingFrames, TransformModel
from contact_estimation.recordings.plain_decoding import StampedTransform, TransformsDecoder
import numpy as np
import pytest
from reference_messages import deserialized, TF, transforms_bytes
from scipy.spatial.transform import Rotation
from small_arm import MOVING, pose

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
    np.testing.assert_allclose(
        model.root_axes, pose(q, base, model.root)[:3, :3], atol=1e-9)


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
    np.testing.assert_allclose(
        halfway, Rotation.from_euler('z', 0.01).as_matrix(), atol=1e-9)
