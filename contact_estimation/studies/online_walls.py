# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Rows of the on-line study: walls of other laws, walls that change in contact, full matrices."""

from itertools import product
from math import inf, nan, pi
from typing import Any, NamedTuple

import numpy as np
from scipy.signal import butter, lfilter

from .online_row import (
    AS_TOLD, drawn_location, drawn_sensor, drawn_wall, law_families, presses, Row, Score, score,
    settled_instants, spread, Trace, WITHIN)
from .online_worlds import FINE, simulate, World
from .paths import Array, path_at, ramp
from ..estimators.stiffness_matrix import (
    MatrixEstimate, StiffnessMatrix, StiffnessMatrixParameters)
from ..physics.prior import log_uniform
from ..signals.contact_sample import AxesSample, ContactSample
from ..signals.synchronisation import SynchronisationParameters

_LAW_AFTER_S = 3.0
_PRESS = 40.0  # [N]
_STIFFNESSES = 1e3, 5e3, 2e4  # [N/m]
_LAWS: dict[str, tuple[str, dict[str, Any]]] = {
    'spring and damper': ('spring_damper', {}),
    'Hunt-Crossley, n = 1': ('hunt_crossley', {'exponent': 1.0}),
    'Hunt-Crossley, n = 1.5': ('hunt_crossley', {'exponent': 1.5}),
    'mass of 2 kg': ('mass', {'mass': 2.0}),
    'friction of 1 N': ('friction', {'friction': 1.0}),
    'friction of 5 N': ('friction', {'friction': 5.0}),
    'moving by 1 mm': ('moving', {}),
}
_MOTIONS = 'excited', 'still'
_CASES = list(product(_LAWS, _MOTIONS))
_MOVED, _MOVE_BEGIN_S, _MOVE_S = 1e-3, 0.5, 2.0  # [m], after the touch

_CHANGE_S, _CLOSE = 2.0, 0.1  # of the wall, after the touch; an error that counts as found
_STEPS: dict[str, tuple[tuple[float, float], float]] = {
    'x 2': ((1e3, 1e4), 2.0), 'x 0.1': ((3e3, 3e4), 0.1), 'x 10': ((3e2, 3e3), 10.0),
    '300 to 30000': ((3e2, 3e2), 100.0), '30000 to 300': ((3e4, 3e4), 0.01),
}
_STEP_CASES = list(product(_STEPS, _MOTIONS))
_STIFF_FORCE = 150.0  # of the stiffer of both walls [N]


def _laws(draw: np.random.Generator, index: int) -> World:
    law, motion = _CASES[index % len(_CASES)]
    repeat = index // len(_CASES)
    parameters, x_e = drawn_location(draw, (AS_TOLD, WITHIN)[repeat % 2])
    stiffness = _STIFFNESSES[repeat % 3]
    depth = min(_PRESS / stiffness, 0.03)
    wall = drawn_wall(draw, stiffness, x_e, depth=depth, **_LAWS[law][1])
    # A stronger damper would hide what the law adds to the spring.
    wall = wall._replace(damping=stiffness * log_uniform(draw, 2e-3, 2e-2))
    if _LAWS[law][0] == 'moving':
        # The touch is about 0.3 s after the approach has begun at 1 s. By more than a third of
        # the depth the contact would end.
        wall = wall._replace(shift=ramp(1.3 + _MOVE_BEGIN_S, _MOVE_S, min(_MOVED, depth / 3.0)))
    pieces, seconds = presses(draw, depth, contacts=1, excited=motion == 'excited')
    return simulate(f'{law}, {motion}', parameters, pieces, seconds, wall, drawn_sensor(draw),
                    draw)


def _score_laws(world: World, trace: Trace) -> Score:
    at = world.truth.contacts[0][0] + _LAW_AFTER_S
    more: dict[str, Any] = {}
    laws = law_families(trace, at)
    if laws:
        probability = laws.get(_LAWS[world.group.rpartition(', ')[0]][0], 0.0)
        more = {'right law first': probability == max(laws.values()),
                'probability of the right law': probability}
    return score(world, trace, at, [at], more)


def _steps(draw: np.random.Generator, index: int) -> World:
    step, motion = _STEP_CASES[index % len(_STEP_CASES)]
    (low, high), factor = _STEPS[step]
    parameters, x_e = drawn_location(draw, (AS_TOLD, WITHIN)[index // len(_STEP_CASES) % 2])
    wall = drawn_wall(draw, log_uniform(draw, low, high), x_e)
    # Of the softer wall, too, the spring presses more than the damper.
    wall = wall._replace(damping=min(wall.damping, 0.02 * wall.stiffness * factor))
    depth = min(_STIFF_FORCE / (wall.stiffness * max(1.0, factor)), 0.03)
    pieces, seconds = presses(draw, depth, contacts=1, hold_s=5.0, excited=motion == 'excited')
    change = 1.0 + 0.3 + _CHANGE_S

    def share(t: Array) -> Array:
        return np.where(t < change, 1.0, factor)

    return simulate(f'{step}, {motion}', parameters, pieces, seconds, wall._replace(factor=share),
                    drawn_sensor(draw), draw, {'change': change})


def _score_steps(world: World, trace: Trace) -> Score:
    change, (begin, end) = world.marks['change'], world.truth.contacts[0]
    return score(world, trace, instants=settled_instants(world, change - begin + 0.5), more={
        'to 10 % [s]': _settled_after(world, trace, change, end - 0.1)})


def _settled_after(world: World, trace: Trace, change: float, end: float) -> float:
    """Return the time from a change until K_hat stays within 10 % [s]; inf: never."""
    inside = (trace.t >= change) & (trace.t < end)
    if not inside.any():
        return nan
    t = trace.t[inside]
    truth = np.interp(t, world.truth.t, world.truth.stiffness)
    away = np.flatnonzero(np.abs(trace.K[inside] / truth - 1.0) > _CLOSE)
    if len(away) == 0:
        return 0.0
    return float(t[away[-1] + 1] - change) if away[-1] + 1 < len(t) else inf


def _drift(draw: np.random.Generator, index: int) -> World:
    """Stiffen by half within 10 s of a press."""
    parameters, x_e = drawn_location(draw, (AS_TOLD, WITHIN)[index % 2])
    wall = drawn_wall(draw, spread(index), x_e)
    depth = min(_STIFF_FORCE / (1.5 * wall.stiffness), 0.03)
    pieces, seconds = presses(draw, depth, contacts=1, hold_s=11.0)

    def factor(t: Array) -> Array:
        return 1.0 + 0.5 * np.clip((t - 2.3) / 10.0, 0.0, 1.0)

    return simulate('', parameters, pieces, seconds, wall._replace(factor=factor),
                    drawn_sensor(draw), draw)


_FOLLOWED = 'away', 'toward', 'to and fro'
_FOLLOW_S, _LAG_S = 6.0, 0.05  # duration of the motion; by which the tool follows at most
_FARTHEST, _NEAREST = 0.03, 1e-3  # distance of the motion [m]


def _followed(draw: np.random.Generator, index: int) -> World:
    """Move a wall that a controller of the force follows."""
    motion = _FOLLOWED[index % len(_FOLLOWED)]
    parameters, x_e = drawn_location(draw, (AS_TOLD, WITHIN)[index // len(_FOLLOWED) % 2])
    wall = drawn_wall(draw, spread(index), x_e)
    depth = min(_PRESS / wall.stiffness, 0.03)
    pieces, seconds = presses(draw, depth, contacts=1, hold_s=10.0, excited=False)
    distance = log_uniform(draw, _NEAREST, _FARTHEST) * (-1.0 if motion == 'toward' else 1.0)
    back = motion == 'to and fro'
    lasts = _FOLLOW_S / (1.0 + back)
    # The fastest of a quintic is 1.9 times its mean; the force must not fall to half.
    lag = min(_LAG_S, 0.25 * depth * lasts / abs(distance))
    moves = [(2.5, distance), (2.5 + lasts, -distance)][:1 + back]

    def shift(t: Array) -> Array:
        return path_at([ramp(begin, lasts, by) for begin, by in moves], t)

    pieces.append(lambda t: shift(t - lag))
    return simulate(motion, parameters, pieces, seconds, wall._replace(shift=shift),
                    drawn_sensor(draw), draw)


# -- matrices ---------------------------------------------------------------------------------

FRICTIONS = (0.0, 0.1, 0.3, 0.8)
_RATE = 500.0  # of the samples [Hz]
_APPROACH_S, _HOLD_S, _MATRIX_GAP = 0.5, 6.0, 5e-3  # [s], [s], [m]
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
    x[:, 0] += ramp(0.0, _APPROACH_S, _MATRIX_GAP + depth)(t)[0] - _MATRIX_GAP
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


ROWS = {
    'laws': Row('3 s after the touch of walls of other laws', 84, 28, _laws, _score_laws),
    'steps': Row('stiffness that changes in contact', 40, 10, _steps, _score_steps),
    'followed': Row('wall that moves, followed at a constant force', 24, 6, _followed, score),
    'drift': Row('stiffness that grows by half in 10 s', 12, 4, _drift, score),
    'matrix': Row('full matrices after 6 s of motion', 240, 24, make_world, score_of, estimate_of),
}
"""By name."""
