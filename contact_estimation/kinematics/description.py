# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""What a robot description says of its joints, read without Pinocchio."""

from math import isfinite
from os import PathLike
from pathlib import Path
from typing import NamedTuple, Sequence
from xml.etree import ElementTree

from ..exceptions import ModelFileError
from ..texts import text_file

_WRITTEN = ('friction', 'damping', 'armature')  # the last as MuJoCo means it
_TURNING = ('revolute', 'continuous')


class JointFriction(NamedTuple):
    """
    Friction of a joint: tau = F_c sgn(q') + B q'.

    Attributes
    ----------
    F_c, B : float
        Coulomb friction [N m] or [N], and viscous friction [N m s/rad] or [N s/m].

    """

    F_c: float
    B: float


def joint_friction(path: str | PathLike[str]) -> dict[str, JointFriction]:
    """
    Read the friction of all joints that have any.

    Parameters
    ----------
    path : str or path-like
        URDF file, with friction and damping in <dynamics>.

    Returns
    -------
    friction : dict of str to JointFriction
        By joint; empty if the description has none.

    Raises
    ------
    ModelFileError
        If the file is no URDF, or a value is no number >= 0.

    """
    drives = joint_drives(read_description(path))
    return {name: JointFriction(*one[:2]) for name, one in drives.items() if any(one[:2])}


def link_masses(urdf: str) -> list[str]:
    """Return what a description, which was read before, has as masses of its links."""
    return [one.get('value', '') for one in ElementTree.fromstring(urdf).iterfind(
        'link/inertial/mass')]


def read_description(path: str | PathLike[str], name: str = 'robot description') -> str:
    """Read a URDF file; `name` is what it is called in errors."""
    try:
        return text_file(Path(path))
    except (OSError, ValueError) as error:
        reason = getattr(error, 'strerror', None) or error
        raise ModelFileError(
            f'{name} {path} cannot be read: {reason}; give the path of a URDF, with xacro expanded'
        ) from error


def joint_drives(urdf: str) -> dict[str, tuple[float, ...]]:
    """Return friction, damping and armature in <dynamics> of each joint of a description."""
    try:
        root = ElementTree.fromstring(urdf)
    except ElementTree.ParseError as error:
        raise ModelFileError(
            f'robot description ({len(urdf)} characters, beginning {urdf[:40]!r}) must be a URDF: '
            f'{error}; xacro files must be expanded first') from error
    dynamics = {str(one.get('name')): one.find('dynamics') for one in root.findall('joint')}
    return {name: tuple(
        0.0 if own is None else _number(own.get(key, '0'), f'{key} of {name}')
        for key in _WRITTEN) for name, own in dynamics.items()}


def _number(text: str, what: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = -1.0
    if not (isfinite(value) and value >= 0.0):
        raise ModelFileError(
            f'{what} must be a number >= 0, got {text!r}; correct <dynamics> of the description')
    return value


def turning_joint(description: str, names: Sequence[str]) -> str:
    """Return a joint whose positions are angles."""
    try:
        root = ElementTree.fromstring(description)
    except ElementTree.ParseError:
        return ''
    kinds = {joint.get('name', ''): joint.get('type', '') for joint in root.iter('joint')
             if joint.get('type', 'fixed') != 'fixed'}
    for name in names:
        looked_at = name or (next(iter(kinds)) if len(kinds) == 1 else '')
        if kinds.get(looked_at) in _TURNING:
            return looked_at
    return ''
