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
Whether residuals are structured or noise: how well a flexible smoother predicts them.

Ridge regression on penetration, rate, acceleration, force and their products, present and past,
fitted on one part of the recording and evaluated on another.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..observe.model import Model
from ..observe.prepared_recording import PreparedRecording
from ..observe.residuals import residuals

Array = NDArray[np.float64]

_LAGS_S = (0.0, 0.01, 0.03, 0.08, 0.2)
_RIDGE = 1e-3
_FOLDS = 4


def predictable_share(recording: PreparedRecording, model: Model) -> float:
    """
    Compute how much of the residuals a smoother predicts in blocks it was not fitted on.

    Parameters
    ----------
    recording : PreparedRecording
        Any.
    model : Model
        Fitted.

    Returns
    -------
    share : float
        Of the residuals' variance, the larger of both channels; below 0 for noise.

    """
    features, left = _features(recording, model), residuals(recording, model)
    return max(_cross_validated(features, part) for part in recording.split(left))


def autocorrelation(recording: PreparedRecording, model: Model) -> float:
    """
    Compute the largest autocorrelation of neighbouring residuals.

    Parameters
    ----------
    recording : PreparedRecording
        Any.
    model : Model
        Fitted.

    Returns
    -------
    correlation : float
        Largest magnitude over the next five blocks, of the channels whose residual exceeds its
        noise; 0 for noise of any level.

    """
    largest = 0.0
    for part in recording.split(residuals(recording, model)):
        power = float(part @ part)
        if power < 1.5 * len(part):
            continue
        for lag in range(1, 6):
            largest = max(largest, abs(float(part[lag:] @ part[:-lag])) / power)
    return largest


def _features(recording: PreparedRecording, model: Model) -> Array:
    o, laws = recording.observed, model.laws()
    x, v, a = laws.at_wall(o)
    force, d = laws.contact.force_and_depth(o.t, x, v, a)
    inside = (force != 0.0).astype(float)
    signals = [inside, inside * d, inside * v, inside * a, force, o.x, o.v, o.a,
               inside * np.tanh(o.v / 2e-3), np.tanh(o.v / 2e-3)]
    if o.reference is not None:
        signals += list(o.reference[:3])
    rows = [recording.blocks(signal) for signal in signals]
    count = len(rows[0])
    unit = [(row - row.mean()) / (row.std() + 1e-12) for row in rows]
    columns = []
    for lag in _LAGS_S:
        shift = round(lag * o.pace / recording.block_s)
        columns += [np.concatenate((np.full(shift, row[0]), row[:count - shift]))
                    for row in unit]
    products = [a * b for k, a in enumerate(unit[:5]) for b in unit[k:5]]
    return np.array([np.ones(count), *columns, *products]).T


def _cross_validated(features: Array, target: Array) -> float:
    """Predict contiguous folds from the others; return 1 - error / variance."""
    folds = np.array_split(np.arange(len(target)), _FOLDS)
    error = 0.0
    for fold in folds:
        rest = np.setdiff1d(np.arange(len(target)), fold)
        known, y = features[rest], target[rest]
        gram = known.T @ known + _RIDGE * len(rest) * np.eye(features.shape[1])
        error += float(np.sum((target[fold] - features[fold] @ np.linalg.solve(
            gram, known.T @ y)) ** 2))
    return 1.0 - error / max(float(np.sum(target**2)), 1e-300)
