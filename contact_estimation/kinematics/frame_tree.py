# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Poses of frames, the messages of tf, and the tree of frames that they describe."""

from math import isfinite, sqrt
from operator import itemgetter
from typing import Any, Collection, Iterable, NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray

from ..recordings.cdr import CdrCursor, Layout, NS_PER_S, whole

Pose = Sequence[float]
"""Origin x, y, z of a frame in its parent [m], unit quaternion x, y, z, w of its axes."""

IDENTITY: Pose = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0)
TRANSFORMS_TYPE = 'tf2_msgs/msg/TFMessage'
_MOST_LAYOUTS = 64  # every publisher of tf may send several selections of frames


class StampedTransform(NamedTuple):
    """Pose of a frame in its parent frame at one instant."""

    stamp_ns: int  # header stamp [ns]
    # parent, child: names of the frames, without leading slash
    parent: str
    child: str
    # origin x, y, z of the child in the parent [m], quaternion x, y, z, w of its axes
    pose: tuple[float, ...]


class TransformsDecoder:
    """Read tf2_msgs/msg/TFMessage."""

    def __init__(self) -> None:
        self._layouts: dict[int, list[_TransformsLayout]] = {}  # by size of the message

    def decode(self, raw: bytes) -> list[StampedTransform]:
        """Read one message."""
        for layout in self._layouts.get(len(raw), ()):
            transforms = layout.read(raw)
            if transforms is not None:
                return transforms
        layout = whole(raw, TRANSFORMS_TYPE, _TransformsLayout)
        if sum(map(len, self._layouts.values())) >= _MOST_LAYOUTS:
            self._layouts.clear()
        self._layouts.setdefault(len(raw), []).append(layout)
        return layout.read(raw) or []


class _TransformsLayout(Layout):
    """Of transforms[]: header, child_frame_id, translation and rotation (x, y, z, w)."""

    def __init__(self, cursor: CdrCursor) -> None:
        found = []
        for _ in range(cursor.length()):
            stamp = cursor.skip(8, 4)
            names = cursor.text().lstrip('/'), cursor.text().lstrip('/')
            found.append((*names, [stamp, stamp + 4, *cursor.doubles(7)]))
        super().__init__(cursor, [field for *_, places in found
                                  for field in zip(places, 'iIddddddd')])
        self._frames: list[tuple[str, str, Any]] = [
            (parent, child, itemgetter(*(self._place[at] for at in places)))
            for parent, child, places in found]

    def read(self, raw: bytes) -> list[StampedTransform] | None:
        """Read a message of the layout's size; None if the layout does not fit."""
        values = self._unpack(raw)
        if self._fixed(values) != self._expected:
            return None
        found = []
        for parent, child, pick in self._frames:
            sec, nanosec, *pose = pick(values)
            found.append(StampedTransform(sec * NS_PER_S + nanosec, parent, child, tuple(pose)))
        return found


def rotated(pose: Pose, x: float, y: float, z: float) -> tuple[float, float, float]:
    """Return v + w t + u x t with t = 2 u x v: v of the child in axes of the parent, by (u, w)."""
    a, b, c, w = pose[3], pose[4], pose[5], pose[6]
    t, u, s = 2.0 * (b * z - c * y), 2.0 * (c * x - a * z), 2.0 * (a * y - b * x)
    return (x + w * t + b * s - c * u, y + w * u + c * t - a * s, z + w * s + a * u - b * t)


def product(first: Pose, second: Pose) -> Pose:
    """Return the pose of a frame in the grandparent."""
    x, y, z = rotated(first, second[0], second[1], second[2])
    a, b, c, d = first[3], first[4], first[5], first[6]
    e, f, g, h = second[3], second[4], second[5], second[6]
    return (
        first[0] + x, first[1] + y, first[2] + z, d * e + a * h + b * g - c * f,
        d * f - a * g + b * h + c * e, d * g + a * f - b * e + c * h,
        d * h - a * e - b * f - c * g)


def inverse(pose: Pose) -> Pose:
    """Return the pose of the parent in the child."""
    turned = (0.0, 0.0, 0.0, -pose[3], -pose[4], -pose[5], pose[6])
    x, y, z = rotated(turned, pose[0], pose[1], pose[2])
    return (-x, -y, -z, *turned[3:])


def normalised(pose: Pose) -> Pose:
    """Return a pose with a unit quaternion; of two interpolated ones, the length is below 1."""
    a, b, c, d = pose[3], pose[4], pose[5], pose[6]
    scale = 1.0 / sqrt(a * a + b * b + c * c + d * d)
    return (pose[0], pose[1], pose[2], a * scale, b * scale, c * scale, d * scale)


def matrix_of(pose: Pose) -> NDArray[np.float64]:
    """Return the axes of the child as columns in the parent, shape (3, 3)."""
    a, b, c, d = pose[3], pose[4], pose[5], pose[6]
    return np.array([
        [1.0 - 2.0 * (b * b + c * c), 2.0 * (a * b - c * d), 2.0 * (a * c + b * d)],
        [2.0 * (a * b + c * d), 1.0 - 2.0 * (a * a + c * c), 2.0 * (b * c - a * d)],
        [2.0 * (a * c - b * d), 2.0 * (b * c + a * d), 1.0 - 2.0 * (a * a + b * b)]])


class Step(NamedTuple):
    """One step between frames."""

    child: str  # A frame whose pose in its parent moves; '' for fixed steps
    up: bool  # true from the child to its parent, so that the pose applies inverted
    pose: Pose  # of a fixed step, in the direction of the step


class FrameTree:
    """
    Frames, their parents, and the poses of those that are fixed.

    fixed: parent and pose of each child of /tf_static, as received
    moving: parent of each child of /tf
    """

    def __init__(self) -> None:
        self.fixed: dict[str, tuple[str, Pose]] = {}
        self.moving: dict[str, str] = {}

    def add_fixed(self, transforms: Iterable[StampedTransform]) -> bool:
        """Add transforms of /tf_static."""
        news = False
        for _, parent, child, pose in transforms:
            if not usable(pose):
                continue
            news |= self.fixed.get(child) != (parent, pose)
            self.fixed[child] = parent, pose
        return news

    def add_moving(self, transforms: Iterable[StampedTransform]) -> bool:
        """Add the frames of transforms of /tf; return whether the tree has changed."""
        news = False
        for _, parent, child, _ in transforms:
            if child not in self.moving:
                self.moving[child] = parent
                news = True
        return news

    def parent(self, frame: str) -> str | None:
        """Return the frame above another; None above a root."""
        return self.fixed[frame][0] if frame in self.fixed else self.moving.get(frame)

    def above(self, frame: str) -> list[str]:
        """Return a frame and all above it, the root last; a loop ends where it closes."""
        frames, here = [frame], self.parent(frame)
        while here is not None and here not in frames:
            frames.append(here)
            here = self.parent(here)
        return frames

    def path(self, base: str, frame: str) -> list[Step] | None:
        """Return the steps from a base to a frame."""
        to_base, to_frame = self.above(base), self.above(frame)
        common = next((name for name in to_base if name in to_frame), None)
        if common is None:
            return None
        steps = [self._step(child, True) for child in to_base[:to_base.index(common)]]
        down = to_frame[:to_frame.index(common)]
        steps += [self._step(child, False) for child in reversed(down)]
        return _joined(steps)

    def root_of(self, frame: str) -> tuple[str, Pose]:
        """Return the highest frame that fixed steps connect, and the pose of a frame in it."""
        here, pose = frame, IDENTITY
        for above in self.above(frame)[1:]:
            if here not in self.fixed:
                break
            pose, here = product(normalised(self.fixed[here][1]), pose), above
        return here, pose

    def anchor(self, frame: str, known: Collection[str]) -> tuple[str, Pose] | None:
        """Return a known frame that fixed steps connect with a frame, and the pose in it."""
        found = []
        for other in (set(self.fixed) | {entry[0] for entry in self.fixed.values()}) & set(known):
            steps = self.path(other, frame) or []
            if len(steps) == 1 and not steps[0].child:
                found.append((len(self.above(other)), other, steps[0].pose))
        return max(found)[1:] if found else None

    def _step(self, child: str, up: bool) -> Step:
        if child not in self.fixed:
            return Step(child, up, IDENTITY)
        pose = normalised(self.fixed[child][1])
        return Step('', up, inverse(pose) if up else pose)


def usable(pose: Pose) -> bool:
    """Return whether all numbers are finite and the quaternion has about unit length."""
    return all(map(isfinite, pose)) and abs(sum(part * part for part in pose[3:]) - 1.0) < 0.1


def _joined(steps: list[Step]) -> list[Step]:
    joined: list[Step] = []
    for step in steps:
        if joined and not step.child and not joined[-1].child:
            joined[-1] = Step('', False, product(joined[-1].pose, step.pose))
        else:
            joined.append(step)
    return joined
