# Copyright 2026 contact_estimation authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""From the world to stamped readings: filters, noise, rounding, jitter, losses."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray
from scipy.signal import butter, lfilter

from .setups import Sensing
from .simulation import Run

Array = NDArray[np.float64]

NOTED_HZ = 5000.0
"""Rate at which the world is noted down before the sensors look at it."""

INTEGRATED_HZ = 10000.0
"""Least rate at which it is integrated then."""

_SQRT_2 = 2.0**0.5


class Readings(NamedTuple):
    """
    One signal of a recording.

    Attributes
    ----------
    stamps : ndarray of int, shape (N,)
        From the first sample on [ns], rising.
    values : ndarray, shape (N, ...)
        What was read.

    """

    stamps: NDArray[np.int64]
    values: Array


class Recorded(NamedTuple):
    """
    What the recording holds, and what its noise was.

    Attributes
    ----------
    force : Readings
        F_e [N].
    joint : Readings
        Columns x [m] and its rate [m/s].
    reference : Readings
        Columns x_r, its rate and acceleration.
    force_floor : float
        Root mean square of what the sensor added to the force [N].

    """

    force: Readings
    joint: Readings
    reference: Readings
    force_floor: float


def record(run: Run, sensing: Sensing, rng: Generator) -> Recorded:
    """
    Measure a world.

    Parameters
    ----------
    run : Run
        Noted down at NOTED_HZ.
    sensing : Sensing
        The sensors.
    rng : numpy.random.Generator
        Source of chance.

    Returns
    -------
    recorded : Recorded
        Three signals, each with stamps and losses of its own.

    """
    period = 1.0 / sensing.rate
    # The filter looks back for up to its delay beyond the last sample.
    t: Array = period * np.arange(int((run.t[-1] - 2.0 * period) / period), dtype=float)
    force, clean = _force(run, t, sensing, rng)
    late: Array = t + sensing.joint_phase * period
    x = np.interp(late, run.t, run.x) + sensing.position_noise * rng.standard_normal(len(t))
    v = np.interp(late, run.t, run.v)
    if sensing.velocity_noise is not None:
        v = v + sensing.velocity_noise * rng.standard_normal(len(t))
    motion = np.column_stack((_round(x, sensing.position_step), v))
    wanted = np.column_stack([np.interp(t, run.t, r) for r in (run.x_r, run.v_r, run.a_r)])
    return Recorded(
        _stamped(t, force, sensing, rng), _stamped(late, motion, sensing, rng),
        _stamped(t, wanted, sensing, rng), float(np.sqrt(np.mean((force - clean) ** 2))),
    )


def _force(run: Run, t: Array, sensing: Sensing, rng: Generator) -> tuple[Array, Array]:
    """Give the reading, and what it would be without noise and rounding."""
    sensed, delay = run.sensed, 0.0
    if sensing.low_pass:
        b, a = butter(2, sensing.low_pass, fs=NOTED_HZ)
        sensed = lfilter(b, a, sensed - sensed[0]) + sensed[0]
        delay = _SQRT_2 / (2.0 * np.pi * sensing.low_pass)  # of slow signals, taken off the stamp
    clean = np.interp(t + delay, run.t, sensed)
    noise = rng.standard_normal(len(t))
    if sensing.distribution == 'uniform':
        noise = rng.uniform(-(3.0**0.5), 3.0**0.5, len(t))
    return _round(clean + sensing.force_noise * noise, sensing.force_step), clean


def _round(values: Array, step: float) -> Array:
    return np.asarray(np.round(values / step) * step) if step else values


def _stamped(t: Array, values: Array, sensing: Sensing, rng: Generator) -> Readings:
    """Stamp with jitter and lose some; the first and the last always arrive."""
    jitter = np.clip(sensing.jitter * rng.standard_normal(len(t)), -0.4 / sensing.rate,
                     0.4 / sensing.rate)
    jitter[0] = 0.0
    there = rng.uniform(size=len(t)) >= sensing.dropped
    there[[0, -1]] = True
    stamps = np.round(1e9 * (t + jitter)).astype(np.int64)
    return Readings(stamps[there], values[there])
