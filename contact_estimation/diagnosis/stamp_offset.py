# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""How much the stamps of a topic are off, as a parameter that is fitted with those of a model."""

from dataclasses import replace
from typing import NamedTuple, Sequence

import numpy as np
from scipy.optimize import minimize_scalar

from .fit.evidence import Scored
from .fit.fitting import fit, residual_function
from .observe.prepared_recording import prepare, Recordings
from .observe.signals import Recording
from ..physics.numeric import Array

_STEPS = 3  # of Gauss and Newton to an offset of stamps
_FAR_S = 0.03  # the longest of them: beyond, residuals are not linear
_FILTER_S, _OF_PERIOD = 0.003, 0.9  # less late is a filter, or the course between two samples
_EARLY_S = 0.0012  # less early is how well stamps are known


class Offset(NamedTuple):
    """A topic whose stamps differ from those of the others."""

    topic: str  # 'wrench' or 'joint_states'
    seconds: float  # how late the topic is stamped [s]; negative if early

    def put_right(self, one: Recording) -> Recording:
        """Shift the stamps of a recording, which count from the first wrench."""
        s, others = one.signals, self.seconds if self.topic == 'wrench' else 0.0
        joints = others - (self.seconds if self.topic == 'joint_states' else 0.0)
        return replace(one, signals=s._replace(
            joint_t=s.joint_t + joints, reference_t=s.reference_t + others))


def offset_of(topic: str, raw: Sequence[Recording], lawful: Scored) -> Offset | None:
    """Return by how much the stamps of a topic are off; None if by less than a filter."""
    period = max(float(np.median(np.diff(one.signals.joint_t))) for one in raw)
    offset = Offset(topic, 0.0)
    for _ in range(_STEPS):
        offset = _closer(raw, lawful, offset)
    late = offset.seconds > 0.0
    # A wrench that is late is what a sensor with a delay measures, an effect of the library, and
    # so are joints that are early, unless a reference tells which of the two is off.
    commanded = all(one.observed.reference is not None for one in lawful.found.recordings)
    least = max(_FILTER_S, _OF_PERIOD * period) if late else _EARLY_S
    if abs(offset.seconds) < least or (late if topic == 'wrench' else not (late or commanded)):
        return None
    found = minimize_scalar(
        lambda share: fit(_shifted(raw, lawful, offset._replace(
            seconds=share * offset.seconds)), lawful.found.found.model, steps=8).cost,
        method='bounded', bounds=(0.7, 1.5), options={'maxiter': 8})
    return offset._replace(seconds=float(found.x) * offset.seconds)


def _shifted(raw: Sequence[Recording], lawful: Scored, offset: Offset) -> Recordings:
    """Put the stamps of a topic right, with noise and discrepancy as before."""
    return [
        replace(prepare(offset.put_right(signals), lawful.found.found.model, hold=False),
                use=one.use, block=one.block, force_noise=one.force_noise,
                motion_noise=one.motion_noise, force_discrepancy=one.force_discrepancy,
                motion_discrepancy=one.motion_discrepancy, discount=one.discount)
        for signals, one in zip(raw, lawful.found.recordings)]


def _closer(raw: Sequence[Recording], lawful: Scored, offset: Offset) -> Offset:
    """Take a Gauss-Newton step of the offset of a topic, together with the values of a model."""
    told = lawful.found
    model, period = told.found.model, min(one.observed.h for one in told.recordings)

    def residuals_at(seconds: float) -> Array:
        there = _shifted(raw, lawful, offset._replace(seconds=seconds))
        return residual_function(there, model)(model.coordinates)

    here = residuals_at(offset.seconds)
    by_offset = (residuals_at(offset.seconds + period) - here) / period
    columns = np.column_stack((told.jacobian, by_offset * period))
    step = np.linalg.lstsq(columns, -here, rcond=1e-10)[0][-1] * period
    return offset._replace(seconds=offset.seconds + float(np.clip(step, -_FAR_S, _FAR_S)))
