# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The physics of an arm by name. To add one: an entry of FRICTION, DRIVE or LOAD."""

from .carried_load import LOAD
from .joint_drive import DRIVE
from .joint_effect import JointEffect, JointMotion, Place
from .joint_friction import FRICTION

__all__ = ['JOINT_EFFECTS', 'JointEffect', 'JointMotion', 'Place']

LINK_SIDE, ONE_DELAY = 'joint_flexibility_link_side', 'force_delay_of_joint'
"""Keys of second laws of one name."""

_SECOND = {'joint_flexibility': LINK_SIDE, 'force_delay': ONE_DELAY}

JOINT_EFFECTS: dict[str, JointEffect] = {}
for _one in (*FRICTION, *DRIVE, *LOAD):
    JOINT_EFFECTS[_SECOND[_one.name] if _one.name in JOINT_EFFECTS else _one.name] = _one
