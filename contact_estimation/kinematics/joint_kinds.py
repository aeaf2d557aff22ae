# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Kinds of joints in a robot description; needs no Pinocchio."""

from __future__ import annotations

from typing import Sequence
from xml.etree import ElementTree

_TURNING = ('revolute', 'continuous')


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
