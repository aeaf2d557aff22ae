# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Friction of joints in a robot description, as `diagnose --write-urdf` writes it."""

from __future__ import annotations

from math import isfinite
from os import PathLike
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree

from ..exceptions import ModelFileError


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
    try:
        root = ElementTree.parse(path).getroot()
    except (OSError, ElementTree.ParseError, UnicodeDecodeError) as error:
        raise ModelFileError(
            f'{path} must be a URDF file, got: {error}; write one with diagnose --write-urdf'
        ) from error
    found = {}
    for joint in root.findall('joint'):
        dynamics = joint.find('dynamics')
        if dynamics is None:
            continue
        values = JointFriction(*(
            _number(dynamics.get(key, '0'), f'{Path(path).name}: {key} of {joint.get("name")}')
            for key in ('friction', 'damping')))
        if any(values):
            found[str(joint.get('name'))] = values
    return found


def _number(text: str, what: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = -1.0
    if not (isfinite(value) and value >= 0.0):
        raise ModelFileError(f'{what} must be a number >= 0, got {text!r}')
    return value
