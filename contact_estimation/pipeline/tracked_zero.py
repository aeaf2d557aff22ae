# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The zero of a force sensor that drifts, from all free flights of a recording."""

import numpy as np
from numpy.typing import NDArray

from .axis_pipeline import EstimationPipeline
from .parameters import EstimationParameters
from ..estimators.estimate import EstimateStatus
from ..exceptions import RecordingError
from ..signals.contact_sample import ContactSample
from ..signals.stream_faults import zero_steps

Array = NDArray[np.float64]

_WINDOW_S = 0.5  # of free flight, as of a tare
_AT_ONCE = 2.5  # samples


def tracked_zero(
    stamp_ns: NDArray[np.int64], x: Array, force: Array, parameters: EstimationParameters
) -> Array:
    """
    Return the zero of the force at each sample.

    Free flight is where the pipeline that tracks the zero on line finds it. Between the medians of
    each half second of it the zero is interpolated: unlike on line, also the later free flight is
    known. A step from one sample of free flight to the next is followed. One from before a contact
    to after it is no drift, and nobody knows when it came: it is left in the force, where checks
    see it.

    stamp_ns (N,): stamps [ns]
    x, force (N,): position along the normal [m] and F_e [N]
    parameters: of the contact axis, with `force_sensor.zero: tracked`
    """
    pipeline = EstimationPipeline(parameters)
    found = pipeline.process(map(ContactSample, stamp_ns.tolist(), x.tolist(),
                                 np.full(len(x), np.nan).tolist(), force.tolist()))
    free = np.array([one.status is EstimateStatus.FREE for one in found])
    free |= x < pipeline.surface.location - pipeline.surface.margin
    t = 1e-9 * (stamp_ns - stamp_ns[0])
    noise = max(pipeline.posterior.contact.noise_std, parameters.contact.force_noise)
    resting = bool(parameters.tool.mass) or not parameters.kinematics.tip  # else a weight turns
    steps = zero_steps(t[free], force[free], noise, resting)
    steady, followed = force.copy(), np.zeros(len(t))
    for step in steps:
        steady[t >= step.end] -= step.size
        if step.end - step.begin < _AT_ONCE * pipeline.posterior.period_s:
            followed[t >= step.end] += step.size
    times, levels = [], []
    for window in np.split(np.flatnonzero(free), _ends(t, free)):
        if len(window) > 1:
            times.append(float(np.mean(t[window])))
            levels.append(float(np.median(steady[window])))
    if not times:
        raise RecordingError(
            'force_sensor.zero: tracked needs free flight, but the tool is in contact all the '
            'time; give --tare A:B or physics.force_bias.bias')
    return followed + np.interp(t, times, levels)


def _ends(t: Array, free: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Return where, among the free samples, a window of free flight ends."""
    at = np.flatnonzero(free)
    window = np.floor(t[at] / _WINDOW_S)
    return np.flatnonzero((np.diff(window) > 0) | (np.diff(at) > 1)) + 1
