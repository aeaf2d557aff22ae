# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The corrected description: URDF, and what MuJoCo takes of it."""

from xml.etree import ElementTree

import numpy as np
from scipy.optimize import least_squares

from .arm_recording import Array
from .result import ArmDiagnosis
from ...kinematics.arm_dynamics import ArmDynamics, PER_LINK
from ...kinematics.robot_model import pinocchio

_LEAST = 1e-9  # eigenvalue of a pseudo-inertia that counts as positive
_GYRATION_M = 0.05  # with which the search for a body begins


def is_body(theta: Array) -> bool:
    """Return whether a body can have ten parameters: its pseudo-inertia is positive definite."""
    pseudo = pinocchio().PseudoInertia.FromDynamicParameters(theta).toMatrix()
    return bool(np.linalg.eigvalsh(pseudo).min() > _LEAST)


def possible_inertial(theta: Array, covariance: Array) -> Array:
    """
    Return the likeliest parameters (10,) that a body, or a negative one for a lack, can have.

    theta (10,) and covariance (10, 10) are those of the fit. Log-Cholesky parameters: C. Rucker
    and P. M. Wensing, IEEE RA-L 7(2), 2022.
    """
    sign = 1.0 if theta[0] >= 0.0 else -1.0
    if is_body(sign * theta):
        return theta
    log_cholesky = pinocchio().LogCholeskyParameters
    whiten = np.linalg.inv(np.linalg.cholesky(covariance + 1e-12 * np.diag(np.diag(covariance))))

    def body(x: Array) -> Array:
        return np.asarray(sign * log_cholesky(x).toDynamicParameters())

    start = np.zeros(10)
    start[:4] = 0.5 * np.log(max(abs(theta[0]), 1e-3)), *3 * [np.log(_GYRATION_M)]
    found = least_squares(lambda x: whiten @ (body(x) - theta), start, method='trf', max_nfev=200)
    return body(found.x)


_WRITTEN = ('coulomb_friction', 'viscous_friction', 'payload', 'link_inertia')


def joint_values(d: ArmDiagnosis) -> dict[str, dict[str, float]]:
    """Return friction [N m], damping [N m s/rad] and armature [kg m^2] of each joint."""
    found = {one.name: {key: value for key, value in zip(('friction', 'damping'), one.friction)
                        if value > 0.0} for one in d.joints}
    for one in d.effects:
        if one.name == 'reflected_inertia':
            found[one.joints[0]]['armature'] = one.parameters['I_r'].value
    return {name: values for name, values in found.items() if values}


def link_parameters(d: ArmDiagnosis) -> Array:
    """Return the ten parameters of each link, corrected, shape (n, 10)."""
    assert d.channels is not None and d.fitted is not None
    nominal = d.channels.arm.neutral.reshape(-1, PER_LINK)
    calibrated = nominal + d.fitted.calibration.reshape(-1, PER_LINK)
    # The torques tell sums of links, and not each: what no body can be keeps its own parameters.
    links = np.where(np.array([*map(is_body, calibrated)])[:, None], calibrated, nominal)
    for one in d.effects:
        if one.family == 'load' and not one.recording:
            changed = links[one.term.place] + [value.value for value in one.parameters.values()]
            if is_body(changed):
                links[one.term.place] = changed
    return np.asarray(links)


def corrected_urdf(d: ArmDiagnosis, urdf: str) -> str:
    """Return a robot description with friction, damping and inertial parameters."""
    assert d.channels is not None
    root, arm = ElementTree.fromstring(urdf), d.channels.arm
    joints = {one.get('name'): one for one in root.findall('joint')}
    for name, values in joint_values(d).items():
        dynamics = joints[name].find('dynamics')
        if dynamics is None:
            dynamics = ElementTree.SubElement(joints[name], 'dynamics')
        for key in ('damping', 'friction', 'armature'):
            if key in values:
                dynamics.set(key, f'{values[key]:.6g}')
    links = {one.get('name'): one for one in root.findall('link')}
    for name, theta, body in zip(arm.links, link_parameters(d), _bodies(arm, root)):
        if body == 1:  # what is fixed to a link would be counted twice
            _set_inertial(links[name], theta)
    other = [f'{one.name} at {one.place}: ' + ', '.join(
        f'{key} = {value.value:.4g}' for key, value in one.parameters.items())
        for one in d.effects if one.name not in _WRITTEN]
    if other:
        root.insert(0, ElementTree.Comment(' not in URDF: ' + '; '.join(other) + ' '))
    return ElementTree.tostring(root, encoding='unicode') + '\n'


def _bodies(arm: ArmDynamics, root: ElementTree.Element) -> list[int]:
    """Return the number of links with a mass that move with each joint."""
    massive = {one.get('name') for one in root.findall('link') if one.find('inertial') is not None}
    return [sum(frame.parentJoint == k + 1 and frame.name in massive
                for frame in arm.model.frames if 'BODY' in str(frame.type))
            for k in range(len(arm.joints))]


def _set_inertial(link: ElementTree.Element, theta: Array) -> None:
    """Write mass, centre, and inertia about the centre."""
    inertial = link.find('inertial')
    if inertial is not None:
        link.remove(inertial)
    inertial = ElementTree.SubElement(link, 'inertial')
    own = pinocchio().Inertia.FromDynamicParameters(theta)
    ElementTree.SubElement(
        inertial, 'origin', xyz=' '.join(f'{x:.6g}' for x in own.lever), rpy='0 0 0')
    ElementTree.SubElement(inertial, 'mass', value=f'{own.mass:.6g}')
    ElementTree.SubElement(inertial, 'inertia', {
        f'i{"xyz"[i]}{"xyz"[k]}': f'{own.inertia[i, k]:.6g}'
        for i in range(3) for k in range(i, 3)})


def mjcf_snippet(d: ArmDiagnosis) -> str:
    """Return the attributes of each joint for a MuJoCo model."""
    rows = []
    for name, values in joint_values(d).items():
        text = ' '.join(f'{key}="{values[of]:.6g}"' for key, of in (
            ('frictionloss', 'friction'), ('damping', 'damping'), ('armature', 'armature'))
            if of in values)
        rows.append(f'  <joint name="{name}" {text}/>')
    return '\n'.join(['<mujoco>', *rows, '</mujoco>', ''])
