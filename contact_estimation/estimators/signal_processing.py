# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The signal processing method of the paper, eqs. (8) to (18), exactly as published."""

from math import nan, pi, sqrt

import numpy as np
from numpy.typing import NDArray

from .offline_estimator import OfflineEstimate, OfflineEstimator, TargetImpedance
from ..exceptions import EstimationError
from ..signals.contact_sample import ContactRecording

FFT_POINTS = 1024
"""The printed 2.930 Hz is bin 6 of 1024 points at 500 Hz; the true frequency is 2.76 Hz."""

SETTLED = 0.05
"""Share of the steady state within which the response counts as settled, eq. (8)."""


class SignalProcessing(OfflineEstimator):
    """
    Frequency from a bin of the FFT, damping from the cycles until the force has settled.

    Needs the force alone, of a step response that is under-damped.
    """

    name = 'signal_processing'

    def __init__(self, target: TargetImpedance) -> None:
        self._target = target

    def estimate(self, recording: ContactRecording) -> OfflineEstimate:
        """Apply eqs. (8) to (18); see `OfflineEstimator.estimate`."""
        t, force = step_response(recording)
        w_d = dominant_frequency(t, force)
        cycles = settling_time(t, force) * w_d / (2.0 * pi)
        zeta = damping_ratio(cycles)
        w_n = w_d / sqrt(1.0 - zeta**2)  # eq. (15)
        K_e, B_e = environment_of(w_n, zeta, self._target)
        return OfflineEstimate(K_e, B_e, nan, nan)


def environment_of(w_n: float, zeta: float, target: TargetImpedance) -> tuple[float, float]:
    """
    Subtract the impedance of the robot from that of robot and wall, eqs. (17) and (18).

    w_n: undamped natural frequency [rad/s]
    Returns K_e, B_e: of the environment [N/m], [N s/m]
    """
    K_e = w_n**2 * target.mass - target.stiffness
    B_e = 2.0 * zeta * sqrt((target.stiffness + K_e) * target.mass) - target.damping
    return K_e, B_e


def damping_ratio(cycles: float) -> float:
    """Return the damping ratio for a number of cycles to settle, eq. (11)."""
    turns = 2.996 / (2.0 * pi)  # -ln(0.05) / 2 pi
    return turns / sqrt(cycles**2 + turns**2)


def step_response(recording: ContactRecording) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """
    Return the step response in a recording, from the onset of the force on.

    Returns t (N,): time since the step [s]
    Returns force (N,): pressing force [N]
    """
    force = -recording.force
    noise = float(np.std(np.diff(force[: max(10, len(force) // 50)]))) / sqrt(2.0)
    above = np.flatnonzero(force > 6.0 * noise + 0.1 * float(np.max(force, initial=0.0)))
    begin = max(0, int(above[0]) - 1) if len(above) else len(force)
    if len(force) - begin < FFT_POINTS:
        raise EstimationError(
            f'signal processing needs {FFT_POINTS} samples after a step of the force, got '
            f'{len(force) - begin}; record longer, or check the sign of the force')
    return recording.t[begin:] - recording.t[begin], force[begin:]


def dominant_frequency(t: NDArray[np.float64], force: NDArray[np.float64]) -> float:
    """
    Return the frequency of the strongest FFT bin: mean removed, no window, no padding.

    t, force (N,): time [s] and force [N], N >= FFT_POINTS
    Returns w_d: damped natural frequency [rad/s], a multiple of the bin width
    """
    part = force[:FFT_POINTS]
    magnitude = np.abs(np.fft.rfft(part - np.mean(part)))
    period = float(t[FFT_POINTS - 1] - t[0]) / (FFT_POINTS - 1)
    return 2.0 * pi * int(np.argmax(magnitude)) / (FFT_POINTS * period)


def settling_time(t: NDArray[np.float64], force: NDArray[np.float64]) -> float:
    """
    Return the last instant outside 5 % of the steady state, eq. (8).

    t, force (N,): time [s] and force [N]; the last half is the steady state
    Returns T_s: settling time [s]
    """
    steady = float(np.mean(force[len(force) // 2:]))
    outside = np.flatnonzero(np.abs(force - steady) > SETTLED * abs(steady))
    return float(t[outside[-1]]) if len(outside) else 0.0
