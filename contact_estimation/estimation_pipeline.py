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

"""From contact samples to estimates: the one path of node, replay and diagnosis."""

from __future__ import annotations

import math
from math import isfinite, nan
from typing import Any

from .estimation_parameters import EstimationParameters
from .estimators import ESTIMATORS
from .estimators.estimator import (
    Estimate,
    EstimateStatus,
    Held,
    OnlineEstimator,
    Reference,
)
from .estimators.excitation_monitor import ExcitationMonitor
from .exceptions import ContactEstimationError
from .physics import effects_that_are_on
from .physics.physics import ContactEffect
from .signals.butterworth import ButterworthBank
from .signals.contact_detection import ContactDetector
from .signals.contact_sample import ContactSample

NO_REFERENCE = Reference(nan, nan, nan)
_TARE_S = 0.5
_ROW_LENGTH = 5
_NEGLIGIBLE_GATE = 1e-9
_HOLD_REASONS = {
    Held(False, False): '',
    Held(False, True): 'damping held: weak excitation',
    Held(True, False): 'stiffness held: weak excitation',
    Held(True, True): 'weak excitation',
}


class EstimationPipeline:
    """
    Condition each sample, decide contact, let the estimator learn.

    Deterministic: the estimates depend on the samples, their stamps and the parameters alone.

    Parameters
    ----------
    parameters : EstimationParameters
        Which estimator, and all tuning.

    """

    def __init__(self, parameters: EstimationParameters | None = None) -> None:
        self.parameters = parameters or EstimationParameters()
        self.bias = 0.0
        self._build_estimator()
        self._build_conditioning()
        self._detector = ContactDetector(self.parameters.contact)
        self._monitor = ExcitationMonitor(self.parameters.excitation, self._T)
        self._build_compensation()
        self._first_stamp_ns: int | None = None
        self._last_stamp_ns = 0
        self._forget_motion()

    # -- parameters -------------------------------------------------------------------------

    def configure(self, parameters: EstimationParameters) -> None:
        """
        Take new parameters while running; K_hat and B_hat stay.

        Only the stages whose parameters differ are touched. A new estimator starts from the
        present K_hat and B_hat.

        Parameters
        ----------
        parameters : EstimationParameters
            The new values.

        Raises
        ------
        ContactEstimationError
            If they do not fit together; nothing has changed then.

        """
        old, self.parameters = self.parameters, parameters
        try:
            self._build_changed(old, parameters)
        except ContactEstimationError:
            self.parameters = old
            raise

    def _build_changed(self, old: EstimationParameters, new: EstimationParameters) -> None:
        rate_changed = new.sample_rate != old.sample_rate
        if rate_changed or new.conditioning != old.conditioning:
            self._build_conditioning()
        if new.physics != old.physics:
            self._build_compensation()
        if rate_changed or new.estimator != old.estimator:
            self._switch_estimator()
        elif new.environment != old.environment or new.tuning != old.tuning:
            self._estimator.environment = new.environment
            self._estimator.configure(getattr(new.tuning, new.estimator))
            self._estimator.bound()
        self._detector.configure(new.contact)
        if rate_changed:
            self._monitor = ExcitationMonitor(new.excitation, self._T)
        self._monitor.configure(new.excitation)

    def _build_conditioning(self) -> None:
        p = self.parameters
        self._filter = ButterworthBank(
            _ROW_LENGTH, p.conditioning.cutoff_frequency, p.sample_rate
        )
        self._velocity_filter = ButterworthBank(
            1, p.conditioning.cutoff_frequency, p.sample_rate
        )
        self._filter_empty = True

    def _build_compensation(self) -> None:
        effects = effects_that_are_on(self.parameters.physics)
        self._compensated = [e for e in effects if isinstance(e, ContactEffect)]

    def _build_estimator(self) -> None:
        p = self.parameters
        self._T = 1.0 / p.sample_rate
        cls = ESTIMATORS[p.estimator]
        tuning = getattr(p.tuning, p.estimator)
        self._estimator: OnlineEstimator = cls(tuning, p.environment, self._T)
        self._relation = cls.relation(self._T)

    def _switch_estimator(self) -> None:
        stiffness, damping = self._estimator.stiffness, self._estimator.damping
        self._build_estimator()
        self._estimator.start_from(stiffness, damping)
        self._filter.reset()  # the relation's columns may differ
        self._filter_empty = True

    # -- events -----------------------------------------------------------------------------

    def reset(self) -> None:
        """Go back to the first guess; the tare stays."""
        self._estimator.reset()
        self._monitor.reset()
        self._detector.reset()
        self._forget_motion()

    def restart_time(self) -> None:
        """Accept stamps before the last one, as when a bag loops; K_hat and B_hat stay."""
        self._detector.contact = False
        self._first_stamp_ns = None
        self._forget_motion()

    def tare(self) -> tuple[bool, str]:
        """
        Take the free-flight force of the last moments for zero.

        Returns
        -------
        done : bool
            False in contact or before any sample.
        message : str
            What was done, or why not.

        """
        if self._first_stamp_ns is None or self._free_since_ns is None:
            return False, 'in contact, or no sample yet; move away from the wall and try again'
        if self._last_stamp_ns - self._free_since_ns < _TARE_S * 1e9:
            return False, f'out of contact for less than {_TARE_S} s; wait and try again'
        self.bias -= self._tare_level
        self._detector.level = 0.0
        self._tare_level = 0.0
        return True, f'force bias is now {self.bias:.6g} N'

    @property
    def noise_std(self) -> float:
        """Standard deviation of the force noise in free flight [N]."""
        return math.sqrt(self._detector.noise_variance)

    @property
    def free_flight_level(self) -> float:
        """Pressing force that remains in free flight [N]; far from 0, a tare is due."""
        return self._detector.level

    @property
    def excitation(self) -> ExcitationMonitor:
        """The monitor, for its predicted standard deviations."""
        return self._monitor

    @property
    def contact(self) -> bool:
        """Whether the last sample was in contact."""
        return self._detector.contact

    @property
    def estimator(self) -> OnlineEstimator:
        """The estimator that runs."""
        return self._estimator

    # -- samples ----------------------------------------------------------------------------

    def _forget_motion(self) -> None:
        self._filter.reset()
        self._velocity_filter.reset()
        self._filter_empty = True
        self._relation = type(self._relation)(self._T)
        self._last_stamp_ns = 0
        self._last_position = nan
        self._last_velocity = nan
        self._free_since_ns: int | None = None
        self._tare_level = 0.0
        self._status = EstimateStatus.FREE

    def process(self, sample: ContactSample, reference: Reference = NO_REFERENCE) -> Estimate:
        """
        Take one sample.

        Parameters
        ----------
        sample : ContactSample
            With a stamp after the last one and finite position and force.
        reference : Reference
            What the robot follows; needed by estimators that follow it.

        Returns
        -------
        estimate : Estimate
            What is known now.

        """
        stamp_ns, position, velocity, force = sample
        if self._first_stamp_ns is None:
            self._first_stamp_ns = self._last_stamp_ns = stamp_ns
        dt = (stamp_ns - self._last_stamp_ns) * 1e-9
        self._last_stamp_ns = stamp_ns
        estimator = self._estimator
        delta = position - self.parameters.environment.location
        motion = velocity if velocity == velocity else self._difference(dt, position)
        pressing = self.bias - force
        contact = self._decide_contact(dt, delta, motion, pressing)
        if estimator.follows_reference and reference.position == reference.position:
            estimator.observe(dt, position, motion, -pressing, reference)
        if contact and self._compensated:
            pressing -= self._known_resistance(dt, stamp_ns, delta, motion)
        self._last_position, self._last_velocity = position, motion
        row = self._relation.row(dt, delta, velocity, pressing, contact)
        status, reason = EstimateStatus.FREE, ''
        filtered = self._condition(row)
        if contact:
            status, reason = self._learn(dt, row is not None, filtered)
        return Estimate(
            stamp_ns,
            estimator.stiffness,
            estimator.damping,
            estimator.stiffness_std,
            estimator.damping_std,
            self.parameters.environment.location + estimator.location_shift,
            estimator.inertia,
            status,
            reason,
        )

    def _difference(self, dt: float, position: float) -> float:
        """Estimate the velocity for the contact decision; the relation has a better way."""
        last = self._last_position
        raw = (position - last) / dt if dt > 0.0 and last == last else 0.0
        return self._velocity_filter.process((raw,))[0]

    def _decide_contact(
        self, dt: float, delta: float, velocity: float, pressing: float
    ) -> bool:
        estimator, detector = self._estimator, self._detector
        predicted: float | None = None
        if not estimator.estimates_location:
            K = estimator.stiffness
            predicted = K * delta + estimator.damping * velocity if delta > 0.0 else 0.0
            detector.expect_above(3.0 * K * self.parameters.contact.position_noise)
        contact = detector.update(dt, pressing, predicted)
        if contact or (predicted is not None and predicted > 0.0):
            self._free_since_ns = None
        elif self._free_since_ns is None:
            self._free_since_ns, self._tare_level = self._last_stamp_ns, pressing
        else:
            # The plain mean converges faster than the detector's slow, outlier-proof level.
            elapsed = (self._last_stamp_ns - self._free_since_ns) * 1e-9
            gain = dt / min(max(elapsed, dt), _TARE_S) if dt > 0.0 else 0.0
            self._tare_level += gain * (pressing - self._tare_level)
        return contact

    def _known_resistance(
        self, dt: float, stamp_ns: int, delta: float, velocity: float
    ) -> float:
        assert self._first_stamp_ns is not None
        t = (stamp_ns - self._first_stamp_ns) * 1e-9
        last = self._last_velocity
        acceleration = (velocity - last) / dt if dt > 0.0 and last == last else 0.0
        return sum(
            effect.resistance(t, delta, velocity, (), math) + effect.inertia * acceleration
            for effect in self._compensated
        )

    def _condition(self, row: Any) -> Any:
        """Filter the gated row; outside contact the gate has made all columns zero."""
        if row is None:
            if self._filter_empty:
                return None
            filtered = self._filter.process((0.0,) * _ROW_LENGTH)
            if abs(filtered[3]) < _NEGLIGIBLE_GATE:
                self._filter.reset()
                self._filter_empty = True
            return filtered
        self._filter_empty = False
        return self._filter.process(row)

    def _learn(self, dt: float, valid: bool, row: Any) -> tuple[EstimateStatus, str]:
        estimator, environment = self._estimator, self.parameters.environment
        if not valid:
            return EstimateStatus.FROZEN, 'waiting for consecutive samples'
        variance = self._detector.noise_variance
        held = self._monitor.update(
            row,
            variance,
            max(estimator.stiffness, 0.1 * environment.initial_stiffness),
            max(estimator.damping, environment.initial_damping, 1e-3),
            getattr(estimator, 'location_std', None),
        )
        if held.stiffness and held.damping:
            return EstimateStatus.FROZEN, _HOLD_REASONS[held]
        estimator.update(min(dt, 2.0 * self._T), row, variance, held)
        if not (isfinite(estimator.stiffness) and isfinite(estimator.damping)):
            estimator.reset()
            return EstimateStatus.FROZEN, 'estimate was not finite; started again'
        return EstimateStatus.ESTIMATING, _HOLD_REASONS[held]
