# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Axes estimated beside the contact axis, and the locations of their walls."""

from __future__ import annotations

from dataclasses import dataclass

from ..exceptions import ParameterRangeError
from ..parameters.specification import group, parameter, ParameterGroup


@dataclass(frozen=True)
class FurtherAxisParameters(ParameterGroup):
    """One axis that is estimated beside the contact axis."""

    joint: str = parameter(
        '', 'Joint whose position is this axis; empty: not estimated', read_only=True
    )
    location: float = parameter(
        0.0, 'Surface of the untouched wall along this axis; NaN: taken at the first touch', 'm',
        nan_is_off=True,
    )


@dataclass(frozen=True)
class FurtherAxesParameters(ParameterGroup):
    """Axes estimated beside the contact axis, each with an eq. (3) of its own; none by default."""

    x: FurtherAxisParameters = group(FurtherAxisParameters)
    y: FurtherAxisParameters = group(FurtherAxisParameters)
    z: FurtherAxisParameters = group(FurtherAxisParameters)

    def named(self) -> dict[str, FurtherAxisParameters]:
        """Return the axes that are estimated."""
        every = {'x': self.x, 'y': self.y, 'z': self.z}
        return {axis: own for axis, own in every.items() if own.joint}


def check_axes(axis: str, joint: str, further: FurtherAxesParameters) -> None:
    """Check that every axis is estimated once and from a joint of its own."""
    others = further.named()
    if axis in others:
        raise ParameterRangeError(
            f'further_axes.{axis}.joint must be empty, since {axis} is the contact axis, got '
            f'{others[axis].joint!r}; name it in joint, or choose another axis'
        )
    if others and not joint:
        raise ParameterRangeError(
            f'joint must name the joint of axis {axis} where further axes are estimated '
            f'({", ".join(others)}), got an empty text'
        )
    joints = [joint, *(own.joint for own in others.values())]
    if len(set(joints)) < len(joints):
        raise ParameterRangeError(
            f'joint and further_axes.*.joint must name different joints, got {joints}; each axis '
            'has a position of its own'
        )


def check_matrix(matrix_estimator: str, axes: tuple[str, ...]) -> None:
    """Check that the full matrices have three axes."""
    if matrix_estimator != 'off' and len(axes) < 3:
        raise ParameterRangeError(
            f'matrix_estimator {matrix_estimator} needs the axes x, y and z, got '
            f'{", ".join(axes)}; name the other joints in further_axes.*.joint'
        )
