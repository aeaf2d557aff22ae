# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Which samples of a recording count, and how many make one residual."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d, minimum_filter1d, uniform_filter1d

from .model import Model
from .observed import Observed
from .observer import FORGOTTEN
from .shares import LITTLE, MUCH, SLIGHT
from .signals import LEAST_SAMPLES, Recording
from .smoothing import quantisation_step
from ...physics.numeric import Array, Flags, stretches

_DROP_S, _LEAST_DROPS = 0.5, 3
_BRIEF = 3  # samples
_CYCLE, _FORGETTING = 2, 4  # strokes
_FASTEST, _SMOOTHED = 0.99, 0.005  # of the samples
_IMPACT_BEFORE, _IMPACT_AFTER = 2, 3  # unpredictable samples around touch-down
_COARSE = 4.0  # quanta: smaller steps come from the resolution


def usable(model: Model, observed: Observed) -> Flags:
    """Find the samples that a model can be expected to predict."""
    o = observed
    use = np.ones(len(o.t), bool)
    use[:5] = use[-5:] = False
    if o.reference is not None and o.starts_moving:
        use[:round(FORGOTTEN / (o.observer_cutoff * o.h))] = False
    laws = model.laws()
    if not laws.contact.unilateral:
        if not _starts_unloaded(model, o):
            use &= ~o.start  # its initial state is unknown
            if model.nominal.environment.inertia == 0.0 and _starts_loaded(o.force):
                use[:_until_known(o.x)] = False
        if o.held is not None:
            use &= ~o.held
    else:
        inside = laws.touching(o)
        for first in np.flatnonzero(np.diff(inside.astype(int)) > 0).tolist():
            use[max(0, first + 1 - _IMPACT_BEFORE):first + 1 + _IMPACT_AFTER] = False
    return use


def _starts_unloaded(model: Model, observed: Observed) -> bool:
    """Return whether an attached wall without mass starts undeformed: its states are then 0."""
    o, wall = observed, model.nominal.environment
    if wall.inertia > 0.0:
        return False
    return all(abs(float(signal[0])) < SLIGHT * float(np.max(np.abs(signal)))
               for signal in (o.x - wall.location, o.force))


def _starts_loaded(force: Array) -> bool:
    """Return whether a recording begins in the midst of a cycle."""
    return abs(float(force[0])) > MUCH * float(np.max(np.abs(force)))


def _until_known(x: Array) -> int:
    """Return how many samples it takes to forget what came before a recording of many strokes."""
    # Friction and hysteresis forget it within a few strokes over the whole range, whose length may
    # be that of their memory; 0 where a cycle would be much of the recording.
    strokes = np.cumsum(np.abs(np.diff(x))) / np.ptp(x)
    known = int(min(strokes[round(LITTLE * len(strokes))], _FORGETTING))
    return int(np.searchsorted(strokes, known)) if known >= _CYCLE else 0


def held_at_rest(model: Model, observed: Observed) -> Flags | None:
    """Find the stretches in which a drive without a spring is held, by forces that differ."""
    # What holds it follows the force, so that no law of the motion predicts that.
    o, wall = observed, model.nominal.environment
    if o.reference is not None or wall.unilateral or wall.stiffness != 0.0:
        return None
    rests = np.zeros(len(o.t), bool)
    slow = np.abs(o.v) < SLIGHT * np.quantile(np.abs(o.v), _FASTEST)
    for first, stop in stretches(slow):
        rests[first:stop] = slow[first] and stop - first > SLIGHT * len(slow)
    span = max(1, round(_SMOOTHED * len(slow)))
    inside = minimum_filter1d(rests, 2 * span + 1)
    force = uniform_filter1d(o.force, span)[inside]
    differ = len(force) and np.ptp(force) > LITTLE * o.force_range
    return rests if differ and np.mean(rests) < 1.0 - MUCH else None


def force_drops(observed: Observed, noise: float, touching: Flags) -> Flags | None:
    """Find the samples at which the force vanishes during contact."""
    o = observed
    strong = max(20.0 * noise, 0.05 * float(np.max(np.abs(o.force))))
    size, pressing = np.abs(o.force), o.force < -strong
    weak = (size < 5.0 * noise) | _nearly_none(size)
    dropped, sharp = np.zeros(len(o.t), bool), 0
    for first, stop in stretches(weak):
        inside = weak[first] and 0 < first and stop < len(o.t) and touching[first:stop].all()
        if not inside or (stop - first) * o.h >= _DROP_S * min(o.pace, 1.0):
            continue
        sharp += bool(pressing[first - 1] and pressing[stop])
        # The sensor may catch the force on its way.
        dropped[first:stop] = pressing[max(0, first - 2):first].any() and (
            pressing[stop:stop + 2].any())
    return dropped if sharp >= _LEAST_DROPS else None


def _nearly_none(size: Array) -> Flags:
    """Find brief drops whose samples, interpolated between stamps that jitter, are not quite 0."""
    weak = size < LITTLE * maximum_filter1d(size, 2 * _BRIEF + 1)
    for first, stop in stretches(weak):
        weak[first:stop] &= stop - first <= _BRIEF
    return weak


def default_block(observed: Observed) -> int:
    """Choose how many samples make one residual."""
    o = observed
    if o.reference is None and o.cutoff * o.pace > 15.0:
        return 1
    return max(1, round(0.01 * o.pace / o.h))


def without_held_samples(recording: Recording) -> Recording:
    """Keep each value once where wrench or joint states repeat them regularly."""
    s = recording.signals
    wrench, joint = updates(s.force), updates(s.position)
    if len(wrench) == len(s.force) and len(joint) == len(s.position):
        return recording
    return replace(recording, signals=s._replace(
        wrench_t=s.wrench_t[wrench], force=s.force[wrench],
        joint_t=s.joint_t[joint], position=s.position[joint]))


def updates(values: Array) -> NDArray[np.int_]:
    """Find the samples at which a sensor gave a new value."""
    every = np.arange(len(values))
    starts = np.concatenate(([0], np.flatnonzero(np.diff(values)) + 1))
    counts = np.diff(np.append(starts, len(values)))
    usual = int(np.median(counts))
    if usual < 2 or len(starts) < LEAST_SAMPLES:
        return every
    size = float(np.median(np.abs(np.diff(values[starts]))))
    regular = np.mean(np.abs(counts - usual) <= 1) >= 1.0 - MUCH
    if not regular or size < _COARSE * quantisation_step(values):
        return every
    since = every - np.repeat(starts, counts)
    return every[since % usual == 0]
