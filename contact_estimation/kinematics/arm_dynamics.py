# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Rigid-body dynamics of a whole arm, by Pinocchio."""

from typing import Any, NamedTuple, Sequence

import numpy as np

from .description import joint_drives, link_masses
from .robot_model import Array, links_of, parsed_urdf, pinocchio, with_locked
from ..exceptions import ModelFileError, UnknownNameError

PER_LINK = 10
"""
Parameters of a link: mass, first moments m c (3), inertia at its joint (xx, xy, yy, xz, yz, zz).
"""

_PLACEHOLDER_KG, _PLACEHOLDER_KGM2 = 0.05, 1e-9  # no arm's heaviest link is lighter


class Outside(NamedTuple):
    """What acts on an arm from outside, as a sensor of force and torque measures it."""

    frame: str  # link in whose axes, and at whose origin, the wrench is measured
    wrench: Array  # (N, 6) of the environment on the arm: force [N], then torque [N m]


class ArmDynamics:
    """
    tau = RNEA(q, q', q''): M(q) q'' + C(q, q') q' + g(q) of the arm of a robot description.

    Joints of the description that are not named are locked at 0. Featherstone, Rigid Body Dynamics
    Algorithms, 2008, chapter 5.

    joints, links: the joints from base to tip, and the link that each of them moves
    neutral (10 n,): parameters of all links of the description, see `PER_LINK`; what a locked
    joint carries belongs to the link below
    friction, damping, armature (n,): of the joints, as <dynamics> of the description has them [N
    m], [N m s/rad], [kg m^2]; 0 where it has not. No method but `momentum` uses the armature
    model, data: as of Pinocchio
    """

    def __init__(self, urdf: str, joints: Sequence[str] | None = None) -> None:
        self._library = pin = pinocchio()
        drives = joint_drives(urdf)  # Pinocchio does not say which number is wrong
        full, given = parsed_urdf(pin, urdf), link_masses(urdf)
        self._alike = len(given) > 2 and len(set(given)) == 1
        names = list(full.names)[1:]
        for joint in joints or ():
            if joint not in names:
                raise UnknownNameError.among('joint of the robot description', joint, names)
        locked = [k for k in range(1, full.njoints)
                  if joints is not None and full.names[k] not in joints]
        self.model = with_locked(
            pin, full, locked, '', 'give the description of the arm alone')
        self.data = self.model.createData()
        self.joints = tuple(list(self.model.names)[1:])
        if not self.joints:
            raise ModelFileError(
                'the robot description must have joints that move, got none; give the '
                'description of the arm, with xacro expanded')
        self.links = tuple(_moved_link(self.model, k + 1) for k in range(len(self.joints)))
        self.neutral: Array = np.concatenate(
            [one.toDynamicParameters() for one in list(self.model.inertias)[1:]])
        self.friction, self.damping, self.armature = np.array(
            [drives[name] for name in self.joints]).T
        self._zero = pin.neutral(self.model)
        self._turns = self.model.nq != self.model.nv

    @property
    def frames(self) -> list[str]:
        """Names of all links."""
        return list(links_of(self.model))

    @property
    def masses(self) -> Array:
        """Masses of the links [kg], shape (n,)."""
        return self.neutral[::PER_LINK]

    @property
    def placeholder(self) -> str:
        """Say why the masses of the description cannot be those of an arm; '' if they may be."""
        heaviest, inertias = self.masses.max(), self.neutral.reshape(-1, PER_LINK)[:, 4:]
        if heaviest < _PLACEHOLDER_KG:
            return (f'its heaviest moving link has {heaviest:.3g} kg, expected at least '
                    f'{_PLACEHOLDER_KG:g} kg')
        if self._alike:
            return f'all of its links have the same mass of {heaviest:.3g} kg'
        if np.abs(inertias).max() < _PLACEHOLDER_KGM2:
            return 'no link has an inertia'
        return ''

    def configuration(self, q: Array) -> Array:
        """Return q of one instant as Pinocchio takes it: unlimited joints by cosine and sine."""
        return np.asarray(self._library.integrate(self.model, self._zero, q)) if self._turns else q

    def torque(self, q: Array, v: Array, a: Array) -> Array:
        """Return RNEA(q, q', q'') [N m] along a motion, all of shape (N, n)."""
        rnea, model, data = self._library.rnea, self.model, self.data
        return np.array([rnea(model, data, self.configuration(x), y, z)
                         for x, y, z in zip(q, v, a)])

    def jacobian(self, q: Array, frame: str) -> Array:
        """Return J(q) of a link in its own axes, linear rows first, shape (N, 6, n)."""
        if frame not in self.frames:
            raise UnknownNameError.among('link of the robot description', frame, self.frames)
        at = self.model.getFrameId(frame)
        return np.array([self._library.computeFrameJacobian(
            self.model, self.data, self.configuration(x), at) for x in q])

    def pose(self, q: Array, frame: str) -> tuple[Array, Array]:
        """Return axes, as columns (3, 3), and origin (3,) [m] of a link in the root, for one q."""
        pin = self._library
        pin.forwardKinematics(self.model, self.data, self.configuration(q))
        there = pin.updateFramePlacement(self.model, self.data, self.model.getFrameId(frame))
        return there.rotation.copy(), there.translation.copy()

    def axes(self, q: Array, frame: str) -> Array:
        """Return the axes of a link in those of the root, as columns, shape (N, 3, 3)."""
        return np.array([self.pose(x, frame)[0] for x in q])

    def torque_from(self, q: Array, outside: Outside | None) -> Array:
        """Return J(q)^T F of what acts on the arm, shape (N, n) [N m]."""
        if outside is None:
            return np.zeros(np.shape(q))
        return np.einsum('nij,ni->nj', self.jacobian(q, outside.frame), outside.wrench)

    def apparent_mass(self, q: Array, frame: str, normal: Array) -> Array:
        """Return the mass (N,) [kg] of a link along n (3,) of the root: 1 / (n . J M^-1 J^T n)."""
        # O. Khatib, A unified approach for motion and force control of robot manipulators, IEEE J.
        # Robotics and Automation 3(1), 1987, eq. (19).
        along = np.einsum('nij,j->ni', self.axes(q, frame).transpose(0, 2, 1), normal)
        rows = np.einsum('nij,ni->nj', self.jacobian(q, frame)[:, :3], along)
        return np.array([1.0 / (row @ np.linalg.solve(
            self._inertia(self.configuration(x)), row)) for x, row in zip(q, rows)])

    def regressor(self, q: Array, v: Array, a: Array) -> Array:
        """Return Y with tau = Y theta in the parameters of all links, shape (N, n, 10 n)."""
        each, model, data = self._library.computeJointTorqueRegressor, self.model, self.data
        return np.array([each(model, data, self.configuration(x), y, z)
                         for x, y, z in zip(q, v, a)])

    def derivatives(self, q: Array, v: Array, a: Array) -> tuple[Array, Array, Array]:
        """Return the derivatives of RNEA by q, q' and q'' (the mass matrix), (N, n, n) each."""
        each, model, data = self._library.computeRNEADerivatives, self.model, self.data
        by_q, by_v, by_a = zip(*(
            [one.copy() for one in each(model, data, self.configuration(x), y, z)]
            for x, y, z in zip(q, v, a)))
        return np.array(by_q), np.array(by_v), np.array(by_a)

    def tilt(self, q: Array) -> Array:
        """Return the torque per angle by which the base is tilted about y and -x, (N, n, 2)."""
        size, still = np.linalg.norm(self.model.gravity.linear), np.zeros_like(q)
        return np.stack([self.with_gravity(size * axis).torque(q, still, still)
                         for axis in np.eye(3)[:2]], axis=2)

    def forward(self, q: Array, v: Array, drag: Array) -> tuple[Array, Array]:
        """Return the inertia matrix M (n, n) and C q' + g + drag (n,) at one instant."""
        x = self.configuration(q)
        M = self._inertia(x)
        return M, self._library.nonLinearEffects(self.model, self.data, x, v) + drag

    def _inertia(self, x: Array) -> Array:
        """Return M at a configuration, of which Pinocchio fills the upper triangle only."""
        M = self._library.crba(self.model, self.data, x)
        return np.asarray(np.triu(M) + np.triu(M, 1).T)

    def momentum(self, q: Array, v: Array) -> tuple[Array, Array]:
        """Return p = (M + diag(armature)) q', and c^T q' - g: p' less torques, as M' = C + C^T."""
        pin, x = self._library, self.configuration(q)
        M = self._inertia(x)
        C = pin.computeCoriolisMatrix(self.model, self.data, x, v)
        g = pin.computeGeneralizedGravity(self.model, self.data, x)
        return M @ v + self.armature * v, C.T @ v - g

    def with_parameters(self, theta: Array) -> 'ArmDynamics':
        """Return the arm with other parameters of its links, shape (10 n,)."""
        other = object.__new__(ArmDynamics)
        other.__dict__.update(self.__dict__)
        other.model, other.neutral = self.model.copy(), np.asarray(theta, float)
        for k, one in enumerate(other.neutral.reshape(-1, PER_LINK)):
            other.model.inertias[k + 1] = self._library.Inertia.FromDynamicParameters(one)
        other.data = other.model.createData()
        return other

    def with_gravity(self, down: Array) -> 'ArmDynamics':
        """Return the arm under another gravity, shape (3,) [m/s^2] in axes of the root."""
        other = self.with_parameters(self.neutral)
        other.model.gravity.linear = np.asarray(down, float)
        return other

    @property
    def limits(self) -> dict[str, Array]:
        """Limits of position (2, n) [rad], velocity (n,) and effort (n,); inf where none."""
        index = [joint.idx_q for joint in list(self.model.joints)[1:]]
        single = np.array([joint.nq == 1 for joint in list(self.model.joints)[1:]])
        low, high = (np.where(single, values[index], end) for values, end in (
            (self.model.lowerPositionLimit, -np.inf), (self.model.upperPositionLimit, np.inf)))
        empty = ~(low < high)
        return {'position': np.array([np.where(empty, -np.inf, low),
                                      np.where(empty, np.inf, high)]),
                'velocity': _or_infinite(self.model.velocityLimit),
                'effort': _or_infinite(self.model.effortLimit)}

    def frame_positions(self, q: Array) -> Array:
        """Return the origins of base, joints and tip at one instant, shape (n + 2, 3) [m]."""
        pin = self._library
        pin.framesForwardKinematics(self.model, self.data, self.configuration(q))
        joints = [pose.translation.copy() for pose in list(self.data.oMi)[1:]]
        return np.array([np.zeros(3), *joints, self.data.oMf[self.model.nframes - 1].translation])


def _or_infinite(limit: Any) -> Array:
    values = np.asarray(limit, float)
    return np.where(values > 0.0, values, np.inf)


def _moved_link(model: Any, joint: int) -> str:
    """Return the first link that a joint moves."""
    return next((name for name, number in links_of(model).items()
                 if model.frames[number].parentJoint == joint), model.names[joint])
