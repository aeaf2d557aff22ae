# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The reference of an arm as a full pose."""

from __future__ import annotations

from math import inf, isfinite
from typing import NamedTuple, Sequence

from .parameters import EstimationParameters
from .result import Result
from ..exceptions import ParameterRangeError
from ..reference.parameters import PoseLimits


class TargetPose(NamedTuple):
    """A pose of the tip in the base frame."""

    stamp_ns: int  # instant from which it holds [ns]
    position: Sequence[float]  # of the tip's origin [m]
    quaternion: Sequence[float]  # x, y, z, w


def check_target_pose(parameters: EstimationParameters) -> None:
    """Check that x_r determines a pose."""
    if not parameters.kinematics.tip:
        raise ParameterRangeError(
            'publish_target_pose needs the pose of an arm, but kinematics.tip is empty; set '
            'kinematics.base, kinematics.tip and contact.normal, or let the controller of a '
            'single axis follow reference_trajectory'
        )
    if parameters.contact.normal_frame != 'base':
        raise ParameterRangeError(
            'publish_target_pose needs contact.normal_frame base, got '
            f'{parameters.contact.normal_frame!r}: x_r is a coordinate along a normal that does '
            'not turn with the tool'
        )


def target_pose(result: Result, limits: PoseLimits) -> TargetPose | None:
    """Return the measured pose with only the coordinate along the normal replaced by x_r."""
    arm, reference = result.arm, result.reference
    if arm is None or reference is None:
        return None
    normal, measured = arm.normal.tolist(), arm.p.tolist()
    step = step_along(measured, normal, reference.position - result.sample.position, limits)
    if step is None:
        return None
    from scipy.spatial.transform import Rotation  # slow to import, and only arms need it

    position = [p + step * n for p, n in zip(measured, normal)]
    quaternion = Rotation.from_matrix(arm.R).as_quat().tolist()
    return TargetPose(result.reference_stamp_ns, position, quaternion)


def step_along(
    position: Sequence[float], normal: Sequence[float], step: float, limits: PoseLimits
) -> float | None:
    """
    Return the step along the normal that is nearest to a wanted one within the limits.

    position: measured [m]
    step: wanted [m]
    Returns step: in [m]; None where no step leads into the box, or the wanted one is not finite
    """
    if not isfinite(step):
        return None
    low, high = -limits.lead, limits.lead
    for p, n, lower, upper in zip(position, normal, limits.lower, limits.upper):
        if abs(n) < 1e-9:
            ends = (-inf, inf) if lower <= p <= upper else (inf, -inf)
        else:
            ends = ((lower - p) / n, (upper - p) / n)
            ends = (min(ends), max(ends))
        low, high = max(low, ends[0]), min(high, ends[1])
    return min(max(step, low), high) if low <= high else None
