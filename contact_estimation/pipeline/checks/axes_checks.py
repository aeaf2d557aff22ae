# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Whether the wrench of an arm is expressed in the axes that are configured."""

from collections import deque
from typing import NamedTuple, Sequence

import numpy as np

from .check import Array, Check, median_of, Window
from ..parameters import EstimationParameters
from ...kinematics.parameters import AXES, JOINT_EFFORTS
from ...kinematics.tool_load import STANDARD_GRAVITY
from ...signals.stream_faults import CLEAR

_TURNED = np.cos(np.radians(5.0))  # from one orientation to the next
_LEAST, _MOST = 6, 60  # orientations
_LEAST_SPREAD = 0.2  # standard deviation of the direction of gravity: about 11 degrees
_FITS, _TRIFLE = 0.1, 0.01  # of the weight: what is small beside it, and what is nothing
_ROUNDS = 5
_WORSE = 3.0  # times what the other axes leave
_OR_ZERO = '; or, without a tool, set tool.force_bias to the zero of the sensor'


class Loads:
    """
    The mean force of an arm in the last orientations of its sensor against gravity.

    kept: of each, force in axes of the sensor if the wrench is in those configured, then in the
    other ones [N], and weight per mass [m/s^2], (3, 3)
    """

    def __init__(self) -> None:
        self.kept: deque[Array] = deque(maxlen=_MOST)

    def add(self, table: Array) -> None:
        """Add half a second, (N, 9) as of `ContactKinematics.loads`."""
        if not len(table):
            return
        load = table.mean(axis=0).reshape(3, 3)
        down, last = load[2], self.kept[-1][2] if self.kept else -load[2]
        if down @ last < _TURNED * np.linalg.norm(down) * np.linalg.norm(last):
            self.kept.append(load)


class WrenchAxes(Check):
    """The weight of the tool turns with the axes in which the wrench is expressed."""

    name = 'wrench_axes'
    message = ('as the sensor turned, the force was that of a weight of 1.2 kg in axes of the '
               'base: set force_sensor.axes to base, then run calibrate_tool')
    cause = ('The driver expresses the wrench in axes of the base, as UR drivers do that leave '
             '`frame_id` empty; or it does not, and `force_sensor.axes` says so.')
    remedy = 'Set `force_sensor.axes` to the value given, start again, and calibrate the tool.'
    invalidates = True

    def judge(self, seen: Window) -> str | None:
        """Compare how well a weight explains the force in either axes."""
        return foreign_axes(seen.loads, seen.noise, seen.parameters)


def foreign_axes(
    loads: Sequence[Array], noise: float, parameters: EstimationParameters
) -> str | None:
    """
    Return the warning that the wrench is in other axes; None where the sensor has hardly turned.

    loads: as of `Loads.kept`
    noise: of the force [N]
    parameters: all, with the axes in which it should be expressed
    """
    if parameters.wrench_source == JOINT_EFFORTS or len(loads) < _LEAST:
        return None
    own, other, gravity = np.array(loads).transpose(1, 0, 2)
    spread = np.sqrt(np.sum(np.var(gravity, axis=0))) / STANDARD_GRAVITY
    if not spread > _LEAST_SPREAD:
        return None
    here, there = _weight(own, gravity), _weight(other, gravity)
    weight = abs(there.mass) * STANDARD_GRAVITY
    if not there.rest < _FITS * weight or weight < CLEAR * noise:
        return ''
    may_be_zero = here.rest < _WORSE * max(there.rest, _TRIFLE * weight)
    if may_be_zero and not (abs(here.mass) < _FITS * abs(there.mass)
                            and there.constant < _FITS * weight):
        return ''
    right, = set(AXES) - {parameters.force_sensor.axes}
    text = (f'as the sensor turned, the force was that of a weight of {abs(there.mass):.2g} kg in '
            f'axes of the {right}: set force_sensor.axes to {right}, then run calibrate_tool')
    return text + _OR_ZERO * may_be_zero


class _Weight(NamedTuple):
    """What explains a force: a mass [kg] and a constant; and the median of the rest [N]."""

    mass: float
    constant: float
    rest: float


def _weight(force: Array, gravity: Array) -> _Weight:
    """Fit a mass and a constant force, which contacts in between do not disturb."""
    w = np.ones((len(force), 1))
    for _ in range(_ROUNDS):
        f, g = (one - (w * one).sum(axis=0) / w.sum() for one in (force, gravity))
        mass = float((w * f * g).sum() / (w * g * g).sum())
        rest = np.linalg.norm(f - mass * g, axis=1)
        w = 1.0 / np.maximum(rest, 1e-3)[:, None]
    constant = float(np.linalg.norm(np.median(force - mass * gravity, axis=0)))
    return _Weight(mass, constant, median_of(rest))
