# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Two public arms with a wrist sensor and a tool, and the MuJoCo models of any arm."""

from dataclasses import dataclass
from pathlib import Path
import sys
from typing import Any, Sequence
from xml.etree import ElementTree

import numpy as np

from ..exceptions import MissingPackageError
from ..kinematics.arm_dynamics import ArmDynamics, PER_LINK
from ..kinematics.robot_model import pinocchio
from ..physics.numeric import Array

SENSOR, TOOL, TIP = 'ft_sensor', 'tool', 'tool_tip'
TOOL_MASS, TOOL_CENTRE = 1.2, (0.012, -0.018, 0.061)  # [kg], [m] in the sensor's frame
_TOOL_INERTIA = (0.0022, 0.0024, 0.0011)  # about its centre [kg m^2]
GEAR = '_gear'  # ends the name of a second joint, in which a gear yields
_LIGHT = 1e-6  # [kg], [kg m^2]: MuJoCo requires an inertia of what lies between
_SENSOR_RPY, _TIP_XYZ = (0.0, 0.0, 0.6), (0.0, 0.0, 0.17)


@dataclass(frozen=True)
class Arm:
    """One of the arms, its pose at the wall and the rates of its topics."""

    # name, description: name, and the file in the package example-robot-data
    name: str
    description: str
    # base, flange: links
    base: str
    flange: str
    removed: tuple[str, ...]  # links beyond the flange that the tool replaces
    home: tuple[float, ...]  # joints in front of the wall [rad]
    # joint_period, wrench_period: time between messages [ms]
    joint_period: int
    wrench_period: int


ARMS = {
    'panda': Arm(
        'panda', 'panda_description/urdf/panda.urdf', 'panda_link0', 'panda_link8',
        ('panda_hand', 'panda_hand_tcp', 'panda_leftfinger', 'panda_rightfinger'),
        (0.2, -0.4, 0.1, -2.1, 0.2, 1.9, 0.6), 2, 1),
    'ur5': Arm(
        'ur5', 'ur_description/urdf/ur5_robot.urdf', 'base_link', 'tool0', (),
        (0.3, -1.3, 1.7, -1.4, -1.3, 0.4), 8, 2),
}


def mujoco() -> Any:
    """Import MuJoCo, which is optional."""
    try:
        import mujoco as package
    except ImportError as error:
        raise MissingPackageError.of('mujoco', 'simulating arms') from error
    return package


def description_of(arm: Arm) -> str:
    """Return the description of an arm with sensor and tool."""
    folders = (Path(place, 'cmeel.prefix/share/example-robot-data/robots') for place in sys.path)
    file = next((f / arm.description for f in folders if (f / arm.description).is_file()), None)
    if file is None:
        raise MissingPackageError.of('example-robot-data', f'the description of {arm.name}')
    robot = ElementTree.parse(file).getroot()
    _strip(robot, arm.removed)
    _add_link(robot, SENSOR, arm.flange, rpy=_SENSOR_RPY)
    _add_inertia(_add_link(robot, TOOL, SENSOR), TOOL_MASS, TOOL_CENTRE, _TOOL_INERTIA)
    _add_link(robot, TIP, TOOL, xyz=_TIP_XYZ)
    return ElementTree.tostring(robot, encoding='unicode')


def mujoco_model(urdf: str, timestep: float) -> Any:
    """Build the MuJoCo model of a description, with a force and a torque sensor at the wrist."""
    package, robot = mujoco(), ElementTree.fromstring(urdf)
    extension = ElementTree.SubElement(robot, 'mujoco')
    ElementTree.SubElement(extension, 'compiler', fusestatic='false', balanceinertia='true')
    spec = package.MjSpec.from_string(ElementTree.tostring(robot, encoding='unicode'))
    spec.body(TOOL).add_site(name=SENSOR)
    spec.body(TIP).add_site(name=TIP)
    for kind, name in ((package.mjtSensor.mjSENS_FORCE, 'force'),
                       (package.mjtSensor.mjSENS_TORQUE, 'torque')):
        spec.add_sensor(type=kind, name=name, objname=SENSOR, objtype=package.mjtObj.mjOBJ_SITE)
    spec.option.timestep = timestep
    return spec.compile()


def mujoco_arm(urdf: str, arm: ArmDynamics, timestep: float, yielding: Sequence[int] = ()) -> Any:
    """Build the MuJoCo model of a description with other links; `yielding` joints get a gear."""
    mj, root = mujoco(), ElementTree.fromstring(urdf)
    for j in yielding:
        _add_gear(root, arm.joints[j])
    compiler = ElementTree.SubElement(ElementTree.SubElement(root, 'mujoco'), 'compiler')
    compiler.attrib.update(fusestatic='true', balanceinertia='true')
    model = mj.MjModel.from_xml_string(ElementTree.tostring(root, encoding='unicode'))
    for j, (name, theta) in enumerate(zip(arm.joints, arm.neutral.reshape(-1, PER_LINK))):
        joint = model.joint(name + GEAR if j in yielding else name)
        _set_inertia(mj, model, int(joint.bodyid[0]), theta)
    model.jnt_limited[:] = 0
    model.opt.timestep, model.opt.gravity[:] = timestep, arm.model.gravity.linear
    model.opt.integrator = mj.mjtIntegrator.mjINT_IMPLICITFAST
    mj.mj_setConst(model, mj.MjData(model))
    return model


def _add_gear(root: ElementTree.Element, name: str) -> None:
    """Let a joint move its motor, and a second one the link against the motor."""
    joint = next(one for one in root.findall('joint') if one.get('name') == name)
    child, axis = joint.find('child'), joint.find('axis')
    assert child is not None and axis is not None
    motor = ElementTree.SubElement(root, 'link', name=f'{name}_motor')
    _add_inertia(motor, _LIGHT, (0.0, 0.0, 0.0), (_LIGHT,) * 3)
    gear = ElementTree.SubElement(root, 'joint', name=name + GEAR, type='continuous')
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


def _strip(robot: ElementTree.Element, removed: tuple[str, ...]) -> None:
    """Remove meshes, and links that the tool replaces."""
    for link in robot.findall('link'):
        for part in ('visual', 'collision'):
            for each in link.findall(part):
                link.remove(each)
        if link.get('name') in removed:
            robot.remove(link)
    for joint in robot.findall('joint'):
        child = joint.find('child')
        if child is not None and child.get('link') in removed:
            robot.remove(joint)
    for kind in ('transmission', 'gazebo'):
        for each in robot.findall(kind):
            robot.remove(each)


def _add_link(
    robot: ElementTree.Element, name: str, parent: str,
    xyz: tuple[float, ...] = (0.0, 0.0, 0.0), rpy: tuple[float, ...] = (0.0, 0.0, 0.0),
) -> ElementTree.Element:
    link = ElementTree.SubElement(robot, 'link', name=name)
    joint = ElementTree.SubElement(robot, 'joint', name=f'{name}_mount', type='fixed')
    ElementTree.SubElement(joint, 'parent', link=parent)
    ElementTree.SubElement(joint, 'child', link=name)
    ElementTree.SubElement(joint, 'origin', xyz=_text(xyz), rpy=_text(rpy))
    return link


def _add_inertia(
    link: ElementTree.Element, mass: float, centre: tuple[float, ...], inertia: tuple[float, ...]
) -> None:
    """Give a link mass, centre and principal inertia along its axes."""
    inertial = ElementTree.SubElement(link, 'inertial')
    ElementTree.SubElement(inertial, 'origin', xyz=_text(centre))
    ElementTree.SubElement(inertial, 'mass', value=str(mass))
    ixx, iyy, izz = map(str, inertia)
    ElementTree.SubElement(inertial, 'inertia', ixx=ixx, iyy=iyy, izz=izz,
                           ixy='0', ixz='0', iyz='0')


def _text(numbers: tuple[float, ...]) -> str:
    return ' '.join(map(str, numbers))
