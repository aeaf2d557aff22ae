# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Contacts with sensors as they are in a laboratory: nothing is wrong with them."""

from __future__ import annotations

from typing import NamedTuple

from contact_estimation.signals.contact_sample import ContactSample
import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

Array = NDArray[np.float64]
RATE = 500.0
CONTACTS = 2


class World(NamedTuple):
    """A wall, what touches it, and the sensors."""

    K_e: float
    B_e: float
    samples: list[ContactSample]


def healthy_world(seed: int, velocity_noise: float = 0.0, lag_s: float = 0.0) -> World:
    """Press twice on a random wall at x = 0; the force comes late by a lag, its filter apart."""
    draw = np.random.default_rng(seed)
    K_e = float(np.exp(draw.uniform(np.log(300.0), np.log(3e4))))
    B_e = K_e * float(np.exp(draw.uniform(np.log(4e-3), np.log(0.06))))
    fine = 8  # steps a sample
    t = np.arange(CONTACTS * 3.5 * RATE * fine) / (RATE * fine)
    x = _motion(t, min(15.0 / K_e, 0.03), draw)
    v = np.gradient(x, t)
    force = -np.where(x > 0.0, np.maximum(K_e * x + B_e * v, 0.0), 0.0)
    filter_s = draw.uniform(2e-4, 1.5e-3)
    share = 1.0 - np.exp(-1.0 / (RATE * fine * filter_s))
    force = lfilter([share], [1.0, share - 1.0], force)
    force = np.interp(t - lag_s, t, force)
    t, x, v, force = (one[::fine] for one in (t, x, v, force))
    count, step = len(t), draw.choice([0.0, 1e-6, 1e-5])
    x = x + np.exp(draw.uniform(np.log(1e-6), np.log(2e-5))) * draw.standard_normal(count)
    x = step * np.round(x / step) if step else x
    v = v + velocity_noise * draw.standard_normal(count)
    force = force + np.exp(draw.uniform(np.log(0.1), 0.0)) * draw.standard_normal(count)
    stamps = np.round(t * 1e9).astype(np.int64) + 10**9
    return World(K_e, B_e, list(map(ContactSample, stamps.tolist(), x.tolist(), v.tolist(),
                                    force.tolist())))


def _motion(t: Array, depth: float, draw: np.random.Generator) -> Array:
    """Approach, press, move in the wall or hold still, and withdraw; again and again."""
    phase = t % 3.5
    touch = draw.uniform(0.05, 0.4)  # s of the way to the wall
    ramp = _smooth((phase - 0.5) / (2.0 * touch)) - _smooth((phase - 3.0) / 0.3)
    moving = _smooth((phase - 0.5 - 2.0 * touch) / 0.1) - _smooth((phase - 2.8) / 0.1)
    tones = draw.uniform(1.0, 12.0, int(draw.integers(0, 4)))  # none: press and hold
    wave = sum((np.sin(2.0 * np.pi * f * phase) for f in tones), np.zeros(len(t)))
    wave = wave * draw.uniform(0.1, 0.4) * depth / max(len(tones), 1)
    return np.asarray((ramp - 1.0) * 0.01 + ramp * depth + moving * wave)


def _smooth(s: Array) -> Array:
    """Rise from 0 to 1 with continuous acceleration."""
    s = np.clip(s, 0.0, 1.0)
    return np.asarray(s**3 * (10.0 - 15.0 * s + 6.0 * s**2))
