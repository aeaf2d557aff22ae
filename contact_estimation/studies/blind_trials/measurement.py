# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Measurement of a simulated world: filter, noise, quantisation, jitter, dropped samples."""

from __future__ import annotations

from math import pi, sqrt
from typing import NamedTuple

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray
from scipy.signal import butter, lfilter

from .simulation import Run
from .worlds import SensorModel

Array = NDArray[np.float64]

TRUTH_HZ = 5000.0
"""Rate of the true signals that `measure` samples."""

INTEGRATION_HZ = 10000.0
"""Minimum integration rate of these signals."""


class StampedSignal(NamedTuple):
    """One recorded signal."""

    stamps: NDArray[np.int64]  # (N,) time since the first sample, increasing [ns]
    values: Array  # (N, ...) measured values


class Measurement(NamedTuple):
    """Recorded signals of a world."""

    force: StampedSignal  # F_e [N]
    joint: StampedSignal  # columns x [m] and its rate [m/s]
    reference: StampedSignal  # columns x_r, its rate and acceleration
    force_floor: float  # RMS of the force noise, rounding included [N]


def measure(run: Run, sensors: SensorModel, rng: Generator) -> Measurement:
    """Apply the sensor model to true signals."""
    period = 1.0 / sensors.rate
    # The delay of the filter reaches beyond the last sample: keep two periods clear.
    t: Array = period * np.arange(int((run.t[-1] - 2.0 * period) / period), dtype=float)
    force, clean = _force(run, t, sensors, rng)
    t_joint: Array = t + sensors.joint_phase * period
    x = np.interp(t_joint, run.t, run.x) + sensors.position_noise * rng.standard_normal(len(t))
    v = np.interp(t_joint, run.t, run.v)
    if sensors.velocity_noise is not None:
        v = v + sensors.velocity_noise * rng.standard_normal(len(t))
    motion = np.column_stack((_quantised(x, sensors.position_step), v))
    reference = np.column_stack([np.interp(t, run.t, r) for r in (run.x_r, run.v_r, run.a_r)])
    return Measurement(
        _stamped(t, force, sensors, rng), _stamped(t_joint, motion, sensors, rng),
        _stamped(t, reference, sensors, rng), float(np.sqrt(np.mean((force - clean) ** 2))),
    )


def _force(run: Run, t: Array, sensors: SensorModel, rng: Generator) -> tuple[Array, Array]:
    """Return the measured force and the same without noise and quantisation."""
    sensed, delay = run.sensed, 0.0
    if sensors.low_pass:
        b, a = butter(2, sensors.low_pass, fs=1.0 / float(run.t[1] - run.t[0]))
        sensed = lfilter(b, a, sensed - sensed[0]) + sensed[0]
        delay = sqrt(2.0) / (2.0 * pi * sensors.low_pass)  # group delay at low frequency
    clean = np.interp(t + delay, run.t, sensed)
    noise = rng.standard_normal(len(t))
    if sensors.distribution == 'uniform':
        noise = rng.uniform(-sqrt(3.0), sqrt(3.0), len(t))
    return _quantised(clean + sensors.force_noise * noise, sensors.force_step), clean


def _quantised(values: Array, step: float) -> Array:
    return np.asarray(np.round(values / step) * step) if step else values


def _stamped(t: Array, values: Array, sensors: SensorModel, rng: Generator) -> StampedSignal:
    """Add jitter and drop samples, but never the first and the last."""
    jitter = np.clip(sensors.jitter * rng.standard_normal(len(t)), -0.4 / sensors.rate,
                     0.4 / sensors.rate)
    jitter[0] = 0.0
    kept = rng.uniform(size=len(t)) >= sensors.dropped
    kept[[0, -1]] = True
    stamps = np.round(1e9 * (t + jitter)).astype(np.int64)
    return StampedSignal(stamps[kept], values[kept])
