# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""From the samples of one axis to what a wall can have caused: bias, known physics, outliers."""

from collections import deque
from dataclasses import dataclass
from math import exp, nan, sqrt

import numpy as np
from numpy.typing import NDArray

from .contact_sample import CompensatedSample, ContactSample, SampleCompensation
from ..parameters import parameter, ParameterGroup

DRIFT_STD = 1.0
"""Of the drift before any free flight [standard deviations of the noise per s]."""
DRIFT_WALK = 0.02
"""Random walk of the drift [noise / s per sqrt(s)]: at 500 Hz it is averaged over 1.5 s, which is
(period / walk^2)^(1/4)."""
_CLIP = 3.0  # standard deviations of an innovation, beyond which it is an outlier or a touch


class ZeroTracker:
    """
    Kalman filter of zero z and drift d of a force: z' = d, d' white noise.

    zero, drift: z [N] and d [N/s]
    """

    def __init__(self) -> None:
        self.zero = self.drift = 0.0
        self._P = 0.0, 0.0, DRIFT_STD * DRIFT_STD  # in variances of the noise

    @property
    def zero_std(self) -> float:
        """Return the standard deviation of the zero in those of the noise."""
        return sqrt(self._P[0])

    def step(self, size: float, variance: float) -> None:
        """Move the zero by what is known to have changed [N], with a variance [noise^2]."""
        zz, zd, dd = self._P
        self.zero += size
        self._P = zz + variance, zd, dd

    def predict(self, dt: float) -> None:
        """Extrapolate by a time step [s]."""
        zz, zd, dd = self._P
        self.zero += self.drift * dt
        self._P = zz + dt * (2.0 * zd + dt * dd), zd + dt * dd, dd + DRIFT_WALK * DRIFT_WALK * dt

    def correct(self, force: float, noise_std: float) -> None:
        """Use a force of free flight less the zero, and the deviation of its noise [N]."""
        zz, zd, dd = self._P
        most = _CLIP * noise_std * sqrt(1.0 + zz)
        force = min(max(force, -most), most)
        of_zero, of_drift = zz / (1.0 + zz), zd / (1.0 + zz)
        self.zero += of_zero * force
        self.drift += of_drift * force
        self._P = zz - of_zero * zz, zd - of_zero * zd, dd - of_drift * zd


@dataclass(frozen=True)
class ContactParameters(ParameterGroup):
    """What noise to expect, and where an arm touches the wall."""

    force_noise: float = parameter(
        0.6,
        'Standard deviation of the force noise to expect; it is then estimated from the force',
        'N',
        minimum=1e-9,
        maximum=1e6,
    )
    position_noise: float = parameter(
        1e-6, 'Standard deviation of the position noise', 'm', minimum=0.0
    )
    minimum_force: float = parameter(
        0.0, 'Contact begins above this force whatever the noise', 'N', minimum=0.0
    )
    normal: tuple[float, ...] = parameter(
        (0.0, 0.0, 0.0), 'Direction into the wall, of any length; for an arm (kinematics.tip)',
        read_only=True,
    )
    normal_frame: str = parameter(
        'base', 'Frame of the normal: kinematics.base, or kinematics.tip as it is oriented at '
        'touch-down', choices=('base', 'tip'), read_only=True,
    )
    point: tuple[float, ...] = parameter(
        (0.0, 0.0, 0.0), 'Point of the tip that touches the wall, in the frame of kinematics.tip',
        'm', read_only=True,
    )


_MEMORY = 0.9  # of the line per sample
_STIFFEST = 1e6  # standard deviation of the slope of a new line [N/m]
_BEND = 0.2  # of the force, by which damping may bend the line at a reversal
_SUPPORT = 10  # samples in agreement, below which the line may be wrong: touch-down bends it
_SCALE_RATE = 0.05  # of the logarithm of the noise per sample
_JUMP = sqrt(6.0)  # noise of a second difference
_WITHIN = 0.683  # share of Gaussian noise within one standard deviation
_LARGER, _SMALLER = exp(_SCALE_RATE * _WITHIN), exp(_SCALE_RATE * (_WITHIN - 1.0))


class OutlierGate:
    """
    Replaces forces that are far from the line of the last samples by the line.

    A force is an outlier where it also jumps away from its course in time: where a tool with a
    fast touch turns around, damping leaves the line of force against depth within a few samples.

    The line of force against depth is fitted to the last ten samples or so by recursive least
    squares, so that it holds for any smooth law and wherever the surface is. The noise is a
    quantile of its errors, on which outliers have no leverage. The way out: after a number of
    outliers in a row on the same side, the line starts afresh from the last of them.
    """

    def __init__(self, threshold: float, samples: int) -> None:
        self.count = 0
        self._scale = 0.0
        self._forget()
        self.configure(threshold, samples)

    def configure(self, threshold: float, samples: int) -> None:
        """Set other thresholds; see the constructor."""
        self._threshold, self._samples = threshold, samples
        self.leave()

    def leave(self) -> None:
        """Forget the line, as out of contact; the noise stays."""
        if self._line is not None:
            self._forget()

    def _forget(self) -> None:
        # Depth, force there, slope; covariance of force and slope, times the noise variance.
        self._line: tuple[float, float, float, float, float, float] | None = None
        self._course = 0.0, 0.0  # the last two forces, outliers replaced
        self._run = 0  # outliers in a row, negative below the line
        self._support = 0  # samples that agree with the line

    def replace(self, d: float, y: float, noise_std: float) -> float:
        """
        Replace the force of the next sample in contact where it is an outlier.

        d: penetration [m]
        y: pressing force [N]
        noise_std: standard deviation of the force noise, > 0 [N]
        Returns replaced: the line instead of an outlier [N]
        """
        line = self._line
        if line is None:
            if self._threshold:
                self._start(d, y, noise_std)
            return y
        depth, level, slope, cc, ck, kk = line
        x = d - depth
        cc, ck = cc + x * (2.0 * ck + x * kk), ck + x * kk  # at this depth
        predicted = level + slope * x
        error = y - predicted
        size, scale = abs(error), self._scale
        if scale < noise_std:
            scale = noise_std
        width = scale * sqrt(1.0 + cc)
        self._scale = scale * (_LARGER if size > width else _SMALLER)
        bound = self._threshold * width
        last, before = self._course
        if (size > bound and size > bound + _BEND * max(abs(predicted), abs(level))
                and abs(y - 2.0 * last + before) > self._threshold * scale * _JUMP):
            if self._support < _SUPPORT or self._believes(error):
                self._start(d, y, noise_std)
                return y
            self.count += 1
            self._course = predicted, last
            return predicted
        self._run = 0
        self._course = y, last
        self._support += 1
        # Least squares with forgetting; without motion the slope would wind up.
        s = _MEMORY + cc
        gain, gain_k, kk = cc / s, ck / s, (kk - ck * ck / s) / _MEMORY
        widest, ck = _STIFFEST / scale, gain_k
        widest *= widest
        if kk > widest:
            ck, kk = ck * sqrt(widest / kk), widest
        self._line = d, predicted + gain * error, slope + gain_k * error, gain, ck, kk
        return y

    def _believes(self, error: float) -> bool:
        """Count an outlier; return whether so many on one side are a change."""
        side = 1 if error > 0.0 else -1
        self._run = self._run + side if self._run * side > 0 else side
        return abs(self._run) >= self._samples

    def _start(self, d: float, y: float, noise_std: float) -> None:
        self._line = d, y, 0.0, 1.0, 0.0, (_STIFFEST / max(self._scale, noise_std)) ** 2
        self._course = y, y
        self._run = self._support = 0


Array = NDArray[np.float64]
_TARE_S = 0.5


@dataclass(frozen=True)
class ConditioningParameters(ParameterGroup):
    """The low-pass filter of regressor and force, and the outliers before it."""

    cutoff_frequency: float = parameter(
        50.0, 'Cut-off of the second-order Butterworth filter of the rows of the estimators of '
        'the paper; 0: no filter', 'Hz', minimum=0.0
    )
    outlier_threshold: float = parameter(
        6.0,
        'Forces in contact further from the line of the last samples than this many standard '
        'deviations are outliers and replaced by it; 0: none is', minimum=0.0,
    )
    outlier_samples: int = parameter(
        5, 'So many consecutive outliers on the same side are a change and no outliers',
        minimum=2, maximum=1000,
    )


class Conditioner:
    """
    Time steps, bias of the force and known physics of one axis.

    sample_rate: nominal [Hz]
    bias: force that is subtracted from the measured F_e [N]
    tracks_zero: whether the bias follows the force of free flight
    tracker: of the change of the bias since the last tare; None without
    """

    def __init__(self, sample_rate: float, tracks_zero: bool = False) -> None:
        self.bias = 0.0
        self.tracker = ZeroTracker() if tracks_zero else None
        self.compensation: SampleCompensation | None = None
        self.configure(sample_rate)

    def configure(self, sample_rate: float) -> None:
        """Set the nominal rate [Hz]."""
        self._T = 1.0 / sample_rate
        self.restart()

    def restart(self) -> None:
        """Start afresh with the next sample, as after a clock jump."""
        self._last_ns, self._position = -1, nan
        self._free: deque[float] = deque(maxlen=max(2, round(_TARE_S / self._T)))

    @property
    def offset(self) -> float:
        """Return what is subtracted now: the bias and its change as tracked [N]."""
        return self.bias if self.tracker is None else self.bias - self.tracker.zero

    def take(
        self, sample: ContactSample, location: float
    ) -> tuple[float, float, CompensatedSample | None]:
        """
        Condition the next sample.

        location: x_e nominal [m]; NaN: not known yet
        Returns dt, pressing: time since the sample before [s], and -F_e less the bias [N]
        Returns known: what is left after known physics, None without any
        """
        stamp_ns, self._position, _, force = sample
        last_ns, self._last_ns = self._last_ns, stamp_ns
        dt = (stamp_ns - last_ns) * 1e-9 if last_ns >= 0 else 0.0
        if self.tracker is not None:
            self.tracker.predict(dt)
        pressing = self.offset - force
        if self.compensation is None:
            return dt, pressing, None
        return dt, pressing, self.compensation.take(sample, location, pressing)

    def take_many(self, stamps_ns: NDArray[np.int64], x: Array, force: Array) -> Array:
        """
        Condition consecutive samples where no physics is known.

        stamps_ns (N,): stamps [ns]
        x, force (N,): position [m] and F_e [N]
        Returns pressing (N,): -F_e less the bias [N]
        """
        self._last_ns, self._position = int(stamps_ns[-1]), float(x[-1])
        return self.bias - force

    # -- tare -------------------------------------------------------------------------------

    def note_free(self, *pressing: float) -> None:
        """Keep forces of free flight [N]."""
        self._free.extend(pressing)

    def note_contact(self) -> None:
        """Forget the free flight."""
        if self._free:
            self._free.clear()

    def tare(self) -> str:
        """Set the bias to the mean force of the last half second of free flight; say so."""
        self.set_bias(self.offset - sum(self._free) / len(self._free))
        return f'force bias is now {self.bias:.6g} N'

    def tare_refusal(self, contact: bool, location: float, margin: float) -> str:
        """
        Return why no tare is possible now, '' where it is.

        location, margin: x_e, NaN where it is not known, and how far from it the surface may be
        [m]
        """
        if contact:
            return 'in contact; move away from the wall and try again'
        inside_m = self._position - location
        if inside_m > -margin:
            return (f'x is {1e3 * inside_m:.3g} mm inside environment.location, where a force may '
                    'be that of the wall; move away from it, or correct the location')
        if len(self._free) < (self._free.maxlen or 0):
            return f'out of contact for less than {_TARE_S} s; wait and try again'
        return ''

    def set_bias(self, bias: float) -> None:
        """Set the force that is subtracted from the measured F_e [N]."""
        self.bias = bias
        self._free.clear()
        if self.tracker is not None:
            self.tracker = ZeroTracker()
