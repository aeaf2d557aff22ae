# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Location of a mismatch: port, time, phase of the contact, region of the motion, band."""

from typing import Any, NamedTuple

import numpy as np
from scipy.signal import periodogram

from .observe.model import Model
from .observe.prepared_recording import PreparedRecording
from .observe.residuals import (
    force_explains_motion, force_residual, motion_residual, residuals, response_to)
from .observe.shares import LITTLE, SLIGHT
from ..physics.effect import Effect, Need
from ..physics.numeric import Array, Flags

_WINDOW_S = 0.1
_STRONG = 2.5  # mean square of the residual in a window, in those of the noise
_GAP_S = 0.3  # intervals closer than this are one
_MOST_INTERVALS = 12
_ENTRY_S = 0.15


class Location(NamedTuple):
    """Location of a mismatch."""

    port: str  # 'contact', 'force_sensor' or 'robot'
    intervals_s: list[tuple[float, float]]  # times of large residuals [s]
    phase: str  # 'free', 'entry', 'loading', 'hold', 'unloading' or 'all'
    region: str  # of depth and speed, in words
    # frequencies between which four fifths of the residual's energy lie
    band_hz: tuple[float, float]

    def as_dict(self) -> dict[str, Any]:
        """Return the form of the report."""
        return {
            'port': self.port,
            'intervals_s': [[round(a, 3), round(b, 3)] for a, b in self.intervals_s],
            'phase': self.phase, 'region': self.region,
            'band_hz': [round(f, 3) for f in self.band_hz],
        }


def locate(
    recording: PreparedRecording, model: Model, acting: type[Effect] | None = None,
) -> Location:
    """Locate the misfit of a model."""
    parts = recording.split(residuals(recording, model)) ** 2
    port = acting.port if acting else guess_port(recording, model)
    in_motion = Need.ROBOT in acting.needs if acting else port == 'robot'
    energy = parts[-1] if in_motion else parts[0]
    return Location(
        port, intervals(recording, energy), _phase(energy, phases(recording, model)),
        _region(recording, model, energy), _band(recording, model, in_motion))


def guess_port(recording: PreparedRecording, model: Model) -> str:
    """Infer the port from the channels in which residuals are."""
    # A missing effect of the contact shows in the measured force and, through that force, in the
    # motion; one of the sensor in the force alone; one of the robot in the motion alone.
    missing = force_residual(recording, model)
    response = response_to(recording, missing * recording.use, model)
    innovations = motion_residual(recording, model)
    if response is None or innovations is None:
        return 'contact'
    force = recording.force.average(missing)
    motion = recording.motion.average(innovations)
    excess = [max(0.0, float(np.sum(part**2 - 1.0))) for part in (force, motion)]
    if excess[1] < SLIGHT * excess[0]:
        return 'force_sensor'
    if excess[0] < SLIGHT * excess[1]:
        return 'robot'
    if force_explains_motion(recording, model):
        return 'contact'
    pushed = recording.motion.average(response)
    return 'force_sensor' if float(pushed @ pushed) > float(motion @ motion) else 'robot'


def intervals(recording: PreparedRecording, energy: Array) -> list[tuple[float, float]]:
    """Find the times at which residuals exceed the noise."""
    step, pace = recording.block_s, recording.observed.pace
    span = max(1, round(_WINDOW_S * pace / step))
    mean = np.convolve(energy, np.ones(span) / span, mode='same')
    strong = mean > max(_STRONG, 0.05 * float(np.max(mean)))
    edges = np.flatnonzero(np.diff(strong.astype(int), prepend=0, append=0))
    merged: list[list[int]] = []
    for first, stop in zip(edges[::2].tolist(), edges[1::2].tolist()):
        if merged and (first - merged[-1][1]) * step < _GAP_S * pace:
            merged[-1][1] = stop
        else:
            merged.append([first, stop])
    merged.sort(key=lambda pair: -float(np.sum(energy[pair[0]:pair[1]])))
    begin = float(recording.observed.t[0])
    return sorted((begin + a * step, begin + b * step) for a, b in merged[:_MOST_INTERVALS])


def phases(recording: PreparedRecording, model: Model) -> dict[str, Flags]:
    """Divide a recording into the phases of its contacts."""
    o, law = recording.observed, model.laws().contact
    v = recording.blocks(o.v)
    if not law.unilateral:
        return {'loading': v > 0.0, 'unloading': v <= 0.0}
    inside = recording.touching(model)
    since = np.zeros(len(v))
    for k in range(1, len(v)):
        since[k] = since[k - 1] + recording.block_s if inside[k] else 0.0
    speed = np.percentile(np.abs(v[inside]), 95) if inside.any() else 1.0
    entry, slow = inside & (since < _ENTRY_S * o.pace), np.abs(v) < LITTLE * speed
    rest = inside & ~entry
    return {'free': ~inside, 'entry': entry, 'hold': rest & slow,
            'loading': rest & ~slow & (v > 0.0), 'unloading': rest & ~slow & (v < 0.0)}


def _phase(energy: Array, marks: dict[str, Flags]) -> str:
    """Return the phase with the largest residuals, if one stands out."""
    mean = {name: float(np.mean(energy[where])) for name, where in marks.items() if where.any()}
    ranked = sorted(mean, key=lambda name: -mean[name])
    if len(ranked) > 1 and mean[ranked[0]] < 1.5 * mean[ranked[1]]:
        return 'all'
    return ranked[0] if ranked else 'all'


def _region(recording: PreparedRecording, model: Model, energy: Array) -> str:
    """Describe where in the plane of depth and rate the residuals are large."""
    o, laws = recording.observed, model.laws()
    x, rate, _ = laws.at_wall(o)
    d, v = (recording.blocks(each) for each in (laws.contact.motion_along(o.t, x, rate).d, rate))
    use = d > 0.0 if laws.contact.unilateral else np.ones(len(d), bool)
    if use.sum() < 20:
        return 'free flight'
    words = []
    for name, signal in (('|v|', np.abs(v[use])), ('d', np.abs(d[use]))):
        low, high = signal <= np.percentile(signal, 33), signal >= np.percentile(signal, 67)
        ratio = float(np.mean(energy[use][low]) / max(np.mean(energy[use][high]), 1e-12))
        if ratio > 1.5:
            words.append(f'small {name}')
        elif ratio < 1.0 / 1.5:
            words.append(f'large {name}')
    return ', '.join(words) or 'all over the contact'


def _band(recording: PreparedRecording, model: Model, in_motion: bool) -> tuple[float, float]:
    motion = in_motion and recording.observed.reference is not None
    residual = (motion_residual if motion else force_residual)(recording, model)
    assert residual is not None
    rate = 1.0 / recording.observed.h
    frequencies, power = periodogram(np.where(recording.use, residual, 0.0), rate)
    floor = float(np.median(power[frequencies > 0.25 / recording.observed.h / 2.0]))
    energy = np.cumsum(np.maximum(power - floor, 0.0))
    if energy[-1] <= 0.0:
        return 0.0, float(frequencies[-1])
    low, high = np.searchsorted(energy, [0.1 * energy[-1], 0.9 * energy[-1]])
    return float(frequencies[low]), float(frequencies[min(high, len(frequencies) - 1)])
