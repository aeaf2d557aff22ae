# Copyright 2026 contact_estimation authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""
Invariance: does a law predict parts of the recordings that it was not fitted on.

A law of nature holds in every part of a recording with the same parameters; a curve that happens
to fit does not (invariant prediction: Peters, Buehlmann and Meinshausen 2016). Each part, a
contact or a block of time, is left out in turn and predicted by a model fitted on the rest.
"""

from __future__ import annotations

from typing import Callable, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from .discrepancy import CHANNELS
from .fitting import Fit, residual_function, sum_of_squares
from .jacobian import differentiate_by, jacobian_at
from .parts import Part
from ..observe.model import Model
from ..observe.prepared_recording import is_flexible, Recordings
from ..observe.residuals import force_explains_motion
from ...physics import EFFECTS

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

_STEPS = (1.0, 0.5, 0.25, 0.1)  # shares of a Gauss-Newton step that are tried
_LOOSE, _ROUNDS = 3.0, 3  # a part alone: sizes of a value that its prior allows, steps
_OWN_STEPS = 8  # of the size of an effect on a part
_TOLD = 1e-4  # share of the information on a value, from which on it is told
_UNTOLD = 1e-9  # singular value of the derivatives on the rest, beside all, that is none
_FAINT = 1e-6  # information that keeps an undetermined value finite
_ROUNDING = 1e-13  # share of the information that rounding may make of nothing

ROBOT = 1
"""The channel of the effects of the robot."""


def channel_of(effect: str) -> int | None:
    """
    Return the channel by which an effect is judged where the robot has a misfit of its own.

    Parameters
    ----------
    effect : str
        Name.

    Returns
    -------
    channel : int or None
        Of `CHANNELS`: an effect of the robot shows in the motion alone; None for one that shows as
        a contradiction between force and motion, in either.

    """
    of_robot = EFFECTS[effect].port == 'robot'
    return None if EFFECTS[effect].needs_robot and not of_robot else int(of_robot)


def channel_by_gain(effect: str, gain: Array) -> int | None:
    """
    Return the channel by which an effect is judged, given what it takes away in each.

    Parameters
    ----------
    effect : str
        Name.
    gain : ndarray, shape (CHANNELS,)
        Part of the squared misfit.

    Returns
    -------
    channel : int or None
        None for an effect of the robot that shows in the force more than in the motion.

    """
    channel = channel_of(effect)
    return None if channel == ROBOT and gain[ROBOT] < 0.5 * np.sum(gain) else channel


def judged_by_channel(recordings: Recordings, model: Model) -> bool:
    """
    Return whether force and motion have misfits of different origin.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        With a discrepancy.
    model : Model
        Fitted.

    Returns
    -------
    judged : bool
        If so, the misfit of the one does not count against an effect of the other.

    """
    return not any(force_explains_motion(one, model) for one in recordings)


def left_out_errors(
    recordings: Recordings, found: Fit, parts: Sequence[Part], before: Array | None = None,
) -> Array:
    """
    Predict each part by the model fitted on the others.

    The fits start from that on all parts and take one Gauss-Newton step, whose derivatives are
    those of the full fit; that is exact for linear parameters.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        Fitted together.
    found : Fit
        On all parts.
    parts : sequence of Part
        Of the recordings.
    before : ndarray, shape (parts, CHANNELS), optional
        Errors without the last effect. They stand for those with it where the rest of the
        recordings does not determine the prediction: what is not known predicts nothing.

    Returns
    -------
    squares : ndarray, shape (parts, CHANNELS)
        Sum of the squared residuals on each part, left out.

    """
    function = residual_function(recordings, found.model)
    here = function(found.model.coordinates)
    jacobian = jacobian_at(found.model, function, here)
    names = found.model.effects
    lawful = not (names and is_flexible(recordings, found.model, names[-1]))
    squares = np.empty((len(parts), CHANNELS))
    for k, part in enumerate(parts):
        rest = ~part.there
        _, there = _fitted_on(rest, found.model, function, here, jacobian)
        squares[k] = part.squares(there)
        if before is not None:
            gain = float((before[k] - squares[k]).sum())
            spread = _spread(part, jacobian, rest, here)
            if spread > gain and (gain > 0.0 or not _tells_all(jacobian, rest)
                                  or lawful and spread > -gain):
                squares[k] = before[k]
    return squares


def errors_with_own_size(recordings: Recordings, found: Fit, parts: Sequence[Part]) -> Array:
    """
    Predict each part by the model fitted on the others, but for the size of the last effect.

    The first parameter of an effect is its size; it is fitted on the part itself.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        Fitted together.
    found : Fit
        On all parts.
    parts : sequence of Part
        Of the recordings.

    Returns
    -------
    squares : ndarray, shape (parts, CHANNELS)
        Sum of the squared residuals on each part.

    """
    model = found.model
    function, place = residual_function(recordings, model), model.place(model.effects[-1]).start
    size = int(np.count_nonzero(model.free[:place]))
    (low, high), here = model.ranges, function(model.coordinates)
    jacobian = jacobian_at(model, function, here)
    squares = np.empty((len(parts), CHANNELS))
    for k, part in enumerate(parts):
        values, _ = _fitted_on(~part.there, model, function, here, jacobian)
        weights = np.sqrt(part.weights)

        def with_size(own: Array) -> Array:
            return np.concatenate((values[:size], own, values[size + 1:]))

        own = least_squares(
            lambda own: weights * function(with_size(own))[part.there], values[size],
            x_scale=model.steps[size], bounds=(low[size], high[size]), max_nfev=_OWN_STEPS)
        squares[k] = part.squares(function(with_size(own.x)))
    return squares


def jacobian_of(recordings: Recordings, found: Fit) -> Array:
    """
    Differentiate the residuals of a fit by its free values.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        Fitted together.
    found : Fit
        To them.

    Returns
    -------
    jacobian : ndarray, shape (R, F)
        For a change of each value by its typical size.

    """
    function = residual_function(recordings, found.model)
    return jacobian_at(found.model, function, function(found.model.coordinates))


def _fitted_on(
    rest: Flags, model: Model, function: Callable[[Array], Array], here: Array, jacobian: Array,
) -> tuple[Array, Array]:
    """Step from the fit on all parts to that on the rest; return coordinates and residuals."""
    values, (low, high) = model.coordinates, model.ranges
    present = sum_of_squares(here[rest])
    told, every = float(np.linalg.norm(jacobian[rest])), float(np.linalg.norm(jacobian))
    if told <= _UNTOLD * every:  # the rest tells nothing: its derivatives are rounding
        return values, here
    change = np.linalg.lstsq(
        jacobian[rest], -here[rest], rcond=_UNTOLD * every / told)[0] * model.steps
    for share in _STEPS:
        there = np.clip(values + share * change, low, high)
        residuals = function(there)
        if sum_of_squares(residuals[rest]) <= present:
            return there, residuals
    return values, here


def _spread(part: Part, jacobian: Array, rest: Flags, left: Array) -> float:
    """Return the expected squared error of a prediction by what the rest leaves undetermined."""
    normal = jacobian[rest].T @ jacobian[rest]
    normal += (_FAINT + _ROUNDING * np.trace(normal)) * np.eye(len(normal))
    covariance = np.linalg.inv(normal) * float(np.mean(left[rest] ** 2))
    here = jacobian[part.there]
    return float(part.weights @ np.einsum('ij,jk,ik->i', here, covariance, here))


def _tells_all(jacobian: Array, rest: Flags) -> bool:
    """Return whether the rest tells something on every value, which may show on one part alone."""
    told, every = (np.sum(rows**2, axis=0) for rows in (jacobian[rest], jacobian))
    return bool(np.all(told >= _TOLD * every))


def values_on(recordings: Recordings, found: Fit, part: Part) -> Model:
    """
    Fit a model on one part alone.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        Fitted together.
    found : Fit
        On all parts.
    part : Part
        The only residuals that count.

    Returns
    -------
    model : Model
        With the values of the full fit where the part does not determine them.

    """
    model = found.model
    function, values, size = residual_function(recordings, model), model.coordinates, model.steps
    low, high = model.ranges
    start = values.copy()

    def errors(these: Array) -> Array:
        return np.concatenate((function(these)[part.there], (these - start) / (_LOOSE * size)))

    for _ in range(_ROUNDS):
        here = errors(values)
        jacobian = differentiate_by(values, size, errors, here, most=high)
        change = np.linalg.lstsq(jacobian, -here, rcond=1e-12)[0] * size
        for share in _STEPS:
            tried = np.clip(values + share * change, low, high)
            if sum_of_squares(errors(tried)) < sum_of_squares(here):
                values = tried
                break
        else:
            break
    return model.with_free(values)
