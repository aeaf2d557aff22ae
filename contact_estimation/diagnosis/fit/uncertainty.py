# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Standard deviations of fitted values from residuals that are correlated in time."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .discrepancy import correlation_time
from .fitting import Fit, residual_function
from .jacobian import differentiate_by, jacobian_at
from ..observe.model import Model
from ..observe.prepared_recording import Recordings

Array = NDArray[np.float64]

_CLUSTER_S = 0.5


def standard_deviations(recordings: Recordings, found: Fit) -> Array:
    """
    Estimate standard deviations of fitted values, clustered in time (Liang and Zeger 1986).

    Residuals may be correlated in any way within half a second and are independent across; the
    result is never below that for residuals of the correlation time that each channel shows.
    """
    model = found.model
    function = residual_function(recordings, model)
    values, size = model.coordinates, model.steps
    here = function(values)
    jacobian = jacobian_at(model, function, here)
    inverse = np.linalg.pinv(jacobian.T @ jacobian, rcond=1e-13)
    told = differentiate_by(values, size, lambda these: _free_values(model.with_free(these)),
                            _free_values(model), most=model.ranges[1])
    span = max(1, round(_CLUSTER_S * recordings[0].observed.pace / recordings[0].block_s))
    scores = np.add.reduceat(jacobian * here[:, None], np.arange(0, len(here), span), axis=0)
    inverse = told @ inverse
    clustered = np.diag(inverse @ (scores.T @ scores) @ inverse.T)
    times = _correlation_times(recordings, model, here)
    correlated = np.diag(inverse @ (jacobian.T * times) @ jacobian @ inverse.T)
    correlated = correlated * max(1.0, float(np.mean(here**2)))
    std = np.full(len(model.values), np.nan)
    std[model.free] = np.sqrt(np.maximum(clustered, correlated))
    std[model.at_end] = np.nan
    return std


def _free_values(model: Model) -> Array:
    return np.array(model.values)[model.free]


def _correlation_times(recordings: Recordings, model: Model, stacked: Array) -> Array:
    """Return the correlation time of the channel of each residual [blocks], shape (R,)."""
    times, begin = np.ones(len(stacked)), 0
    for one in recordings:
        for _ in one.channels(model):
            here = slice(begin, begin + one.block_count)
            times[here] = correlation_time(stacked[here])
            begin = here.stop
    return times
