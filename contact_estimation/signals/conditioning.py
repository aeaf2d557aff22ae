# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""From the samples of one axis to what a wall can have caused: time, bias, known physics."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from math import nan

import numpy as np
from numpy.typing import NDArray

from .compensated_sample import CompensatedSample, SampleCompensation
from .contact_sample import ContactSample
from .zero_tracking import ZeroTracker
from ..parameters.specification import parameter, ParameterGroup

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

    Parameters
    ----------
    sample_rate : float
        Nominal [Hz].
    tracks_zero : bool
        Whether the bias follows the force of free flight.

    Attributes
    ----------
    bias : float
        Force that is subtracted from the measured F_e [N].
    tracker : ZeroTracker or None
        Of the change of the bias since the last tare.
    compensation : SampleCompensation or None
        Of the known physics.

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

        Parameters
        ----------
        sample : ContactSample
            Stamped after the last one.
        location : float
            x_e nominal [m]; NaN: not known yet.

        Returns
        -------
        dt, pressing : float, float
            Time since the sample before [s], and -F_e less the bias [N].
        known : CompensatedSample or None
            What is left after known physics, None without any.

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

        Parameters
        ----------
        stamps_ns : ndarray of int64, shape (N,)
            Stamps [ns].
        x, force : ndarray, shape (N,)
            Position [m] and F_e [N].

        Returns
        -------
        pressing : ndarray, shape (N,)
            -F_e less the bias [N].

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

        Parameters
        ----------
        contact : bool
            Whether there is one.
        location, margin : float
            x_e, NaN where it is not known, and how far from it the surface may be [m].

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
