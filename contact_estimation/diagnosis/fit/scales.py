# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The magnitudes of motion and forces in recordings."""

from __future__ import annotations

from itertools import combinations

import numpy as np
from numpy.typing import NDArray
from scipy.fft import next_fast_len

from .fitting import Fit
from ..observe.prepared_recording import PreparedRecording, Recordings
from ..observe.residuals import force_residual
from ...physics.drawn_effect import Scales, Tone

Array = NDArray[np.float64]
Tones = tuple[Tone, ...]

_LEAST = 1e-30  # in any unit
_PEAKS, _HIGHEST_HZ = 3, 12.0
_STRONG, _ALIKE = 40, 1e-3  # frequencies that are tried in pairs; relative singular value
_SPACED_S, _FINER = 0.02, 4  # samples of the residual; grid of the spectrum, over 1 / duration


def measure_scales(recordings: Recordings, base: Fit) -> Scales:
    """Measure depth, speed, forces and the periodic part of the contact residual."""
    model, laws = base.model, base.model.laws()
    depth = speed = force = control = pull = duration = _LEAST
    for recording in recordings:
        o = recording.observed
        inside = laws.touching(o) if laws.contact.unilateral else o.t >= 0.0
        if not inside.any():
            continue
        depth = max(depth, float(np.max(np.abs(o.x[inside] - model.nominal.environment.location))))
        speed = max(speed, float(np.percentile(np.abs(o.v[inside]), 98)))
        force = max(force, float(np.max(np.abs(o.force))))
        pull = max(pull, float(np.percentile(o.force, 99.8)))
        duration = max(duration, float(o.t[-1]))
        if o.reference is not None:
            u = laws.robot.impedance_force(o.x, o.v, o.reference)
            control = max(control, float(np.max(np.abs(u))))
    spectrum, beat = _spectrum(recordings[0], base)
    return Scales(
        depth, speed, force, control, pull, duration, max(model.stiffness, _LEAST),
        max(model.damping, _LEAST), laws.robot.mass, spectrum,
        min(recording.observed.h for recording in recordings), beat,
        any(recording.driven_by_force(model) for recording in recordings),
    )


def _spectrum(recording: PreparedRecording, base: Fit) -> tuple[Tones, Tones]:
    """Find the largest peaks of the contact residual, and the two tones that fit it best."""
    o = recording.observed
    laws = base.model.laws()
    if not laws.contact.unilateral:
        return (), ()
    residual = force_residual(recording, base.model)
    use = recording.use & o.measured & (laws.contact.force(o.t, *laws.at_wall(o)) < 0.0)
    stride = max(1, round(_SPACED_S * o.pace / o.h))
    use, r = use[::stride], residual[::stride]
    count = int(np.count_nonzero(use))
    if count < 50:
        return (), ()
    r = np.where(use, r - r[use].mean(), 0.0)
    finer = next_fast_len(_FINER * len(r))
    frequencies = np.fft.rfftfreq(finer, stride * o.h)
    sums = np.fft.rfft(r, finer) * np.exp(-2j * np.pi * frequencies * o.t[0])
    inside = (frequencies >= 0.5 / float(o.t[-1])) & (frequencies < _HIGHEST_HZ / o.pace)
    frequencies, amplitudes = frequencies[inside], 2.0 / count * sums[inside]
    order = np.argsort(-np.abs(amplitudes)).tolist()
    spacing = 1.0 / (finer * stride * o.h)
    found: list[Tone] = []
    for k in order:
        if all(abs(frequencies[k] - other) > 4.0 * spacing for other, _ in found):
            found.append((float(frequencies[k]), complex(amplitudes[k])))
        if len(found) == _PEAKS:
            break
    strong = np.sort(frequencies[order[:_STRONG]])
    return tuple(found), _beat(o.t[::stride][use], r[use], strong)


def _beat(t: Array, r: Array, frequencies: Array) -> Tones:
    """Fit all pairs of tones of some frequencies; return the best."""
    angles = 2.0 * np.pi * t[:, None] * frequencies
    columns = np.column_stack([np.cos(angles), np.sin(angles), np.ones(len(t))])
    gram, push, count = columns.T @ columns, columns.T @ r, len(frequencies)
    pairs = np.array(list(combinations(range(count), 2)), int).reshape(-1, 2)
    chosen = np.column_stack([pairs, pairs + count, np.full(len(pairs), 2 * count)])
    grams, pushes = gram[chosen[:, :, None], chosen[:, None, :]], push[chosen]
    # Two tones of one frequency are one: the rest of their difference would be huge.
    inverses = np.linalg.pinv(grams, rcond=_ALIKE, hermitian=True)
    weights = np.einsum('kij,kj->ki', inverses, pushes)
    explained = np.einsum('ki,ki->k', weights, 2.0 * pushes - np.einsum(
        'kij,kj->ki', grams, weights))
    if not np.any(explained > 0.0):
        return ()
    best = int(np.argmax(explained))
    tones = frequencies[pairs[best]].tolist()
    cosines, sines = weights[best, :2].tolist(), weights[best, 2:4].tolist()
    return tuple((tone, complex(cosine, -sine))
                 for tone, cosine, sine in zip(tones, cosines, sines))
