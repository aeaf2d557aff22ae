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

"""
From the samples of one axis to the rows that an estimator fits.

Gate first, then filter: with c the contact flag, c F = K_e c delta + B_e c v holds at all times,
so [c delta, c v, c] and c F pass the same filter. Filtering first would smear the touch-down into
the estimate.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from math import nan

from .butterworth import ButterworthBank
from .compensated_sample import SampleCompensation
from .contact_detection import ContactDetector, ContactParameters
from .contact_sample import ContactSample
from .outlier_gate import OutlierGate
from .relations import GatedRows, NO_GAIN, NoiseGain, Relation, Row
from ..parameters.specification import parameter, ParameterGroup

_TARE_S = 0.5
_PERIOD_GAIN = 0.01  # of the mean sample period


@dataclass(frozen=True)
class ConditioningParameters(ParameterGroup):
    """The low-pass filter of regressor and force, and the outliers before it."""

    cutoff_frequency: float = parameter(
        50.0, 'Cut-off of the second-order Butterworth filter; 0: no filter', 'Hz', minimum=0.0
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
    Velocity, compensation, contact detection, outliers, relation, gate and filter, in this order.

    Causal.

    Parameters
    ----------
    contact : ContactParameters
        Thresholds of contact.
    parameters : ConditioningParameters
        The filter.
    sample_rate : float
        Nominal [Hz].
    relation : type of Relation
        What the estimator fits.

    Attributes
    ----------
    location, location_margin : float
        x_e [m], and how far outside it contact is possible [m].
    compensation : SampleCompensation or None
        Of the known physics.
    pressing : float
        -F_e of the last sample without bias and what the sensor adds [N].
    hindrance : str
        Why known physics allow no row of the last sample; '' where they do.

    """

    def __init__(
        self, contact: ContactParameters, parameters: ConditioningParameters, sample_rate: float,
        relation: type[Relation],
    ) -> None:
        self.detector = ContactDetector(contact)
        self.bias = self.location = self.location_margin = self.sample_period_s = 0.0
        self.compensation: SampleCompensation | None = None
        self.missing, self.pressing, self.hindrance = 0, 0.0, ''
        self.gate = OutlierGate(parameters.outlier_threshold, parameters.outlier_samples)
        self.configure(parameters, sample_rate, relation)

    def configure(
        self, parameters: ConditioningParameters, sample_rate: float, relation: type[Relation]
    ) -> None:
        """
        Build new filters and a new relation; contact, noise and bias stay.

        Parameters
        ----------
        parameters, sample_rate, relation
            As for the constructor.

        """
        contact = self.detector.contact
        self._T = 1.0 / sample_rate
        self._longest = 1.5 * self._T  # between consecutive samples
        cutoff = parameters.cutoff_frequency
        self._velocity_filter = ButterworthBank(1, cutoff, sample_rate)
        self._rows = GatedRows(relation, cutoff, sample_rate)
        self.gate.configure(parameters.outlier_threshold, parameters.outlier_samples)
        self.restart()
        self.detector.contact = contact

    def restart(self) -> None:
        """Start afresh with the next sample, as after a clock jump."""
        self._rows.restart()
        self.gate.leave()
        self._velocity_filter.reset()
        self._last_ns = -1
        self._last_position = nan
        self.detector.contact = False
        self._free: deque[float] = deque(maxlen=max(2, round(_TARE_S / self._T)))

    def tare(self) -> tuple[bool, str]:
        """
        Set the bias to the mean force of the last half second of free flight.

        Returns
        -------
        done : bool
            False in contact or too soon after it.
        message : str
            The new bias, or the reason for refusal.

        """
        refusal = self.tare_refusal()
        if refusal:
            return False, refusal
        self.set_bias(self.bias - sum(self._free) / len(self._free))
        return True, f'force bias is now {self.bias:.6g} N'

    def tare_refusal(self) -> str:
        """Return why no tare is possible now, '' where it is."""
        if self.detector.contact:
            return 'in contact; move away from the wall and try again'
        inside_m = self._last_position - self.location
        if inside_m > -self.location_margin:
            return (f'x is {1e3 * inside_m:.3g} mm inside environment.location, where a force may '
                    'be that of the wall; move away from it, or correct the location')
        if len(self._free) < (self._free.maxlen or 0):
            return f'out of contact for less than {_TARE_S} s; wait and try again'
        return ''

    def set_bias(self, bias: float) -> None:
        """Set the force that is subtracted from the measured F_e [N]."""
        self.bias = bias
        self._free.clear()
        self.detector.level = 0.0

    def take(
        self, sample: ContactSample
    ) -> tuple[float, float, bool, float, Row | None, NoiseGain, float]:
        """
        Condition the next sample.

        Parameters
        ----------
        sample : ContactSample
            The next one.

        Returns
        -------
        dt, velocity : float, float
            Time since the sample before [s], and measured or estimated rate of x [m/s].
        contact : bool
            Whether the sample is in contact.
        variance : float
            Of the force noise, as known at the sample [N^2].
        row : row or None
            (y, phi_K, phi_B, phi_c, ...) of a sample in contact; None elsewhere, and where the
            relation does not hold, or not yet.
        gain : NoiseGain
            How white noise enters the row.
        shift : float
            Known displacement of the surface [m].

        """
        stamp_ns, position, velocity, force = sample
        last_ns, self._last_ns = self._last_ns, stamp_ns
        dt = (stamp_ns - last_ns) * 1e-9 if last_ns >= 0 else 0.0
        if dt > self._longest:
            self.missing += round(dt / self._T) - 1
        mean = self.sample_period_s
        self.sample_period_s = mean + _PERIOD_GAIN * (dt - mean) if mean else dt
        measured = velocity
        if velocity != velocity:
            velocity = self._difference(dt, position)
        self._last_position = position
        delta, pressing, known, shift = position - self.location, self.bias - force, None, 0.0
        if self.compensation is not None:
            known = self.compensation.take(sample, self.location, pressing)
            shift, delta, pressing = delta - known.depth, known.depth, known.pressing
        self.pressing, self.hindrance = pressing, known.hindrance if known else ''
        detector = self.detector
        inside = not delta <= -self.location_margin  # anywhere while x_e is unknown
        # A contact that goes on needs no detection.
        touching = (detector.contact and inside and pressing - detector.level > detector.off
                    or detector.touches(dt, pressing, inside))
        variance = detector.noise_variance
        if not touching or self.hindrance:
            self._leave(pressing, touching or inside and self.location == self.location)
            return dt, velocity, touching, variance, None, NO_GAIN, shift
        if self._free:
            self._free.clear()
        std = detector.noise_std
        if known is None:
            row, gain = self._rows.in_contact(
                dt, delta, measured, self.gate.replace(delta, pressing, std))
        else:
            rest = self.gate.replace(known.travel, known.rest, std)
            row, gain = self._rows.compensated(dt, known._replace(rest=rest))
        return dt, velocity, touching, variance, row, gain, shift

    def _difference(self, dt: float, position: float) -> float:
        """Estimate a velocity for all but the relation, which differentiates on its own."""
        last = self._last_position
        raw = (position - last) / dt if dt > 0.0 and last == last else 0.0
        return self._velocity_filter.take((raw,))[0]

    def _leave(self, pressing: float, inside: bool) -> None:
        """Keep the force of free flight, for a tare."""
        if not inside:  # where x_e is unknown, free unless in contact
            self._free.append(pressing)
        self._rows.leave()
        self.gate.leave()
