# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The model uncertainty: parameters known only within a tolerance, not to be named as physics."""

from __future__ import annotations

from dataclasses import replace
from math import sqrt

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import median_filter

from ..observe.channel import Discount, LEAST_VARIANCE, sum_blocks
from ..observe.model import Model
from ..observe.prepared_recording import PreparedRecording
from ..observe.residuals import residuals, response_to

Array = NDArray[np.float64]

UNCERTAINTIES = (
    ('impedance_mismatch', (1.0, 1.0, 1.002), False),
    ('command_delay', (3e-5,), True),
    ('force_delay', (3e-5,), True),
)
"""Effects at one standard deviation, and whether that is a time, which the pace multiplies: M_t is
known to 0.2 %, stamps to 0.03 ms."""

_MOST_STEPS = 200
_LEAST_STEP = 0.1  # standard deviations of the motion
_SHOWS = 0.1  # of the least variance that a discount takes away: as much may add up
_STANDS_OUT = 10.0  # times the median: else it is not a step
_AROUND = 5  # samples among which it stands out
_UNIFORM = 1.0 / sqrt(12.0)  # standard deviation of an instant within a sample
_FAR = 4.0  # times the noise: power of the residuals
_MEAN_S, _BLOCK_S = 0.04, 0.1  # tells ripple, and averages it
_WHITE = 0.3  # power of such a mean, in that of residuals that are all of one sign


def discounted(recording: PreparedRecording, model: Model) -> PreparedRecording:
    """
    Return a recording whose residuals discount the model uncertainty.

    Beside `UNCERTAINTIES` these are the instant, within a sample, at which the reference steps,
    and whether the robot holds the desired acceleration between samples or interpolates it.
    """
    recording = replace(recording, discount=None)
    if recording.driven_by_force(model):
        return recording
    here = residuals(recording, model, robust=False)
    o = recording.observed
    robot = o.reference is not None
    columns = [
        residuals(recording, model.with_effect(name, _scaled(values, o.pace if time else 1.0)),
                  robust=False) - here
        for name, values, time in UNCERTAINTIES
        if name not in model.effects and (robot or name == 'force_delay')
    ]
    if robot:
        responses = (_held_acceleration(recording, model),
                     *_steps_of_reference(recording, model))
        columns += [_of_motion(recording, innovations) for innovations in responses]
    if not columns:
        return recording
    return replace(recording, discount=Discount.of(np.array(columns).T))


def _scaled(values: tuple[float, ...], factor: float) -> tuple[float, ...]:
    return tuple(factor * value for value in values)


def _of_motion(recording: PreparedRecording, innovations: Array) -> Array:
    """Return the residuals of innovations in the motion alone."""
    motion = recording.motion.average(innovations)
    return np.concatenate((np.zeros(len(motion)), motion))


def _response(recording: PreparedRecording, push: Array, model: Model) -> Array:
    innovations = response_to(recording, push, model)
    assert innovations is not None
    return innovations


def _held_acceleration(recording: PreparedRecording, model: Model) -> Array:
    """Return the innovations if the robot holds the desired acceleration over each sample."""
    reference, mass = recording.observed.reference, model.laws().robot.mass
    assert reference is not None
    return _response(recording, -0.5 * mass * np.gradient(reference[2]), model)


def _steps_of_reference(recording: PreparedRecording, model: Model) -> list[Array]:
    """Return the innovations if a step of the reference comes a fraction of a sample off."""
    o, robot = recording.observed, model.laws().robot
    assert o.reference is not None
    x_r, v_r, a_r = o.reference[:3]
    pushes = np.diff(robot.mass * a_r + robot.damping * v_r + robot.stiffness * x_r)
    jumps = pushes - median_filter(pushes, _AROUND)
    size = np.abs(jumps) * o.h  # impulse of a whole sample [N s]
    least = max(_LEAST_STEP * recording.motion.noise * o.observer_cutoff * robot.mass,
                _STANDS_OUT * float(np.median(size)))
    steps = np.argsort(-size)[:_MOST_STEPS]
    pulse = np.zeros(len(o.t))
    pulse[0] = 1.0
    response = _response(recording, pulse, model)
    variance = float(np.sum(recording.motion.average(response) ** 2)) * (_UNIFORM * jumps) ** 2
    responses = []
    for k in steps[(size[steps] > least) & (variance[steps] > _SHOWS * LEAST_VARIANCE)].tolist():
        for first in (k, k + 1):  # two pulses span its possible courses within the sample
            moved = np.zeros(len(o.t))
            moved[first:] = response[:len(o.t) - first] * jumps[k] * _UNIFORM
            responses.append(moved)
    return responses


def without_ripple(recording: PreparedRecording, model: Model) -> PreparedRecording:
    """Average the innovations of a driven wall over longer blocks if its positions ripple."""
    one, size = recording, round(_MEAN_S * recording.observed.pace / recording.block_s)
    if not one.driven_by_force(model) or size < 2:
        return one
    left = residuals(one, model, robust=False)
    full = sum_blocks(one.motion.filled.astype(float), size) == size
    power = float(np.mean(sum_blocks(left**2, size)[full])) / size if full.any() else 0.0
    if power < _FAR or float(np.mean(sum_blocks(left, size)[full] ** 2)) > (
            _WHITE * power * size**2):
        return one
    return one.in_blocks(round(_BLOCK_S * one.observed.pace / one.observed.h), model)
