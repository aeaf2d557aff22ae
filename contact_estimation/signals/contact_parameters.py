# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Parameters of the contact: noise to expect, the normal of the wall."""

from __future__ import annotations

from dataclasses import dataclass

from ..parameters.specification import parameter, ParameterGroup


@dataclass(frozen=True)
class ContactParameters(ParameterGroup):
    """What noise to expect, and where an arm touches the wall."""

    force_noise: float = parameter(
        0.6,
        'Standard deviation of the force noise to expect; it is then estimated from the force',
        'N',
        minimum=1e-9,
        maximum=1e6,
    )
    position_noise: float = parameter(
        1e-6, 'Standard deviation of the position noise', 'm', minimum=0.0
    )
    minimum_force: float = parameter(
        0.0, 'Contact begins above this force whatever the noise', 'N', minimum=0.0
    )
    normal: tuple[float, ...] = parameter(
        (0.0, 0.0, 0.0), 'Direction into the wall, of any length; for an arm (kinematics.tip)',
        read_only=True,
    )
    normal_frame: str = parameter(
        'base', 'Frame of the normal: kinematics.base, or kinematics.tip as it is oriented at '
        'touch-down', choices=('base', 'tip'), read_only=True,
    )
    point: tuple[float, ...] = parameter(
        (0.0, 0.0, 0.0), 'Point of the tip that touches the wall, in the frame of kinematics.tip',
        'm', read_only=True,
    )
