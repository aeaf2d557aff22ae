# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The physics of an arm by name. To add one: an entry of FRICTION, DRIVE or LOAD."""

from __future__ import annotations

from .carried_load import LOAD
from .joint_drive import DRIVE
from .joint_effect import JointEffect, JointMotion, Place
from .joint_friction import FRICTION

__all__ = ['JOINT_EFFECTS', 'JointEffect', 'JointMotion', 'Place']

LINK_SIDE = 'joint_flexibility_link_side'
"""Key of the second law of one name."""

JOINT_EFFECTS: dict[str, JointEffect] = {}
for _one in (*FRICTION, *DRIVE, *LOAD):
    JOINT_EFFECTS[LINK_SIDE if _one.name in JOINT_EFFECTS else _one.name] = _one
