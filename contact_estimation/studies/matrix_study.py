# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
Errors and coverage of the full stiffness and damping matrices, with and without friction.

Walls of 300 to 3e4 N/m in random directions, symmetric or not; a force sensor with a pole of 100
to 300 Hz on each axis, noise, stamps off by 0.1 ms, positions in steps of 1 um; motion in three
directions.
"""

from __future__ import annotations

from math import log, nan, pi
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.signal import butter, lfilter

from ..commands.command_line import command, Parser, require_at_least
from ..estimators.stiffness_matrix import (
    MatrixEstimate, StiffnessMatrix, StiffnessMatrixParameters)
from ..signals.contact_sample import AxesSample, ContactSample
from ..signals.synchronisation import SynchronisationParameters

Array = NDArray[np.float64]

FRICTIONS = (0.0, 0.1, 0.3, 0.8)
_RATE, _FINE = 500.0, 10_000.0  # of the samples; of wall and sensor [Hz]
_APPROACH_S, _GAP = 0.5, 5e-3  # [s], [m]
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
    friction: float  # coefficient of Coulomb friction


def make_world(index: int, friction: float, seed: int, hold_s: float = 6.0) -> MatrixWorld:
    """
    Draw and simulate a wall.

    index: of the world; the same wall and motion for every friction
    friction: coefficient of friction; its force is along the tangential velocity
    hold_s: duration of the motion in contact [s]
    """
    draw = np.random.default_rng([seed, index])
    frame = np.linalg.qr(draw.standard_normal((3, 3)))[0]  # the normal is its first column
    k = np.sort(_log_uniform(draw, _SOFTEST, _STIFFEST, 3))[::-1]
    skew = np.triu(draw.standard_normal((3, 3)), 1) * (index % 2)
    K = frame @ np.diag(k) @ frame.T + _ASYMMETRY * float(k.prod()) ** (1 / 3) * (skew - skew.T)
    B = frame @ np.diag(k * _log_uniform(draw, 2e-3, 5e-2, 3)) @ frame.T
    t = np.arange(int((_APPROACH_S + hold_s) * _FINE)) / _FINE
    x = _path(t, k, draw) @ frame.T
    v, n = np.gradient(x, 1.0 / _FINE, axis=0), frame[:, 0]
    touching = x @ n > 0.0
    pressed = (x @ K.T + v @ B.T) * touching[:, None]
    along = v - np.outer(v @ n, n)
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-6)
    pressed += friction * np.maximum(pressed @ n, 0.0)[:, None] * along
    samples = _measure(t, x, -pressed, draw)
    contact = touching[::round(_FINE / _RATE)][1:len(samples) + 1].tolist()
    return MatrixWorld(samples, contact, K, B, n, friction)


def _log_uniform(draw: np.random.Generator, low: float, high: float, count: int) -> Array:
    return low * np.exp(draw.uniform(0.0, log(high / low), count))


def _path(t: Array, k: Array, draw: np.random.Generator) -> Array:
    """Press, and move by two sines along the normal and each direction of the wall."""
    depth = min(draw.uniform(8.0, 40.0) / float(k[0]), 0.03)
    s = np.clip(t / _APPROACH_S, 0.0, 1.0)
    into = s**3 * (10.0 - 15.0 * s + 6.0 * s**2)
    size = np.minimum(_SIDEWAYS_N / k, _SIDEWAYS_M) * draw.uniform(0.3, 1.0, 3)
    size[0] = 0.5 * depth
    hertz, phase = draw.uniform(0.5, 6.0, (2, 3)), draw.uniform(0.0, 2.0 * pi, (2, 3))
    share = draw.uniform(0.2, 0.8, 3)
    x = np.einsum('pi,pti->ti', [share * size, (1.0 - share) * size],
                  np.sin(2.0 * pi * hertz[:, None] * t[:, None] + phase[:, None]))
    x *= np.clip((t - _APPROACH_S) / 0.3, 0.0, 1.0)[:, None]
    x[:, 0] += -_GAP + (_GAP + depth) * into
    return np.asarray(x)


def _measure(t: Array, x: Array, F: Array, draw: np.random.Generator) -> list[AxesSample]:
    """Filter each force, and sample both with errors of the stamps."""
    stamps = np.arange(1, int(t[-1] * _RATE)) / _RATE
    noise = float(_log_uniform(draw, 0.1, 0.5, 1)[0])
    positions, forces = [], []
    for axis in range(3):
        sensed = lfilter(*butter(1, draw.uniform(100.0, 300.0), fs=_FINE), F[:, axis])
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
        for k in range(len(stamps))
    ]


class Score(NamedTuple):
    """How an estimate fits the truth."""

    # K_error, B_error, angle: relative errors of the matrices (Frobenius) and the angle of the
    # normal [deg]
    K_error: float
    B_error: float
    angle: float
    # K_inside, B_inside, normal_inside, friction_inside: share of the entries within 2 standard
    # deviations
    K_inside: float
    B_inside: float
    normal_inside: float
    friction_inside: float
    friction_named: float  # 1 where the reason names friction


def estimate_of(world: MatrixWorld) -> MatrixEstimate:
    """Return the last estimate of a world."""
    estimator = StiffnessMatrix(
        StiffnessMatrixParameters(), SynchronisationParameters().timing_std)
    return estimator.process(world.samples, world.contact)[-1]


def score_of(found: MatrixEstimate, world: MatrixWorld) -> Score:
    """Compare an estimate with its world."""
    pairs = ((found.stiffness, world.stiffness, found.stiffness_std),
             (found.damping, world.damping, found.damping_std))
    angle = float(np.arccos(min(abs(float(found.normal @ world.normal)), 1.0)))
    K_error, B_error = (float(np.linalg.norm(value - true) / np.linalg.norm(true))
                        for value, true, _ in pairs)
    K_inside, B_inside = (float((np.abs(value - true) < 2.0 * std).mean())
                          for value, true, std in pairs)
    return Score(
        K_error, B_error, float(np.degrees(angle)), K_inside, B_inside,
        float(angle < 2.0 * found.normal_std),
        float(abs(found.friction - world.friction) <= 2.0 * found.friction_std),
        float('friction' in found.reason))


def make_parser() -> Parser:
    """Build the command line of the study."""
    parser = Parser(
        prog='studies matrix',
        description='Estimate the full matrices in simulated contacts with sensors as real ones '
        'are, with and without friction along the wall. Prints a Markdown table: errors of K, B '
        'and the normal, and how often the truth is within 2 standard deviations.')
    parser.add_argument('--worlds', type=int, default=60, help='worlds for each friction (60)')
    parser.add_argument('--seed', type=int, default=0, help='of all worlds (0)')
    parser.add_argument('--seconds', type=float, default=6.0, help='of motion in contact (6)')
    return parser


def run(options: Any) -> int:
    """Run the study and print it."""
    require_at_least(options, worlds=1, seed=0, seconds=0.5)
    print('| mu | K error, median / 90 % | B error | angle of the normal [deg] | K within 2 std '
          '| B | normal | mu | friction identified |\n|' + ' --- |' * 9)
    for friction in FRICTIONS:
        worlds = (make_world(k, friction, options.seed, options.seconds)
                  for k in range(options.worlds))
        table = np.array([score_of(estimate_of(world), world) for world in worlds])
        errors = ' | '.join(
            f'{middle:.2g} / {high:.2g}{unit}' for middle, high, unit in zip(
                *np.quantile(table[:, :3] * [100.0, 100.0, 1.0], (0.5, 0.9), axis=0),
                (' %', ' %', '')))
        shares = ' | '.join(f'{100.0 * share:.0f} %' for share in table[:, 3:].mean(axis=0))
        print(f'| {friction:g} | {errors} | {shares} |', flush=True)
    return 0


main = command(make_parser, run)
