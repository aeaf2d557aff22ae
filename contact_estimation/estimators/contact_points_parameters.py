# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Parameters of the estimation from several contact points."""

from __future__ import annotations

from dataclasses import dataclass

from ..parameters.specification import parameter, ParameterGroup


@dataclass(frozen=True)
class ContactPointsParameters(ParameterGroup):
    """Prior, noise and memory of the estimation from several contact points."""

    initial_stiffness: float = parameter(3000.0, 'First guess of K_e', 'N/m', minimum=1e-3)
    initial_damping: float = parameter(50.0, 'First guess of B_e', 'N s/m', minimum=0.0)
    initial_friction: float = parameter(
        0.0, 'First guess of mu; the known mu where friction_std is 0', minimum=0.0,
        maximum=10.0,
    )
    stiffness_std: float = parameter(
        1e5, 'Prior standard deviation of K_e', 'N/m', minimum=1e-3, maximum=1e12
    )
    damping_std: float = parameter(
        1e4, 'Prior standard deviation of B_e', 'N s/m', minimum=1e-3, maximum=1e12
    )
    friction_std: float = parameter(
        1.0, 'Prior standard deviation of mu; 0: known, not estimated', minimum=0.0, maximum=1e3
    )
    forgetting_factor: float = parameter(
        0.999, 'Forgetting factor lambda per sample in contact; closer to 1: smoother, slower',
        minimum=0.5, maximum=1.0,
    )
    force_noise: float = parameter(
        0.6, 'Standard deviation of each force component', 'N', minimum=1e-9, maximum=1e6
    )
    position_noise: float = parameter(
        1e-5, 'Standard deviation of the position of a point; samples with a point closer to its '
        'surface are not used', 'm', minimum=0.0,
    )
    sliding_speed: float = parameter(
        2e-3, 'Below this speed a point counts as sticking, and force directions that its '
        'friction may affect are not used; choose it well above the velocity noise', 'm/s',
        minimum=0.0,
    )
    maximum_relative_std: float = parameter(
        0.2, 'K_hat and B_hat are updated only while their relative standard deviation is lower',
        minimum=1e-4,
    )
