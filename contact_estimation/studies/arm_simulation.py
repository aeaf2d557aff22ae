# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Arms in MuJoCo: under an impedance controller at a wall, or with a law concealed in a joint."""

from dataclasses import dataclass
from functools import partial
from typing import Any, Callable, NamedTuple, Sequence

import numpy as np

from .arm_models import (
    Arm, ARMS, Array, description_of, GEAR, mujoco, mujoco_arm, mujoco_model, TIP)
from .blind_trials.arm_trials import Engine
from .paths import path_at, Piece, ramp, start, tones
from ..kinematics.arm_dynamics import ArmDynamics
from ..kinematics.tool_load import cross_matrix
from ..plant.arm_models import arm_description
from ..plant.arm_simulation import (
    ArmLaw, ArmSensors, changed, MOTOR, position_control, sensed, SimulatedArm, STEP_S)
from ..reference.arm_excitation import ArmTrajectory

TIMESTEP = 1e-3
MOVE_S = 1.0
_TOUCHES = ((0.016, 2.4), (0.022, 4.0), (0.028, 4.0))  # depth of x_r [m], duration [s]
_FREE_S, _BETWEEN_S = 3.0, 0.7  # before the first touch; after each
_APART = -0.012  # x_r between touches [m]
_FREQUENCIES = (0.7, 1.9, 4.3)  # of the excitation [Hz]
_AMPLITUDE, _FADE_S = 0.003, 0.5  # of each [m]
_POSE_S, _TURN_S = 1.2, 1.5


class Reference(NamedTuple):
    """Reference along one coordinate, or of all joints, on the grid of the simulation."""

    # x, v, a (N,) or (N, n): position [m] or [rad] and its derivatives
    x: Array
    v: Array
    a: Array

    @classmethod
    def of(cls, pieces: Sequence[Piece], duration: float) -> 'Reference':
        """Sample a path of pieces."""
        t: Array = TIMESTEP * np.arange(round(duration / TIMESTEP), dtype=float)
        return cls(*path_at(pieces, t))


def touches(seed: int) -> Reference:
    """Return a reference with three touches of a wall at 0, excited by sines."""
    phases = np.random.default_rng(seed).uniform(0.0, 2.0 * np.pi, len(_FREQUENCIES))
    omegas = 2.0 * np.pi * np.array(_FREQUENCIES)
    pieces, t = [start(_APART)], _FREE_S
    for depth, hold in _TOUCHES:
        t += MOVE_S
        pieces += [ramp(t - MOVE_S, MOVE_S, depth - _APART),
                   tones(t, t + hold, _AMPLITUDE, omegas, phases - omegas * t, _FADE_S),
                   ramp(t + hold, MOVE_S, _APART - depth)]
        t += hold + MOVE_S + _BETWEEN_S
    return Reference.of(pieces, t)


def poses(home: tuple[float, ...], count: int, seed: int) -> Reference:
    """Return a reference of all joints from home through orientations of the wrist [rad]."""
    rng, here = np.random.default_rng(seed), np.array(home)
    moves = Reference(*(np.tile(here, (round(count * (_TURN_S + _POSE_S) / TIMESTEP), 1)) * once
                        for once in (1.0, 0.0, 0.0)))
    for k in range(count):
        there = np.array(home)
        there[-3:] += rng.uniform(-1.0, 1.0, 3) * (1.4, 1.3, 1.5)
        move = ramp(k * (_TURN_S + _POSE_S), _TURN_S, 1.0)
        shares = Reference.of([move], count * (_TURN_S + _POSE_S))
        moves = Reference(*(so_far + np.outer(share, there - here)
                            for so_far, share in zip(moves, shares)))
        here = there
    return moves


WALL_DISTANCE = 0.012  # from the home pose [m]
_TILT = 0.25  # of the normal against the tool's axis [rad]
_STIFF = 60.0  # bandwidth of the other coordinates [rad/s]
_JOINT_BANDWIDTH = 25.0  # of the motion through poses [rad/s]
_WELL_DAMPED = 0.8


@dataclass(frozen=True)
class World:
    """Wall, target impedance and what is concealed."""

    # K_e, B_e: of the wall [N/m], [N s/m]
    K_e: float = 5000.0
    B_e: float = 80.0
    K_t: float = 2000.0  # stiffness of the target impedance along the normal [N/m]
    friction: float = 0.0  # dry friction of the joints, as a force along the normal [N]


@dataclass(frozen=True)
class Run:
    """Signals of a simulation, one row a time step."""

    # q, q_dot (N, n): joints [rad], [rad/s]
    q: Array
    q_dot: Array
    # (N, 6) what a wrist sensor measures, without noise and bias, in its own axes [N], [N m]
    wrench: Array
    position: Array  # (N,) x of the tip along the normal, from the base's origin [m]
    force: Array  # (N,) F_e of the wall [N]
    # x_r along the normal, from the base's origin; of the joints in free flight
    reference: Reference
    normal: Array  # (3,) into the wall
    location: float  # x_e [m]
    impedance: dict[str, float]  # target impedance: mass, damping, stiffness


class ArmSimulation:
    """One arm, its wall and its controller."""

    def __init__(self, arm: Arm, urdf: str, world: World) -> None:
        self._mj, self._world = mujoco(), world
        self._model = mujoco_model(urdf, TIMESTEP)
        self._data = self._mj.MjData(self._model)
        self._home = np.array(arm.home)
        self._data.qpos[:] = self._home
        self._mj.mj_forward(self._model, self._data)
        self._tip = self._model.site(TIP).id
        self._R0, self._p0 = self._tip_pose()
        turned = np.array([np.sin(_TILT), 0.0, np.cos(_TILT)])
        self.normal = self._R0 @ turned
        # Rows: the normal and two tangents.
        self._E = np.vstack([self.normal, np.linalg.svd(self.normal[None])[2][1:]])
        self.location = float(self.normal @ self._p0) + WALL_DISTANCE
        J = self._jacobian()
        mobility = J @ np.linalg.solve(self._mass_matrix(), J.T)
        self.M_t = 1.0 / float(mobility[0, 0])
        self.B_t = 2.0 * _WELL_DAMPED * float(np.sqrt(world.K_t * self.M_t))
        self._model.dof_frictionloss[:] = self._joint_friction(J)

    def touch(self, seed: int) -> Run:
        """Press three times along the normal under impedance control."""
        reference = touches(seed)
        reference = reference._replace(x=reference.x + self.location)
        world = self._world
        return self._run(reference, self._impedance_torque, world.K_e, world.B_e)

    def calibrate(self, seed: int, count: int = 12) -> Run:
        """Visit poses under joint control, with the wall removed."""
        reference = poses(tuple(self._home), count, seed)
        return self._run(reference, self._joint_torque, K_e=0.0, B_e=0.0)

    def _run(
        self, reference: Reference, torque: Callable[[Any, Any, Any, float], Array],
        K_e: float, B_e: float,
    ) -> Run:
        mj, model, data = self._mj, self._model, self._data
        mj.mj_resetData(model, data)
        data.qpos[:] = self._home
        rows = []
        for x_r, v_r, a_r in zip(*reference):
            mj.mj_step1(model, data)
            position, pressing = self._wall(K_e, B_e)
            data.qfrc_applied[:] = torque(x_r, v_r, a_r, pressing)
            state = data.qpos.copy(), data.qvel.copy()
            self._press(pressing * self.normal)
            mj.mj_step2(model, data)
            rows.append((*state, -data.sensordata, position, pressing))
        q, q_dot, wrench, x, F_e = [np.array(column, float) for column in zip(*rows)]
        impedance = {'mass': self.M_t, 'damping': self.B_t, 'stiffness': self._world.K_t}
        return Run(q, q_dot, wrench, x, F_e, reference, self.normal, self.location, impedance)

    def _wall(self, K_e: float, B_e: float) -> tuple[float, float]:
        """Return x and F_e."""
        x = float(self.normal @ self._data.site(TIP).xpos)
        delta, v = x - self.location, float((self._jacobian() @ self._data.qvel)[0])
        pressing = K_e * delta + B_e * v
        return x, -max(pressing, 0.0) if delta > 0.0 else 0.0

    def _press(self, force: Array) -> None:
        """Apply a force at the tip, beyond the sensor; MuJoCo takes it at the body's centre."""
        body = self._data.body(TIP)
        arm = self._data.site(TIP).xpos - body.xipos
        body.xfrc_applied[:] = np.concatenate([force, cross_matrix(arm) @ force])

    def _impedance_torque(self, x_r: float, v_r: float, a_r: float, F_e: float) -> Array:
        data, J = self._data, self._jacobian()
        R, p = self._tip_pose()
        v = J @ data.qvel
        S = R @ self._R0.T  # half the sum of the cross products of both frames' axes
        turned = 0.5 * np.array([S[1, 2] - S[2, 1], S[2, 0] - S[0, 2], S[0, 1] - S[1, 0]])
        error = np.concatenate([self._E @ (self._p0 - p), self._E @ turned])
        wanted = _STIFF**2 * error - 2.0 * _STIFF * v
        x = float(self.normal @ p)
        K_t = self._world.K_t
        wanted[0] = a_r + (self.B_t * (v_r - v[0]) + K_t * (x_r - x) + F_e) / self.M_t
        M = self._mass_matrix()
        to_joints = np.linalg.solve(M, J.T)  # (n, 6)
        task = np.linalg.solve(J @ to_joints, wanted - self._jacobian_rate() @ data.qvel)
        posture = _JOINT_BANDWIDTH**2 * (self._home - data.qpos) - (
            2.0 * _JOINT_BANDWIDTH * data.qvel)
        null = posture - to_joints @ np.linalg.solve(J @ to_joints, J @ posture)
        return np.asarray(J.T @ task - J[0] * F_e + M @ null + data.qfrc_bias)

    def _joint_torque(self, q_r: Array, v_r: Array, a_r: Array, F_e: float) -> Array:
        data, bandwidth = self._data, _JOINT_BANDWIDTH
        wanted = a_r + bandwidth**2 * (q_r - data.qpos) + 2.0 * bandwidth * (v_r - data.qvel)
        return np.asarray(self._mass_matrix() @ wanted + data.qfrc_bias)

    def _joint_friction(self, J: Array) -> Array:
        """Return equal dry friction of all joints that amounts to a force along the normal."""
        to_joints = np.linalg.solve(self._mass_matrix(), J.T)
        motion = to_joints @ np.linalg.solve(J @ to_joints, np.eye(6)[0])  # q_dot for v = 1
        felt = self.M_t * float(J[0] @ np.linalg.solve(self._mass_matrix(), np.sign(motion)))
        return np.full(len(motion), self._world.friction / abs(felt))

    def _mass_matrix(self) -> Array:
        M = np.empty((self._model.nv, self._model.nv))
        for row, unit in zip(M, np.eye(len(M))):  # mj_fullM differs between MuJoCo 3 and 4
            self._mj.mj_mulM(self._model, self._data, row, unit)
        return M

    def _jacobian(self) -> Array:
        """Return the Jacobian of the tip in the axes of normal and tangents, (6, n)."""
        J = np.zeros((6, self._model.nv))
        self._mj.mj_jacSite(self._model, self._data, J[:3], J[3:], self._tip)
        return np.vstack([self._E @ J[:3], self._E @ J[3:]])

    def _jacobian_rate(self) -> Array:
        J = np.zeros((6, self._model.nv))
        point, body = self._data.site(TIP).xpos, self._model.site(TIP).bodyid[0]
        self._mj.mj_jacDot(self._model, self._data, J[:3], J[3:], point, body)
        return np.vstack([self._E @ J[:3], self._E @ J[3:]])

    def _tip_pose(self) -> tuple[Array, Array]:
        site = self._data.site(TIP)
        return site.xmat.reshape(3, 3).copy(), site.xpos.copy()


# -- concealed laws ---------------------------------------------------------------------------

_OF_JOINTS = {'coulomb_friction': 'dof_frictionloss', 'viscous_friction': 'dof_damping',
              'reflected_inertia': 'dof_armature', 'joint_spring': 'jnt_stiffness'}
_STOP = (0.004, 1.0)  # time constant [s] and damping ratio of the flanks of a gear


def simulate_concealed(
    urdf: str, arm: ArmDynamics, wanted: ArmTrajectory, laws: Sequence[ArmLaw],
    sensors: ArmSensors, seed: int = 0, extra: Array | None = None, impedance: None = None,
) -> SimulatedArm:
    """Let an arm follow a trajectory in MuJoCo as `simulate_arm` does, its damping implicit."""
    mj, arm = mujoco(), changed(arm, laws)
    yielding = {law.place: law for law in laws if law.effect in ('joint_flexibility', 'backlash')}
    model = mujoco_arm(urdf, arm, STEP_S, list(yielding))
    dofs = np.array([int(model.joint(name).dofadr[0]) for name in arm.joints])
    for law in laws:
        if law.effect in _OF_JOINTS:
            getattr(model, _OF_JOINTS[law.effect])[dofs[law.place]] += law.theta[0]
    size, stiff, damp = position_control(arm, model.dof_armature[dofs])
    model.dof_damping[dofs] += damp
    for j, law in yielding.items():
        model.dof_armature[dofs[j]] = MOTOR * size[j]
        _yield(model, int(model.joint(arm.joints[j] + GEAR).id), law, size[j])
    times = np.arange(wanted.t[0], wanted.t[-1], STEP_S)
    q_d, v_d, feed, pushed = (
        np.stack([np.interp(times, wanted.t, column) for column in one.T], axis=1)
        for one in (wanted.q, wanted.v, arm.torque(wanted.q, wanted.v, wanted.a),
                    np.zeros_like(wanted.q) if extra is None else extra))
    data = mj.MjData(model)
    mj.mj_setConst(model, data)  # friction and stops are as stiff as the inertias ask for
    data.qpos[dofs] = q_d[0]
    for j, law in yielding.items():  # at rest the link hangs in its gear
        bent = feed[0, j] if law.effect == 'joint_flexibility' else 0.5 * np.sign(feed[0, j])
        data.qpos[model.joint(arm.joints[j] + GEAR).qposadr] = -bent * law.theta[0]
    q, v, tau = (np.empty_like(feed) for _ in range(3))
    for k in range(len(times)):
        q[k], v[k] = data.qpos[dofs], data.qvel[dofs]
        u = feed[k] + stiff * (q_d[k] - q[k]) + damp * v_d[k]
        data.qfrc_applied[dofs] = u + pushed[k]
        mj.mj_step(model, data)
        tau[k] = u - damp * data.qvel[dofs]
    return sensed(times, q, v, tau, laws, sensors, np.random.default_rng(seed))


def _yield(model: Any, gear: int, law: ArmLaw, size: float) -> None:
    """Make a joint a spring, or free between two stops."""
    if law.effect == 'joint_flexibility':
        K = 1.0 / law.theta[0]
        model.jnt_stiffness[gear] = K
        model.dof_damping[model.jnt_dofadr[gear]] = 0.1 * np.sqrt(K * size)
    else:
        model.jnt_limited[gear] = 1
        model.jnt_range[gear] = np.array([-0.5, 0.5]) * law.theta[0]
        model.jnt_solref[gear] = _STOP


ENGINE = Engine(
    {'planar_3r': partial(arm_description, 'planar_3r'),
     **{name: partial(description_of, one) for name, one in ARMS.items()}}, simulate_concealed)
"""Arms with a concealed law, whose dynamics share no code with the library."""
