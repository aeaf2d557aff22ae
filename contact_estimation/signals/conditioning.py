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
From raw samples to rows that an estimator can learn from.

Gate first, then filter: with c the contact flag, c F = K_e c delta + B_e c v holds at all times,
so [c delta, c v, c] and c F pass the same filter. Filtering first would smear the touch-down into
the estimate.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
import math
from math import ceil, nan
from typing import Any, NamedTuple, Sequence

from .butterworth import ButterworthBank
from .contact_detection import ContactDetector, ContactParameters
from .contact_sample import ContactSample
from .relations import COLUMNS, NO_GAIN, NoiseGain, Relation, Row
from ..parameters.specification import parameter, ParameterGroup

_ZEROS = (0.0,) * COLUMNS
_TARE_S = 0.5
_PERIOD_GAIN = 0.01  # of the mean sample period


@dataclass(frozen=True)
class ConditioningParameters(ParameterGroup):
    """The low-pass that regressor and force pass alike."""

    cutoff_frequency: float = parameter(
        50.0, 'Cut-off of the second-order Butterworth filter; 0: no filter', 'Hz', minimum=0.0
    )


class Conditioned(NamedTuple):
    """
    A run of samples, conditioned.

    Attributes
    ----------
    dts : list of float
        Time from each sample's predecessor [s].
    velocities : list of float
        Measured or estimated rate of x [m/s].
    contact : list of bool
        Whether each sample is in contact.
    variances : list of float
        Of the force noise, as known at each sample [N^2].
    rows : list of row or None
        (y, phi_K, phi_B, phi_c, ...) of samples in contact; None elsewhere, and where the
        relation does not hold, or not yet.
    gains : list of NoiseGain
        How white noise enters each row.
    shifts : sequence of float
        By how much the surface is known to have moved [m]; empty: not at all.

    """

    dts: list[float]
    velocities: list[float]
    contact: list[bool]
    variances: list[float]
    rows: list[Row | None]
    gains: list[NoiseGain]
    shifts: Sequence[float] = ()


class Conditioner:
    """
    Velocity, contact, known extra physics, relation, gate and filter, in this order.

    Causal, and the same however the samples are cut into runs.

    Parameters
    ----------
    contact : ContactParameters
        Thresholds of contact.
    sample_rate : float
        Nominal [Hz].
    relation : type of Relation
        What the estimator fits.

    """

    def __init__(
        self, contact: ContactParameters, sample_rate: float, relation: type[Relation]
    ) -> None:
        self.detector = ContactDetector(contact)
        self.bias = 0.0
        self.location = 0.0
        self.location_margin = 0.0
        self.compensation: Any = None
        self.missing = 0
        self.sample_period_s = 0.0
        self.build(ConditioningParameters(0.0), sample_rate, relation)

    def build(
        self, parameters: ConditioningParameters, sample_rate: float, relation: type[Relation]
    ) -> None:
        """
        Make filters and relation anew; contact, noise and tare stay.

        Parameters
        ----------
        parameters : ConditioningParameters
            The filter.
        sample_rate : float
            Nominal [Hz].
        relation : type of Relation
            What the estimator fits.

        """
        self._T = 1.0 / sample_rate
        cutoff = parameters.cutoff_frequency
        self._filter = ButterworthBank(COLUMNS, cutoff, sample_rate)
        self._velocity_filter = ButterworthBank(1, cutoff, sample_rate)
        # The slower pole decays with cutoff / sqrt(2): after so many samples 1e-9 is left.
        self._tail = 0 if cutoff == 0.0 else ceil(21.0 * math.sqrt(2.0) * sample_rate
                                                  / (2.0 * math.pi * cutoff))
        self._relation_class = relation
        self._gains = {
            w: NoiseGain(self._filter.noise_gain(w.force),
                         self._filter.noise_gain(w.rate) / self._T**2)
            for w in relation.weightings
        }
        self.forget_motion()

    def forget_motion(self) -> None:
        """Begin anew with the next sample, as after a jump of time."""
        self._filter.reset()
        self._velocity_filter.reset()
        # The second and third carry the columns of K_e and x_e, where known physics bend them.
        self._relation, *self._columns = (self._relation_class(self._T) for _ in range(3))
        self._tail_left = 0
        self._last_ns = -1
        self._last_position = nan
        self.detector.contact = False
        self._free: deque[float] = deque(maxlen=max(2, round(_TARE_S / self._T)))

    def tare(self) -> tuple[bool, str]:
        """
        Take the mean free-flight force of the last half second for zero.

        Returns
        -------
        done : bool
            False in contact or too soon after it.
        message : str
            What was done, or why not.

        """
        refusal = self.tare_refusal()
        if refusal:
            return False, refusal
        self.set_bias(self.bias - sum(self._free) / len(self._free))
        return True, f'force bias is now {self.bias:.6g} N'

    def tare_refusal(self) -> str:
        """Say why no tare is possible now; '' where it is."""
        if self.detector.contact:
            return 'in contact; move away from the wall and try again'
        if len(self._free) < (self._free.maxlen or 0):
            return f'out of contact for less than {_TARE_S} s; wait and try again'
        return ''

    def set_bias(self, bias: float) -> None:
        """
        Take a force for zero.

        Parameters
        ----------
        bias : float
            Subtracted from the measured F_e [N].

        """
        self.bias = bias
        self._free.clear()
        self.detector.level = 0.0

    def process(self, samples: Sequence[ContactSample]) -> Conditioned:
        """
        Condition a run of samples.

        Parameters
        ----------
        samples : sequence of ContactSample
            In the order of their stamps.

        Returns
        -------
        conditioned : Conditioned
            One entry a sample.

        """
        dts, deltas, velocities, pressings = self._motion(samples)
        known = self._know(samples, deltas, pressings) if self.compensation else []
        shifts = [delta - now.depth for delta, now in zip(deltas, known)]
        if known:
            deltas, pressings = [now.depth for now in known], [now.pressing for now in known]
        surface = -self.location_margin
        inside = [delta > surface for delta in deltas]
        contact, variances = self.detector.decide(dts, pressings, inside)
        learns = contact
        if known:
            learns = [touching and now.usable for touching, now in zip(contact, known)]
        rows: list[Row | None] = [None] * len(samples)
        gains = [NO_GAIN] * len(samples)
        begin, count = 0, len(samples)
        while begin < count:  # stretch by stretch of contact and of free flight
            touching, end = learns[begin], begin + 1
            while end < count and learns[end] is touching:
                end += 1
            if touching:
                stretch = slice(begin, end)
                rows[stretch], gains[stretch] = self._filtered(
                    *(self._known_rows(dts[stretch], known[stretch]) if known else self._rows(
                        samples[stretch], dts[stretch], deltas[stretch], pressings[stretch]))
                )
            else:
                self._fly(pressings[begin:end], inside[begin:end])
            begin = end
        return Conditioned(dts, velocities, contact, variances, rows, gains, shifts)

    def _motion(
        self, samples: Sequence[ContactSample]
    ) -> tuple[list[float], list[float], list[float], list[float]]:
        if self._last_ns < 0:
            self._last_ns = samples[0][0]
        location, bias, last, longest = self.location, self.bias, self._last_ns, 1.5 * self._T
        dts, deltas, velocities, pressings = [], [], [], []
        mean = self.sample_period_s
        for stamp_ns, position, velocity, force in samples:
            dt = (stamp_ns - last) * 1e-9
            last = stamp_ns
            if dt > longest:
                self.missing += round(dt / self._T) - 1
            dts.append(dt)
            mean += _PERIOD_GAIN * (dt - mean) if mean else dt
            deltas.append(position - location)
            velocities.append(
                velocity if velocity == velocity else self._difference(dt, position)
            )
            pressings.append(bias - force)
            self._last_position = position
        self._last_ns, self.sample_period_s = last, mean
        return dts, deltas, velocities, pressings

    def _difference(self, dt: float, position: float) -> float:
        """Estimate a velocity for all but the relation, which has a better way."""
        last = self._last_position
        raw = (position - last) / dt if dt > 0.0 and last == last else 0.0
        return self._velocity_filter.process(((raw,),))[0][0]

    def _know(
        self, samples: Sequence[ContactSample], deltas: list[float], pressings: list[float]
    ) -> list[Any]:
        """Tell what known extra physics makes of each sample."""
        take = self.compensation.take
        return [take(stamp_ns, delta, velocity, force, pressing) for
                (stamp_ns, _, velocity, force), delta, pressing in zip(samples, deltas, pressings)]

    def _rows(
        self, samples: Sequence[ContactSample], dts: list[float], deltas: list[float],
        pressings: list[float],
    ) -> tuple[list[Row | None], list[NoiseGain]]:
        relation, gain_of, rows, gains = self._relation, self._gains, [], []
        row_of = relation.row
        for dt, delta, sample, pressing in zip(dts, deltas, samples, pressings):
            rows.append(row_of(dt, delta, sample[2], pressing))
            gains.append(gain_of[relation.weighting])
        return rows, gains

    def _known_rows(
        self, dts: list[float], known: list[Any]
    ) -> tuple[list[Row | None], list[NoiseGain]]:
        """Build rows whose columns of K_e and x_e are weighted over time as the force is."""
        rows: list[Row | None] = []
        gains: list[NoiseGain] = []
        relation, gain_of = self._relation, self._gains
        stiffness, constant = self._columns
        for dt, now in zip(dts, known):
            travel, v = now.travel, now.velocity
            row = relation.row(dt, travel, v, now.rest)
            K = stiffness.row(dt, travel, v, now.stiffness_column)
            c = constant.row(dt, travel, v, now.constant_column)
            rows.append((row[0], K[0], row[2], c[0], row[4]) if row and K and c else None)
            gains.append(gain_of[relation.weighting])
        return rows, gains

    def _filtered(
        self, rows: list[Row | None], gains: list[NoiseGain]
    ) -> tuple[list[Row | None], list[NoiseGain]]:
        self._free.clear()
        self._tail_left = self._tail
        filtered = self._filter.process([row or _ZEROS for row in rows])
        if None in rows:  # the relation waits for consecutive samples
            return [new if row else None for row, new in zip(rows, filtered)], gains
        return list(filtered), gains

    def _fly(self, pressings: list[float], inside: list[bool]) -> None:
        """Let the gate's zeros run through the filter until nothing of the contact is left."""
        self._free.extend([p for p, may in zip(pressings, inside) if not may])
        for relation in (self._relation, *self._columns):
            relation.leave()
        if self._tail_left:
            zeros = min(self._tail_left, len(inside))
            self._filter.process([_ZEROS] * zeros)
            self._tail_left -= zeros
            if not self._tail_left:
                self._filter.reset()
