# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The series that the figures of a diagnosis show."""

from math import sqrt
from typing import Mapping, NamedTuple

import numpy as np

from ..observe.model import Model
from ..observe.prepared_recording import PreparedRecording
from ..observe.residuals import force_residual, motion_residual
from ..observe.usable_samples import usable
from ..result import Diagnosis
from ...physics.numeric import Array

Span = tuple[float, float]

_CLOSE_UP_S, _CLOSE_UP = 1.5, 0.125  # at least, and as a share of the recording
_MOST_SWINGS = 30.0  # of a vibrating wall in a close-up: more merge into a band
_GAP_S = 0.2  # excluded touch-downs do not split a held-out part
_MOST_DOTS = 3000


class Comparison(NamedTuple):
    """A signal as recorded and as predicted by each model, shape (N,)."""

    label: str  # name with unit
    recorded: Array
    predicted: Mapping[str, Array]


class Residuals(NamedTuple):
    """Residuals of a channel, measured less predicted, averaged over blocks."""

    label: str  # name with unit
    by_model: Mapping[str, Array]  # (blocks,)
    noise: float  # standard deviation of a block mean under a correct model
    located_s: list[Span]  # of the mismatch; empty if in the other channel


class MotionPlane(NamedTuple):
    """Residuals over position and velocity, each of shape (D,)."""

    channel: str  # 'force' or 'motion'
    x_label: str
    x: Array  # relative to the nominal wall [m]
    v: Array  # [m/s]
    by_model: Mapping[str, Array]  # in standard deviations of their noise


class PlotData(NamedTuple):
    """All series of the recording that is shown."""

    pair: tuple[str, str]  # the models compared: before and after the correction
    t: Array  # (N,) [s]
    force: Comparison
    position: Comparison | None  # None without a free run
    block_t: Array  # (blocks,) centres [s]
    residuals: list[Residuals]  # of force, motion, or both
    plane: MotionPlane  # of the channel that shows the mismatch
    close_up: slice  # samples around the greatest mismatch
    held_out_s: list[Span]  # parts excluded from fitting


def plot_data(diagnosis: Diagnosis) -> PlotData:
    """Compute the series of the recording that the recalibrated model explains worst."""
    recording, pair = diagnosis.recordings[0], diagnosis.pair
    names = tuple(dict.fromkeys(('nominal', *pair)))
    models: dict[str, Model] = {name: getattr(diagnosis, name) for name in names}
    o = recording.observed
    force = {name: force_residual(recording, model) for name, model in models.items()}
    position = None
    if diagnosis.free_runs:
        runs = {name: 1e3 * diagnosis.free_runs[name] for name in names}
        position = Comparison('position, free run [mm]', 1e3 * o.raw_position, runs)
    in_motion = diagnosis.located_channel == 'motion'
    located = [] if diagnosis.location is None else diagnosis.location.intervals_s
    residuals = [
        *_force_residuals(recording, models, force, [] if in_motion else located),
        *_motion_residuals(recording, models, located if in_motion else [])]
    shown = residuals[-1 if in_motion else 0]
    blocks = np.arange(len(o.t) // recording.block, dtype=np.float64)
    return PlotData(
        pair, o.t,
        Comparison('force [N]', o.force, {name: o.force - e for name, e in force.items()}),
        position, o.t[0] + o.h * recording.block * (0.5 + blocks), residuals,
        _plane(recording, models[pair[-1]], shown, in_motion),
        _close_up(recording, shown.by_model[pair[0]]), _held_out(diagnosis))


def _force_residuals(
    recording: PreparedRecording, models: Mapping[str, Model], force: Mapping[str, Array],
    located: list[Span],
) -> list[Residuals]:
    if recording.driven_by_force(models['nominal']):
        return []
    means = {name: recording.blocks(e) for name, e in force.items()}
    noise = recording.force_noise / sqrt(recording.block)
    return [Residuals('force residual [N]', means, noise, located)]


def _motion_residuals(
    recording: PreparedRecording, models: Mapping[str, Model], located: list[Span]
) -> list[Residuals]:
    """Average the innovations: measured less one-step-ahead prediction of the motion."""
    innovations = {name: motion_residual(recording, model) for name, model in models.items()}
    means = {name: 1e6 * recording.blocks(e) for name, e in innovations.items() if e is not None}
    if len(means) < len(models):
        return []
    noise = 1e6 * recording.observed.position_noise / sqrt(recording.block)
    return [Residuals('motion residual [µm]', means, noise, located)]


def _close_up(recording: PreparedRecording, residual: Array) -> slice:
    """Choose the stretch with the greatest residuals, short impacts clipped."""
    o = recording.observed
    turns = np.count_nonzero(np.diff(np.sign(o.x - np.median(o.x))))
    swings = turns / float(o.t[-1] - o.t[0])  # [1/s]
    duration = max(_CLOSE_UP_S * o.pace, _CLOSE_UP * float(o.t[-1] - o.t[0]))
    duration = min(duration, _MOST_SWINGS / max(swings, 1e-9))
    span = min(len(o.t), max(2, round(duration / o.h)))
    clipped = np.minimum(np.abs(residual), np.percentile(np.abs(residual), 99.0))
    width = max(1, span // recording.block)
    energy = np.convolve(clipped**2, np.ones(width), mode='valid')
    first = min(int(np.argmax(energy)) * recording.block, len(o.t) - span)
    return slice(first, first + span)


def _plane(
    recording: PreparedRecording, model: Model, residuals: Residuals, in_motion: bool
) -> MotionPlane:
    o, law = recording.observed, model.laws().contact
    wall = model.nominal.environment.location
    x, v = (recording.blocks(signal) for signal in (o.x - wall, o.v))
    use = recording.blocks((recording.use | usable(model, o)).astype(float)) > 0.5
    label = 'position relative to the wall [mm]'
    if law.unilateral and not in_motion:
        use &= recording.touching(model)
        label = 'depth in the wall [mm]'
    if not law.unilateral:
        label = 'deflection [mm]'
    chosen = np.flatnonzero(use)
    chosen = chosen[::max(1, len(chosen) // _MOST_DOTS)]
    scaled = {name: e[chosen] / residuals.noise for name, e in residuals.by_model.items()}
    return MotionPlane('motion' if in_motion else 'force', label, x[chosen], v[chosen], scaled)


def _held_out(diagnosis: Diagnosis) -> list[Span]:
    """Return the spans of the shown recording that were excluded from fitting."""
    recording = diagnosis.recordings[0]
    o = recording.observed
    held = usable(diagnosis.nominal, o) & ~recording.use
    spans: list[Span] = []
    edges = np.flatnonzero(np.diff(held.astype(int), prepend=0, append=0))
    for first, stop in zip(edges[::2].tolist(), edges[1::2].tolist()):
        begin, end = float(o.t[first]), float(o.t[stop - 1])
        if spans and begin - spans[-1][1] < _GAP_S * o.pace:
            spans[-1] = spans[-1][0], end
        else:
            spans.append((begin, end))
    return spans
