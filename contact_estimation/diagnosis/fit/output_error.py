# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
The last refinement: output error of the free run.

The residuals treat the measured motion as exact, which costs some accuracy where the motion is
sharpest. The free run from the command needs no measured motion; its errors against measured
position and force are noise if the values are right (Ljung 1999, section 3.3).
"""

from __future__ import annotations

from dataclasses import replace
from typing import Sequence

import numpy as np
from numpy.typing import NDArray

from .fitting import Fit, fit, fit_at, fit_to_end, sum_of_squares
from .free_run import free_run, Run
from .jacobian import SecantJacobian
from ..observe.model import Model
from ..observe.prepared_recording import PreparedRecording, Recordings
from ..observe.residuals import huber

Array = NDArray[np.float64]

_STEP = 1e-3  # relative, of the finite differences
_CLOSE = 4.0  # standard deviations of the position noise, within which a run is refined
_ALIKE = 1.5  # times the cost at the measured motion: more is another optimum
_PICARD = 8  # rounds in which the free run of a wall converges
_MOST_STEPS, _SLOWLY = 5, 0.99  # of Gauss and Newton; less than a hundredth is no progress
_AS_FORETOLD = 1.001  # of the cost: most after a step that foretold next to nothing
_WORSE = 4.0  # times the cost with effects at the measured motion: the iteration diverged


def refine(recordings: Recordings, found: Fit) -> tuple[Recordings, Fit]:
    """Minimise the output error."""
    if not found.model.nominal.environment.unilateral:
        return _refine_wall(recordings, found)
    runs = _free_runs(recordings, found.model)
    if not all(_close(one, run, _CLOSE) for one, run in zip(recordings, runs)):
        return recordings, found
    model = _least_output_error(recordings, found.model, runs)
    refined = fit_at(recordings, model)
    kept = refined.cost <= _ALIKE * found.cost and model.plausible()
    return recordings, refined if kept else found


def _refine_wall(recordings: Recordings, found: Fit) -> tuple[Recordings, Fit]:
    iterated = [replace(recording, picard_rounds=_PICARD) for recording in recordings]
    refined = fit_to_end(iterated, fit(iterated, found.model))
    if refined.cost <= _WORSE * found.cost and refined.model.plausible():
        return iterated, refined
    # The iteration does not converge for a strongly nonlinear wall.
    return [replace(recording, picard_rounds=1) for recording in recordings], found


def _least_output_error(recordings: Recordings, model: Model, runs: Sequence[Run]) -> Model:
    """Search the values of least output error from those of a model with these free runs."""
    def errors(these: Array) -> Array:
        there = model.with_free(these)
        return _errors(recordings, runs if there == model else _free_runs(recordings, there))

    low, high = model.ranges
    search = SecantJacobian(errors, model.steps, high, _STEP)
    values = model.coordinates
    here = search.residuals(values)
    for _ in range(_MOST_STEPS):
        jacobian = search.jacobian(values) * model.steps
        change = np.linalg.lstsq(jacobian, -here, rcond=1e-9)[0]
        foretold = sum_of_squares(here + jacobian @ change)
        tried = np.clip(values + change * model.steps, low, high)
        there = search.residuals(tried)
        before, after = sum_of_squares(here), sum_of_squares(there)
        if after < before:
            values, here = tried, there
        if after > _SLOWLY * before:
            little = foretold > _SLOWLY * before and after < _AS_FORETOLD * before
            if little or not search.updated:
                break
            search.renew()  # the updated Jacobian points astray
    return model.with_free(values)


def _close(recording: PreparedRecording, run: Run, bound: float) -> bool:
    error = (recording.observed.raw_position - run.position)[recording.use]
    return float(np.std(error)) < bound * recording.motion.error


def _free_runs(recordings: Recordings, model: Model) -> list[Run]:
    return [free_run(model, recording.observed) for recording in recordings]


def _errors(recordings: Recordings, runs: Sequence[Run]) -> Array:
    parts = []
    for recording, run in zip(recordings, runs):
        o = recording.observed
        parts += [recording.motion.average(o.raw_position - run.position),
                  recording.force.average(o.force - run.force)]
    return huber(np.concatenate(parts))
