# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Row of the on-line study: the full stiffness and damping matrices, with and without friction."""

from math import nan, pi
from typing import NamedTuple

import numpy as np
from scipy.signal import butter, lfilter

from .online_row import Row, Score
from .online_worlds import FINE
from .paths import Array, ramp
from ..estimators.stiffness_matrix import (
    MatrixEstimate, StiffnessMatrix, StiffnessMatrixParameters)
from ..physics.prior import log_uniform
from ..signals.contact_sample import AxesSample, ContactSample
from ..signals.synchronisation import SynchronisationParameters

FRICTIONS = (0.0, 0.1, 0.3, 0.8)
_RATE = 500.0  # of the samples [Hz]
_APPROACH_S, _HOLD_S, _GAP = 0.5, 6.0, 5e-3  # [s], [s], [m]
_SOFTEST, _STIFFEST = 300.0, 3e4  # [N/m]
_SIDEWAYS_N, _SIDEWAYS_M = 15.0, 3e-3  # the motion along the wall reaches neither
_JITTER_S, _POSITION_STEP, _FORCE_STEP = 1e-4, 1e-6, 0.02
_ASYMMETRY = 0.05  # of the geometric mean of the stiffnesses, in every second wall


class MatrixWorld(NamedTuple):
    """Samples of a wall with the truth."""

    samples: list[AxesSample]  # of x, y and z
    contact: list[bool]  # whether the tool touches
    # stiffness, damping (3, 3): k [N/m] and B [N s/m]
    stiffness: Array
    damping: Array
    normal: Array  # (3,) unit vector into the wall, the stiffest direction
    friction: float  # coefficient of Coulomb friction, against the tangential velocity


def make_world(draw: np.random.Generator, index: int) -> MatrixWorld:
    """Simulate a wall in a random direction, symmetric or not, and motion in three directions."""
    friction = FRICTIONS[index % len(FRICTIONS)]
    frame = np.linalg.qr(draw.standard_normal((3, 3)))[0]  # the normal is its first column
    k = np.sort([log_uniform(draw, _SOFTEST, _STIFFEST) for _ in range(3)])[::-1]
    skew = np.triu(draw.standard_normal((3, 3)), 1) * (index // len(FRICTIONS) % 2)
    K = frame @ np.diag(k) @ frame.T + _ASYMMETRY * float(k.prod()) ** (1 / 3) * (skew - skew.T)
    B = frame @ np.diag(k * [log_uniform(draw, 2e-3, 5e-2) for _ in range(3)]) @ frame.T
    t = np.arange(int((_APPROACH_S + _HOLD_S) * FINE)) / FINE
    x = _path(t, k, draw) @ frame.T
    v, n = np.gradient(x, 1.0 / FINE, axis=0), frame[:, 0]
    touching = x @ n > 0.0
    pressed = (x @ K.T + v @ B.T) * touching[:, None]
    along = v - np.outer(v @ n, n)
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-6)
    pressed += friction * np.maximum(pressed @ n, 0.0)[:, None] * along
    samples = _measure(t, x, -pressed, draw)
    contact = touching[::round(FINE / _RATE)][1:len(samples) + 1].tolist()
    return MatrixWorld(samples, contact, K, B, n, friction)


def _path(t: Array, k: Array, draw: np.random.Generator) -> Array:
    """Press, and move by two sines along the normal and each direction of the wall."""
    depth = min(draw.uniform(8.0, 40.0) / float(k[0]), 0.03)
    size = np.minimum(_SIDEWAYS_N / k, _SIDEWAYS_M) * draw.uniform(0.3, 1.0, 3)
    size[0] = 0.5 * depth
    hertz, phase = draw.uniform(0.5, 6.0, (2, 3)), draw.uniform(0.0, 2.0 * pi, (2, 3))
    share = draw.uniform(0.2, 0.8, 3)
    x = np.einsum('pi,pti->ti', [share * size, (1.0 - share) * size],
                  np.sin(2.0 * pi * hertz[:, None] * t[:, None] + phase[:, None]))
    x *= np.clip((t - _APPROACH_S) / 0.3, 0.0, 1.0)[:, None]
    x[:, 0] += ramp(0.0, _APPROACH_S, _GAP + depth)(t)[0] - _GAP
    return np.asarray(x)


def _measure(t: Array, x: Array, F: Array, draw: np.random.Generator) -> list[AxesSample]:
    """Filter each force by a pole of 100 to 300 Hz; sample both with errors of the stamps."""
    stamps = np.arange(1, int(t[-1] * _RATE)) / _RATE
    noise = log_uniform(draw, 0.1, 0.5)
    positions, forces = [], []
    for axis in range(3):
        sensed = lfilter(*butter(1, draw.uniform(100.0, 300.0), fs=FINE), F[:, axis])
        read = np.interp(stamps + _JITTER_S * draw.standard_normal(len(stamps)), t, sensed)
        read += noise * draw.standard_normal(len(stamps))
        forces.append(_FORCE_STEP * np.round(read / _FORCE_STEP))
    at = stamps + _JITTER_S * draw.standard_normal(len(stamps))
    for axis in range(3):
        where = np.interp(at, t, x[:, axis])
        positions.append(_POSITION_STEP * np.round(where / _POSITION_STEP))
    return [
        tuple(ContactSample(round(stamps[k] * 1e9), float(positions[i][k]), nan,
                            float(forces[i][k])) for i in range(3))
        for k in range(len(stamps))]


def estimate_of(world: MatrixWorld, _: str) -> MatrixEstimate:
    """Return the last estimate of a world, whatever the estimator of single axes."""
    estimator = StiffnessMatrix(
        StiffnessMatrixParameters(), SynchronisationParameters().timing_std)
    return estimator.process(world.samples, world.contact)[-1]


def score_of(world: MatrixWorld, found: MatrixEstimate) -> Score:
    """Compare an estimate with its world: errors by the Frobenius norm, bands entry by entry."""
    pairs = ((found.stiffness, world.stiffness, found.stiffness_std),
             (found.damping, world.damping, found.damping_std))
    K_error, B_error = (float(np.linalg.norm(value - true) / np.linalg.norm(true))
                        for value, true, _ in pairs)
    K_held, B_held = ((int((np.abs(value - true) < 2.0 * std).sum()), value.size)
                      for value, true, std in pairs)
    angle = float(np.arccos(min(abs(float(found.normal @ world.normal)), 1.0)))
    return Score(f'mu = {world.friction:g}', K_error, B_error, K_held, B_held, {
        'angle of the normal [deg]': float(np.degrees(angle)),
        'normal in 2 std': bool(angle < 2.0 * found.normal_std),
        'mu in 2 std': bool(abs(found.friction - world.friction) <= 2.0 * found.friction_std),
        'friction identified': 'friction' in found.reason})


ROWS = {'matrix': Row('full matrices after 6 s of motion', 240, 24, make_world, score_of,
                      estimate_of)}
"""By name."""
