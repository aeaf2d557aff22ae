# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The corrected description: URDF, and what MuJoCo takes of it."""

from xml.etree import ElementTree

import numpy as np

from .arm_recording import Array
from .bodies import is_body
from .result import ArmDiagnosis
from ...kinematics.arm_dynamics import ArmDynamics, PER_LINK
from ...kinematics.robot_model import pinocchio

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
