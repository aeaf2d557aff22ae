# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Poses of an arm's frames from the transforms of tf, in place of its joints."""

from __future__ import annotations

from typing import Sequence

import numpy as np
from numpy.typing import NDArray

from .frame_tree import FrameTree, Step
from .moving_frames import NUMBERS
from .poses import IDENTITY, inverse, matrix_of, normalised, Pose, product
from ..exceptions import ModelFileError, UnknownNameError

Array = NDArray[np.float64]


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
                f'{tip!r}; choose frames between which /tf has moving ones'
            )
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
        """
        Return the pose of a frame in the base frame.

        q (7 n,): poses of the moving frames
        frame: A frame; the tip by default
        Returns R, p: its axes as columns, and its origin [m]
        """
        pose = self._product(self._steps_to(frame or self.tip), np.asarray(q).tolist())
        return matrix_of(pose), np.array(pose[:3])

    def velocity(
        self, q: Sequence[float] | Array, q_dot: Sequence[float] | Array
    ) -> tuple[Array, Array, Array, Array]:
        """Return pose and velocity of the tip in the base frame; the velocity is NaN."""
        unknown = np.full(3, np.nan)
        return (*self.pose(q), unknown, unknown)

    def in_tip(self, frame: str) -> tuple[Array, Array] | None:
        """
        Return the pose of a frame that is fixed to the tip.

        Returns R, p: its axes and origin [m] in the tip's frame; None where a moving frame lies
        between them
        """
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
                    f'{self.base!r} and {self.tip!r}; choose a frame of the arm'
                )
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
