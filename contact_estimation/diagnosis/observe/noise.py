# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The noise floor of force and motion."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d

from .driven_wall import DrivenWall
from .model import Model
from .motion_error import lost_by_lines
from .observed import Observed
from .observer import innovations_of
from .smoothing import is_slow, least_noise, white_noise_std
from ...physics.numeric import SecondOrder

Array = NDArray[np.float64]

_WINDOW_S = 0.1
_LEAST_WINDOWS = 5
_MEMORY = 2.0  # times 1 / omega_o: the observer has half forgotten an error


def force_noise(model: Model, observed: Observed) -> float:
    """
    Estimate the standard deviation of the force noise.

    From free flight, each tenth of a second less its own line: bias, drift and the slow force of a
    tool's mass do not count. Without free flight, from the top of the spectrum.
    """
    o = observed
    least = least_noise(o.force)
    span = max(6, round(_WINDOW_S * o.pace / o.h))
    law = model.laws().contact
    if law.unilateral:
        margin = 0.05 * float(np.ptp(o.x))
        free = (o.x < model.nominal.environment.location - margin) & o.measured
        squares = []
        line = np.vander(np.linspace(-1.0, 1.0, span), 2)
        project = line @ np.linalg.pinv(line)
        for first in range(0, len(o.t) - span + 1, span):
            if free[first:first + span].all():
                window = o.force[first:first + span]
                squares.append(float(np.sum((window - project @ window) ** 2)) / (span - 2))
        if len(squares) >= _LEAST_WINDOWS:
            # The median is that of a chi-square over its degrees of freedom (Wilson and
            # Hilferty 1931); few windows with a disturbance do not change it.
            freedom = float(span - 2)
            bias = (1.0 - 2.0 / (9.0 * freedom)) ** 3
            return max(float(np.sqrt(np.median(squares) / bias)), least)
    return max(white_noise_std(o.force[o.measured]), least)


def motion_noise(
    model: Model, observed: Observed, force_noise: float, widening: float = 1.0, block: int = 1,
) -> float:
    """Return the standard deviation of the motion error of a correct model."""
    if observed.driven_by_force(model.nominal):
        return DrivenWall(model, observed).kalman_filter(force_noise, widening, block)[1]
    return observed.position_noise


def force_error(model: Model, observed: Observed) -> Array | None:
    """Return the error of the wall's force that errors of the motion cause."""
    o = observed
    if o.motion_error is None:
        return None
    x_error, v_error = o.motion_error
    return np.hypot(model.stiffness * x_error, model.damping * v_error)


def innovation_error(
    model: Model, observed: Observed, observer: SecondOrder | None
) -> Array | None:
    """Return the error of a robot's innovations that errors of the motion cause."""
    o, robot = observed, model.laws().robot
    if observer is None or o.reference is None:
        return None
    push_error, of_command = force_error(model, o), o.command_error
    if push_error is None and of_command is None:
        return None
    if push_error is None:
        push_error = np.zeros(len(o.t))
    elif is_slow(o.h):
        command = robot.impedance_force(0.0, 0.0, o.reference)
        push_error = push_error + lost_by_lines(o.force) + lost_by_lines(command)
    if of_command is not None:
        push_error = push_error + of_command
    pulse = np.zeros(len(o.t))
    pulse[1] = 1.0
    answer = innovations_of(pulse, observer, observer, o.observer_cutoff, o.h)
    reach = 1 + 2 * round(_MEMORY / (o.observer_cutoff * o.h))
    return np.asarray(np.linalg.norm(answer) * maximum_filter1d(push_error, reach))
