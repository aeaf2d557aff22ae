# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The laws of all effects, written out by hand: F_e of a given motion."""

from typing import Any, Callable

import numpy as np
from numpy.typing import NDArray
from scipy.signal import fftconvolve
from scipy.special import gamma
from world_reference import B_e, K_e

Array = NDArray[np.float64]
Formula = Callable[..., Array]


def cut(d: Array, resistance: Array, most: float = 0.0) -> Array:
    """In contact min(most, -resistance), else 0."""
    return np.where(d > 0.0, np.minimum(most, -resistance), 0.0)


def between_stops(x: Array, v: Array, gap: float, centre: float, beside: float) -> Array:
    """Free play resists by two stops, each of which only pushes, and a damper beside them."""
    far, near = x - (centre + gap / 2), x - (centre - gap / 2)
    behind = (1.0 - beside) * B_e * v
    pushed = np.where(far > 0.0, np.maximum(K_e * far + behind, 0.0), 0.0)
    drawn = np.where(near < 0.0, np.minimum(K_e * near + behind, 0.0), 0.0)
    return np.asarray(beside * B_e * v + pushed + drawn)


def followed(step: Callable[[float, int], float], count: int) -> Array:
    """Take small steps of an internal state from 0."""
    state, states = 0.0, []
    for k in range(count):
        state = step(state, k)
        states.append(state)
    return np.array(states)


def relaxation(t: Array, x: Array, v: Array, a: Array, K_1: float, tau: float) -> Array:
    """Integrate s' = K_1 v - s / tau in contact, s' = -s / tau outside."""
    h = t[1] - t[0]

    def step(s: float, k: int) -> float:
        return float(s + h * ((K_1 * v[k] if x[k] > 0.0 else 0.0) - s / tau))

    return cut(x, K_e * x + B_e * v + followed(step, len(t)))


def hysteresis(
    t: Array, x: Array, v: Array, a: Array, alpha: float, beta: float, asymmetry: float
) -> Array:
    """Integrate z' = v - beta |v| z - gamma v |z|; z = 0 out of contact."""
    h = t[1] - t[0]

    def step(z: float, k: int) -> float:
        rate = v[k] - beta * abs(v[k]) * z - asymmetry * v[k] * abs(z)
        return float(z + h * rate) if x[k] > 0.0 else 0.0

    return cut(x, K_e * x + B_e * v + alpha * followed(step, len(t)))


def resonance(
    t: Array, x: Array, v: Array, a: Array, mass: float, frequency: float, ratio: float
) -> Array:
    """Take small steps of the mass; out of contact its surface is at rest."""
    h, omega = t[1] - t[0], 2.0 * np.pi * frequency
    y, w, pull = max(float(x[0]), 0.0), 0.0, np.zeros(len(t))
    for k, (d, rate) in enumerate(zip(x.tolist(), v.tolist())):
        d, rate = (d, rate) if d > 0.0 else (0.0, 0.0)
        pull[k] = omega**2 * (d - y) + 2.0 * ratio * omega * (rate - w)
        w += h * pull[k]
        y += h * w
    return cut(x, K_e * x + B_e * v + mass * pull)


def dahl(t: Array, x: Array, v: Array, a: Array, F_c: float, sigma: float) -> Array:
    """Integrate dz = sigma (dd - z / F_c abs(dd)) over d = x > 0; z = 0 out of contact."""
    moves = np.diff(np.maximum(x, 0.0), prepend=max(float(x[0]), 0.0))

    def step(z: float, k: int) -> float:
        return float(z + sigma * (moves[k] - abs(moves[k]) * z / F_c)) if x[k] > 0.0 else 0.0

    return cut(x, K_e * x + B_e * v + followed(step, len(t)))


def springpot(t: Array, x: Array, v: Array, a: Array, C: float, alpha: float) -> Array:
    """Differentiate the penetration by the L1 scheme for Caputo's derivative, by convolution."""
    k = np.arange(len(t) + 1.0) ** (1.0 - alpha)
    moves = np.diff(np.maximum(x, 0.0), prepend=max(float(x[0]), 0.0))
    rate = fftconvolve(np.diff(k), moves)[:len(t)] / (t[1] - t[0]) ** alpha / gamma(2.0 - alpha)
    return cut(x, K_e * x + B_e * v + C * rate)


def sticking(t: Array, x: Array, v: Array, a: Array, F_a: float) -> Array:
    """Pull up to F_a in contact; then F_a (1 + d / 1.5 mm) while withdrawing."""
    def step(stuck: float, k: int) -> float:
        return 1.0 if x[k] > 0.0 else (0.0 if x[k] <= -0.0015 else stuck)

    neck = (followed(step, len(t)) > 0.0) & (x <= 0.0) & (v < 0.0)
    return cut(x, K_e * x + B_e * v, F_a) + np.where(neck, F_a * (1.0 + x / 0.0015), 0.0)


def attracting(t: Array, x: Array, v: Array, a: Array, F_a: float, reach: float) -> Array:
    """Pull by F_a in contact; then F_a (1 + d / reach) while withdrawing."""
    def step(stuck: float, k: int) -> float:
        return 1.0 if x[k] > 0.0 else (0.0 if x[k] <= -reach else stuck)

    neck = (followed(step, len(t)) > 0.0) & (x <= 0.0) & (v < 0.0)
    return cut(x, K_e * x + B_e * v - F_a, F_a) + np.where(neck, F_a * (1.0 + x / reach), 0.0)


def play(t: Array, x: Array, v: Array, a: Array, gap: float) -> Array:
    """Take the force of y and its rate where abs(x - y) = gap / 2; y(0) = x(0)."""
    y = followed(lambda y, k: float(min(max(y, x[k] - gap / 2), x[k] + gap / 2)) if k else x[0],
                 len(t))
    touches = np.abs(x - y) > (0.5 - 1e-6) * gap
    return np.where(touches, cut(y, K_e * y + B_e * v), 0.0)


def dent(t: Array, x: Array, v: Array, a: Array, residual: float, yield_depth: float) -> Array:
    """Move the surface by the residual share of the greatest depth so far, beyond yield."""
    d = x - residual * np.maximum(np.maximum.accumulate(x) - yield_depth, 0.0)
    return cut(d, K_e * d + B_e * v)


def flowing(t: Array, x: Array, v: Array, a: Array, rate: float) -> Array:
    """Let the surface recede at a rate proportional to the depth beneath it (Euler)."""
    u = np.zeros(len(x))
    for k in range(len(x) - 1):
        u[k + 1] = u[k] + rate * max(x[k] - u[k], 0.0) * (t[k + 1] - t[k])
    return cut(x - u, K_e * (x - u) + B_e * (v - rate * (x - u)))


def recovering(t: Array, x: Array, v: Array, a: Array, ratio: float) -> Array:
    """Unload along a steeper line from the greatest depth of each contact."""
    greatest, left = 0.0, np.empty(len(x))
    for k, d in enumerate(x):
        greatest = max(greatest, d) if d > 0.0 else 0.0
        left[k] = max(0.0, greatest - (1.0 + ratio) * (greatest - d)) if d > 0.0 else d
    return cut(left, K_e * left + B_e * v)


def struck(t: Array, x: Array, v: Array, a: Array, chi: float) -> Array:
    """Damp with the depth and inversely to the speed of the last touch-down."""
    speed, speeds = 0.0, np.empty(len(x))
    for k, d in enumerate(x):
        speed = (speed or abs(v[k])) if d > 0.0 else 0.0
        speeds[k] = speed or 1.0
    return cut(x, K_e * x + B_e * v + chi * x * v / speeds)


def sliding(speed: Any, F_c: float, F_s: float, v_s: float) -> Any:
    """Friction that falls from F_s to F_c."""
    return (F_c + (F_s - F_c) * np.exp(-speed**2 / v_s**2)) * np.tanh(speed / 4e-4)


def swinging(t: Array, x: Array, v: Array, a: Array, *tones: float) -> Array:
    """Move the surface as a sum of sines of amplitude, frequency and phase each."""
    d, rate = x, v
    for amplitude, frequency, phase in np.reshape(tones, (-1, 3)):
        w = 2.0 * np.pi * frequency
        d = d - amplitude * np.sin(w * t + phase)
        rate = rate - amplitude * w * np.cos(w * t + phase)
    return cut(d, K_e * d + B_e * rate)


FORMULAS: dict[str, Formula] = {
    'coulomb_friction': lambda t, x, v, a, F_c: cut(
        x, K_e * x + B_e * v + F_c * np.tanh(v / 4e-4)),
    'stribeck_friction': lambda t, x, v, a, *p: cut(x, K_e * x + B_e * v + sliding(v, *p)),
    'presliding_friction': dahl,
    'environment_resonance': resonance,
    'environment_inertia': lambda t, x, v, a, M_e: cut(x, K_e * x + B_e * v + M_e * a),
    'cubic_stiffness': lambda t, x, v, a, K_3: cut(x, K_e * x + B_e * v + K_3 * x**3),
    'power_law_stiffness': lambda t, x, v, a, n, K_n: cut(
        x, K_n * np.maximum(x, 0.0) ** n + B_e * v),
    'polynomial_stiffness': lambda t, x, v, a, K_2, K_3: cut(
        x, K_e * x + B_e * v + K_2 * x**2 + K_3 * x**3),
    'exponential_stiffness': lambda t, x, v, a, A, depth: cut(
        x, K_e * x + B_e * v + A * (np.exp(x / depth) - 1.0 - x / depth)),
    'hunt_crossley_damping': lambda t, x, v, a, chi: cut(x, K_e * x + chi * x * v),
    'power_law_damping': lambda t, x, v, a, B_m, m: cut(
        x, K_e * x + B_m * np.abs(x) ** m * v),
    'asymmetric_damping': lambda t, x, v, a, B_a: cut(
        x, K_e * x + np.where(v > 0.0, B_e + B_a, B_e - B_a) * v),
    'quadratic_damping': lambda t, x, v, a, B_2: cut(
        x, K_e * x + B_e * v + B_2 * np.sign(v) * v**2),
    'viscoelastic_relaxation': relaxation,
    'fractional_relaxation': springpot,
    'bouc_wen_hysteresis': hysteresis,
    'contact_offset': lambda t, x, v, a, offset: cut(
        x - offset, K_e * (x - offset) + B_e * v),
    'moving_environment': swinging,
    'beating_environment': swinging,
    'adhesion': sticking,
    'dmt_adhesion': attracting,
    'dead_zone': lambda t, x, v, a, gap: cut(x, K_e * np.maximum(x - gap, 0.0) + B_e * v),
    'free_play': lambda t, x, v, a, *p: cut(x, between_stops(x, v, *p)),
    'backlash': play,
    'bilinear_stiffness': lambda t, x, v, a, K_2, depth: cut(
        x, K_e * x + B_e * v + K_2 * np.maximum(x - depth, 0.0)),
    'stiffness_drift': lambda t, x, v, a, rate: cut(x, K_e * (1.0 + rate * t) * x + B_e * v),
    'plastic_set': dent,
    'cogging': lambda t, x, v, a, amplitude, period, phase: cut(
        x, K_e * x + B_e * v + amplitude * np.sin(2.0 * np.pi * x / period + phase)),
    'viscous_flow': flowing,
    'tool_weight': lambda t, x, v, a, W: cut(x, K_e * x + B_e * v) + W,
    'unloading_hysteresis': recovering,
    'impact_damping': struck,
}
"""Of the contact: (t, x, v, a, parameters) -> F_e, for a wall at 0 with K_e and B_e."""

SENSED: dict[str, Any] = {
    'tool_inertia': lambda t, F, a, mass: F - mass * a,
    'force_gain': lambda t, F, a, gain: gain * F,
    'force_nonlinearity': lambda t, F, a, bend, gain: gain * F + bend * F**2 * np.sign(F),
    'force_bias': lambda t, F, a, bias: F + bias,
    'force_drift': lambda t, F, a, rate: F + rate * t,
    'settling_bias': lambda t, F, a, change, tau, bias: F + bias + change * np.exp(-t / tau),
    'force_saturation': lambda t, F, a, limit: np.minimum(limit, np.maximum(-limit, F)),
    'force_delay': lambda t, F, a, delay: np.interp(t - delay, t, F),
    'force_creep': lambda t, F, a, share, tau: F + share * SENSED['force_lag'](t, F, a, tau),
    'force_decay': lambda t, F, a, share, tau: F - share * SENSED['force_lag'](t, F, a, tau),
    'force_lag': lambda t, F, a, tau: F[0] + followed(
        lambda y, k: y + (t[1] - t[0]) / tau * (F[k] - F[0] - y), len(t)),
}
"""Of the sensor: (t, F_e, a, parameters) -> measured."""
