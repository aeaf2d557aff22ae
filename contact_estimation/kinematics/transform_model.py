# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Poses of an arm's frames from the transforms of tf, in place of its joints."""

from collections import deque
from typing import Iterable, Sequence

import numpy as np

from .frame_tree import (
    FrameTree, IDENTITY, inverse, matrix_of, normalised, Pose, product, StampedTransform, Step,
    usable)
from .robot_model import Array
from ..exceptions import ModelFileError, UnknownNameError
from ..signals.joint_merging import Row, row_at
from ..signals.stamp_screen import BEFORE_ANY

NUMBERS = 7  # of a pose
_MOST_KEPT = 10_000  # of a frame while another is silent


class MovingFrames:
    """
    Merge transforms that come in several messages into rows of all poses at one stamp.

    A row is given at every stamp of any of the frames, once all have reached it; those that have
    no pose at that stamp are interpolated. The rows do not depend on the order in which messages
    of different publishers come.

    The sign of each quaternion is that of the one before it, so that numbers may be interpolated;
    `TransformModel` takes them to unit length again.

    frames: the child frames, in the order of the rows
    time_jump_s: A transform older than the last by more than this is a backward clock jump [s]
    """

    def __init__(self, frames: Sequence[str], time_jump_s: float) -> None:
        self._rows: dict[str, deque[Row]] = {frame: deque(maxlen=_MOST_KEPT) for frame in frames}
        self._jump_ns = int(time_jump_s * 1e9)
        self._given_ns = BEFORE_ANY

    @property
    def missing(self) -> list[str]:
        """Return the frames of which no pose has come."""
        return [frame for frame, rows in self._rows.items() if not rows]

    def add(self, transforms: Iterable[StampedTransform]) -> list[Row]:
        """Add a message; return rows: stamp [ns], and 7 numbers of each frame."""
        added = False
        for stamp_ns, _, child, pose in transforms:
            rows = self._rows.get(child)
            if rows is None or not usable(pose):
                continue
            if rows and stamp_ns <= rows[-1][0]:
                if stamp_ns >= rows[-1][0] - self._jump_ns:
                    continue  # a repetition, or out of order
                self._restart()
            rows.append((stamp_ns, _of_same_sign(pose, rows[-1][1]) if rows else pose))
            added = True
        return self._merged() if added else []

    def _restart(self) -> None:
        for rows in self._rows.values():
            rows.clear()
        self._given_ns = BEFORE_ANY

    def _merged(self) -> list[Row]:
        every = list(self._rows.values())
        if not all(every):
            return []
        begin = max(self._given_ns + 1, max(rows[0][0] for rows in every))
        reach = min(rows[-1][0] for rows in every)
        stamps = sorted({row[0] for rows in every for row in rows if begin <= row[0] <= reach})
        if stamps:
            self._given_ns = stamps[-1]
        return [(stamp, sum((row_at(rows, stamp) or () for rows in every), ()))
                for stamp in stamps]


def _of_same_sign(pose: tuple[float, ...], before: tuple[float, ...]) -> tuple[float, ...]:
    """Return the pose with that of both quaternions of its orientation which is nearer."""
    a, b, c, d = pose[3:]
    if a * before[3] + b * before[4] + c * before[5] + d * before[6] >= 0.0:
        return pose
    return (*pose[:3], -a, -b, -c, -d)


class TransformModel:
    """
    Kinematics of the chain from a base frame to a tip frame, as tf publishes it.

    It stands in place of a `RobotModel`: q are the poses of the moving frames of the chain, 7
    numbers each, as `MovingFrames` gives them. Velocities are not known.

    base, tip: as given
    joint_names: the moving frames between base and tip, in the order of q
    root: highest frame that static transforms connect with the base; its z points up
    root_axes (3, 3): axes of the base in it
    """

    def __init__(self, tree: FrameTree, base: str, tip: str) -> None:
        self._tree, self.base, self.tip = tree, base, tip
        steps = tree.path(base, tip)
        if steps is None:
            raise ModelFileError(unconnected(tree, base, tip))
        self.joint_names = tuple(step.child for step in steps if step.child)
        if not self.joint_names:
            raise ModelFileError(
                f'only static transforms lie between kinematics.base {base!r} and kinematics.tip '
                f'{tip!r}; choose frames between which /tf has moving ones')
        self._places = {name: NUMBERS * k for k, name in enumerate(self.joint_names)}
        self.root, pose = tree.root_of(base)
        self.root_axes: Array = matrix_of(pose)
        self._steps = {tip: steps}

    links: frozenset[str] = frozenset()
    """None: what static transforms connect is part of the tree already."""

    def same_as(self, other: 'TransformModel') -> bool:
        """Return whether another model gives the same poses and the same direction of gravity."""
        return (self._steps[self.tip] == other._steps[other.tip]
                and np.array_equal(self.root_axes, other.root_axes))

    def pose(self, q: Sequence[float] | Array, frame: str | None = None) -> tuple[Array, Array]:
        """Return axes, as columns, and origin [m] of a frame (the tip) in the base; q (7 n,)."""
        pose = self._product(self._steps_to(frame or self.tip), np.asarray(q).tolist())
        return matrix_of(pose), np.array(pose[:3])

    def velocity(
        self, q: Sequence[float] | Array, q_dot: Sequence[float] | Array
    ) -> tuple[Array, Array, Array, Array]:
        """Return pose and velocity of the tip in the base frame; the velocity is NaN."""
        unknown = np.full(3, np.nan)
        return (*self.pose(q), unknown, unknown)

    def in_tip(self, frame: str) -> tuple[Array, Array] | None:
        """Return a frame's axes and origin [m] in the tip's; None if a moving one lies between."""
        self._steps_to(frame)
        steps = self._tree.path(self.tip, frame) or []
        if any(step.child for step in steps):
            return None
        pose = self._product(steps, [])
        return matrix_of(pose), np.array(pose[:3])

    def _steps_to(self, frame: str) -> list[Step]:
        if frame not in self._steps:
            steps = self._tree.path(self.base, frame)
            if steps is None:
                known = [*self._tree.fixed, *self._tree.moving]
                raise UnknownNameError.among('frame of tf', frame, known)
            other = [s.child for s in steps if s.child and s.child not in self._places]
            if other:
                raise ModelFileError(
                    f'frame {frame!r} moves with {", ".join(other)}, which does not lie between '
                    f'{self.base!r} and {self.tip!r}; choose a frame of the arm')
            self._steps[frame] = steps
        return self._steps[frame]

    def _product(self, steps: Sequence[Step], q: list[float]) -> Pose:
        pose = IDENTITY
        for child, up, own in steps:
            if child:
                place = self._places[child]
                own = normalised(q[place:place + NUMBERS])
                own = inverse(own) if up else own
            pose = product(pose, own)
        return pose


def unconnected(tree: FrameTree, base: str, tip: str) -> str:
    """Return why tf does not give the pose of a tip, with the frames nearest to it."""
    known = sorted({*tree.fixed, *tree.moving, *tree.moving.values(),
                    *(parent for parent, _ in tree.fixed.values())})
    for role, frame in (('base', base), ('tip', tip)):
        if frame not in known:
            there = ', '.join(known[:12]) + (', ...' if len(known) > 12 else '')
            return (f'tf has no frame {frame!r} (kinematics.{role}); it has {there or "none"}; is '
                    'the robot driver running, and /tf remapped?')
    roots = [tree.above(frame)[-1] for frame in (base, tip)]
    return (f'no transform of tf connects {base!r} with {tip!r}: they hang from {roots[0]!r} and '
            f'{roots[1]!r}; is one of the publishers of /tf or /tf_static missing?')
