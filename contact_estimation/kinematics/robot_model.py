# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Poses and velocities of an arm's frames from its joints, by Pinocchio."""

from types import ModuleType
from typing import Any, Sequence

import numpy as np
from numpy.typing import NDArray

from ..exceptions import MissingPackageError, ModelFileError, UnknownNameError

Array = NDArray[np.float64]
Pose = tuple[Array, Array]
"""Axes of a frame as columns of a rotation matrix (3, 3), and its origin (3,) [m]."""

_JOINT = ' (joint)'  # added to the name of a joint which its link has, too


class RobotModel:
    """
    Kinematics of the chain from a base frame to a tip frame.

    Joints of the description that do not move the tip relative to the base (fingers, a second arm)
    need not be known and do not appear.

    base, tip: as given
    joint_names: the n joints between base and tip, in the order of q
    continuous: for each joint, whether it turns without limits, so that its position is an angle
    modulo 2 pi
    root_axes (3, 3): axes of the base in the root of the description, whose z points up
    """

    def __init__(self, urdf: str, base: str, tip: str) -> None:
        self._library = pin = pinocchio()
        model = parsed_urdf(pin, urdf)
        self.base, self.tip = base, tip
        above_base = _joints_above(model, _frame(model, base))
        above_tip = _joints_above(model, _frame(model, tip))
        if above_tip[:len(above_base)] != above_base:
            wrong = [joint for joint in above_base if joint not in above_tip]
            raise ModelFileError(
                f'kinematics.base {base!r} must carry kinematics.tip {tip!r}, but '
                f'{_names(model, wrong)} moves the base and not the tip; choose a base nearer to '
                'the root of the description')
        chain = above_tip[len(above_base):]
        if not chain:
            raise ModelFileError(
                f'no joint moves kinematics.tip {tip!r} relative to kinematics.base {base!r}; '
                'choose a tip beyond the joints of the arm')
        fixed = [joint for joint in range(1, model.njoints) if joint not in chain]
        self._full, self._chain = model, frozenset([*above_base, *chain])
        self._model = with_locked(
            pin, model, fixed, f' between {base!r} and {tip!r}', 'choose another base or tip')
        self._data = self._model.createData()
        self.joint_names = tuple(self._model.names[1:])
        self.continuous = tuple(joint.nq == 2 for joint in self._model.joints[1:])
        self._neutral = pin.neutral(self._model) if any(self.continuous) else None
        self._frames: dict[str, int] = {}
        self._tip = self._place(tip)
        self._aligned = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
        pin.framesForwardKinematics(self._model, self._data, pin.neutral(self._model))
        base_pose = self._data.oMf[self._place(base)]
        self.root_axes: Array = base_pose.rotation.copy()
        self._from_root = self.root_axes.T
        self._root = base_pose.translation.copy()
        self._is_root = bool(np.array_equal(base_pose.homogeneous, np.eye(4)))

    @property
    def links(self) -> frozenset[str]:
        """Names of all links of the description."""
        return frozenset(links_of(self._full))

    @property
    def limits(self) -> dict[int, tuple[str, float, float]]:
        """Return by place in q, name and limits of each joint that turns within limits [rad]."""
        low, high = self._model.lowerPositionLimit, self._model.upperPositionLimit
        return {
            place: (name, float(low[joint.idx_q]), float(high[joint.idx_q]))
            for place, (name, joint) in enumerate(zip(self.joint_names, self._model.joints[1:]))
            if joint.nq == 1 and joint.shortname().startswith('JointModelR')
            and low[joint.idx_q] < high[joint.idx_q] < 1e9}

    def pose(self, q: Sequence[float] | Array, frame: str | None = None) -> Pose:
        """Return axes, as columns (3, 3), and origin (3,) [m] of a frame (the tip) in the base."""
        place = self._tip if frame is None else self._place(frame)
        self._library.forwardKinematics(self._model, self._data, self._configuration(q))
        return self._in_base(place)

    def velocity(
        self, q: Sequence[float] | Array, q_dot: Sequence[float] | Array
    ) -> tuple[Array, Array, Array, Array]:
        """Return R, p, and J(q) q_dot: p' [m/s] and omega [rad/s], of the tip in the base."""
        pin, model, data = self._library, self._model, self._data
        pin.forwardKinematics(model, data, self._configuration(q), np.asarray(q_dot, float))
        twist = pin.getFrameVelocity(model, data, self._tip, self._aligned)
        R, p = self._in_base(self._tip)
        if self._is_root:
            return R, p, twist.linear, twist.angular
        return R, p, self._from_root @ twist.linear, self._from_root @ twist.angular

    def jacobian(self, q: Sequence[float] | Array, frame: str | None = None) -> Array:
        """Return J (6, n) of the origin of a frame (the tip) in base axes, linear rows first."""
        place = self._tip if frame is None else self._place(frame)
        J = self._library.computeFrameJacobian(
            self._model, self._data, self._configuration(q), place, self._aligned)
        return np.vstack([self._from_root @ J[:3], self._from_root @ J[3:]])

    def in_tip(self, frame: str) -> Pose | None:
        """Return axes and origin [m] of a frame in the tip's; None where a joint lies between."""
        other, tip = (self._model.frames[place] for place in (self._place(frame), self._tip))
        if other.parentJoint != tip.parentJoint:
            return None
        pose = tip.placement.actInv(other.placement)
        return pose.rotation, pose.translation

    def _in_base(self, place: int) -> Pose:
        pose = self._library.updateFramePlacement(self._model, self._data, place)
        if self._is_root:
            return pose.rotation.copy(), pose.translation.copy()
        return (self._from_root @ pose.rotation, self._from_root @ (pose.translation - self._root))

    def _configuration(self, q: Sequence[float] | Array) -> Array:
        angles = np.asarray(q, float)
        if self._neutral is None:
            return angles
        # Pinocchio represents an unlimited joint by cosine and sine.
        return self._library.integrate(self._model, self._neutral, angles)  # type: ignore

    def _place(self, frame: str) -> int:
        """Return the index of a frame whose pose the chain's joints determine."""
        if frame not in self._frames:
            above = _joints_above(self._full, _frame(self._full, frame))
            unknown = [joint for joint in above if joint not in self._chain]
            if unknown:
                raise ModelFileError(
                    f'frame {frame!r} is moved by {_names(self._full, unknown)}, which do not lie '
                    f'between {self.base!r} and {self.tip!r}; choose a frame of the arm')
            self._frames[frame] = _frame(self._model, frame)
        return self._frames[frame]


def pinocchio() -> ModuleType:
    """Import Pinocchio, which is optional."""
    try:
        import pinocchio
    except ImportError as error:
        raise MissingPackageError(
            'kinematics of an arm needs Pinocchio, which is not installed; install it with: '
            "pip install 'contact_estimation[robots]' (PyPI: pin), or on ROS 2 Jazzy with: "
            'apt install ros-jazzy-pinocchio'
        ) from error
    return pinocchio


def parsed_urdf(pin: Any, urdf: str) -> Any:
    try:
        return pin.buildModelFromXML(urdf)
    except Exception as error:  # noqa: B902 - the type differs between versions
        reason = ' '.join(str(error).split()) or type(error).__name__
        raise ModelFileError(
            f'robot description ({len(urdf)} characters, beginning {urdf[:40]!r}) must be a URDF '
            f'that Pinocchio can read: {reason}; xacro files must be expanded first'
        ) from error


def with_locked(
    pin: Any, model: Any, locked: Sequence[int], which: str, remedy: str
) -> Any:
    """Lock joints at 0, but those `which` move; a link's name is then that of no other frame."""
    links = links_of(model)
    for number, frame in enumerate(model.frames):
        if links.get(frame.name, number) != number:
            frame.name += _JOINT
    for joint in locked:  # becomes a frame of its name
        if model.names[joint] in links:
            model.names[joint] += _JOINT
    reduced = pin.buildReducedModel(model, list(locked), pin.neutral(model))
    wide = [name for name, joint in zip(list(reduced.names)[1:], list(reduced.joints)[1:])
            if joint.nv != 1]
    if wide:
        raise ModelFileError(f'each joint{which} must have one degree of freedom, got {wide} with '
                             f'more; {remedy}')
    return reduced


def _frame(model: Any, name: str) -> int:
    """Return the index of a link; a joint of the same name is another frame."""
    links = links_of(model)
    if name not in links:
        raise UnknownNameError.among('link of the robot description', name, links)
    return links[name]


def links_of(model: Any) -> dict[str, int]:
    return {frame.name: number for number, frame in enumerate(model.frames)
            if 'BODY' in str(frame.type)}


def _joints_above(model: Any, frame: int) -> list[int]:
    """Return the indices of the joints between root and frame, root first."""
    joint = model.frames[frame].parentJoint
    return [int(above) for above in model.supports[joint] if above != 0]


def _names(model: Any, joints: Sequence[int]) -> str:
    return ', '.join(model.names[joint] for joint in joints)
