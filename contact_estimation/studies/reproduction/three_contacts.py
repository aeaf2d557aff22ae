# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Estimation of eq. (6) on a tool whose three contact points touch, slide and release."""

from __future__ import annotations

from typing import NamedTuple, Sequence

from .three_contacts_world import B_E, GEOMETRY, Instant, K_E, MU
from ...estimators.contact_points_estimator import (
    ContactPointsEstimate, ContactPointsEstimator, ContactPointsParameters)

VARIANTS: dict[str, ContactPointsParameters] = {
    'friction estimated': ContactPointsParameters(),
    'friction known': ContactPointsParameters(initial_friction=MU, friction_std=0.0),
    'friction left out': ContactPointsParameters(initial_friction=0.0, friction_std=0.0),
}
ALL_TOUCH_S = 6.8
"""Time at which all points slide [s]."""


class Errors(NamedTuple):
    """Signed errors of one estimate: K and B in percent, mu as it is."""

    stiffness_percent: float
    damping_percent: float
    friction: float


def estimate(instants: Sequence[Instant], variant: str) -> list[ContactPointsEstimate]:
    """Run one variant of the estimator over a simulation."""
    estimator = ContactPointsEstimator(GEOMETRY, VARIANTS[variant])
    return [estimator.update(instant.sample) for instant in instants]


def errors_of(estimate: ContactPointsEstimate) -> Errors:
    """Return the errors of an estimate against the simulated parameters."""
    return Errors(
        100.0 * (estimate.stiffness / K_E - 1.0), 100.0 * (estimate.damping / B_E - 1.0),
        estimate.friction - MU,
    )
