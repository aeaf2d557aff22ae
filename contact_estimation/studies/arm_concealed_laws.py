# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Arms with a concealed law, simulated in MuJoCo: dynamics that share no code with the library."""

from __future__ import annotations

from functools import partial
from typing import Any, Sequence
from xml.etree import ElementTree

import numpy as np

from .arm_models import ARMS, Array, description_of, mujoco
from .blind_trials.arm_trials import Engine
from ..kinematics.arm_dynamics import ArmDynamics, PER_LINK
from ..kinematics.robot_model import pinocchio
from ..plant.arm_models import arm_description
from ..plant.arm_simulation import (
    ArmLaw, ArmSensors, changed, MOTOR, position_control, sensed, SimulatedArm, STEP_S)
from ..reference.arm_excitation import ArmTrajectory

_OF_JOINTS = {'coulomb_friction': 'dof_frictionloss', 'viscous_friction': 'dof_damping',
              'reflected_inertia': 'dof_armature', 'joint_spring': 'jnt_stiffness'}
_GEAR = '_gear'  # a second joint, in which a gear yields
_STOP = (0.004, 1.0)  # time constant [s] and damping ratio of the flanks of a gear
_LIGHT = '1e-6'  # [kg], [kg m^2]: MuJoCo requires an inertia of what lies between


def mujoco_arm(urdf: str, arm: ArmDynamics, yielding: Sequence[int] = ()) -> Any:
    """Build the MuJoCo model of a description with other links; `yielding` joints get a gear."""
    mj, root = mujoco(), ElementTree.fromstring(urdf)
    for j in yielding:
        _add_gear(root, arm.joints[j])
    compiler = ElementTree.SubElement(ElementTree.SubElement(root, 'mujoco'), 'compiler')
    compiler.attrib.update(fusestatic='true', balanceinertia='true')
    model = mj.MjModel.from_xml_string(ElementTree.tostring(root, encoding='unicode'))
    for j, (name, theta) in enumerate(zip(arm.joints, arm.neutral.reshape(-1, PER_LINK))):
        joint = model.joint(name + _GEAR if j in yielding else name)
        _set_inertia(mj, model, int(joint.bodyid[0]), theta)
    model.jnt_limited[:] = 0
    model.opt.timestep, model.opt.gravity[:] = STEP_S, arm.model.gravity.linear
    model.opt.integrator = mj.mjtIntegrator.mjINT_IMPLICITFAST
    mj.mj_setConst(model, mj.MjData(model))
    return model


def _add_gear(root: ElementTree.Element, name: str) -> None:
    """Let a joint move its motor, and a second one the link against the motor."""
    joint = next(one for one in root.findall('joint') if one.get('name') == name)
    child, axis = joint.find('child'), joint.find('axis')
    assert child is not None and axis is not None
    motor = ElementTree.SubElement(root, 'link', name=f'{name}_motor')
    inertial = ElementTree.SubElement(motor, 'inertial')
    ElementTree.SubElement(inertial, 'mass', value=_LIGHT)
    ElementTree.SubElement(inertial, 'inertia', {
        f'i{a}{b}': _LIGHT if a == b else '0' for a, b in ('xx', 'yy', 'zz', 'xy', 'xz', 'yz')})
    gear = ElementTree.SubElement(root, 'joint', name=name + _GEAR, type='continuous')
    ElementTree.SubElement(gear, 'parent', link=f'{name}_motor')
    ElementTree.SubElement(gear, 'child', link=str(child.get('link')))
    gear.append(axis)
    child.set('link', f'{name}_motor')


def _set_inertia(mj: Any, model: Any, body: int, theta: Array) -> None:
    """Give a body mass, centre and principal inertia."""
    own = pinocchio().Inertia.FromDynamicParameters(theta)
    principal, axes = np.linalg.eigh(own.inertia)
    axes[:, 0] *= np.linalg.det(axes)
    model.body_mass[body], model.body_ipos[body] = own.mass, own.lever
    model.body_inertia[body] = principal
    mj.mju_mat2Quat(model.body_iquat[body], axes.flatten())


def simulate(
    urdf: str, arm: ArmDynamics, wanted: ArmTrajectory, laws: Sequence[ArmLaw],
    sensors: ArmSensors, seed: int = 0, extra: Array | None = None, impedance: None = None,
) -> SimulatedArm:
    """Let an arm follow a trajectory in MuJoCo as `simulate_arm` does, its damping implicit."""
    mj, arm = mujoco(), changed(arm, laws)
    yielding = {law.place: law for law in laws if law.effect in ('joint_flexibility', 'backlash')}
    model = mujoco_arm(urdf, arm, list(yielding))
    dofs = np.array([int(model.joint(name).dofadr[0]) for name in arm.joints])
    for law in laws:
        if law.effect in _OF_JOINTS:
            getattr(model, _OF_JOINTS[law.effect])[dofs[law.place]] += law.theta[0]
    size, stiff, damp = position_control(arm, model.dof_armature[dofs])
    model.dof_damping[dofs] += damp
    for j, law in yielding.items():
        model.dof_armature[dofs[j]] = MOTOR * size[j]
        _yield(model, int(model.joint(arm.joints[j] + _GEAR).id), law, size[j])
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
        data.qpos[model.joint(arm.joints[j] + _GEAR).qposadr] = -bent * law.theta[0]
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


ENGINE = Engine({'planar_3r': partial(arm_description, 'planar_3r'),
                 **{name: partial(description_of, one) for name, one in ARMS.items()}}, simulate)
