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

from itertools import repeat
import math
from math import isfinite, nan
from typing import Iterable, Sequence

from .parameters import EstimationParameters
from ..estimators import ESTIMATORS
from ..estimators.equation_noise import EquationNoise
from ..estimators.estimator import (
    Estimate,
    EstimateStatus,
    Held,
    OnlineEstimator,
    Snapshot,
    TimedRow,
)
from ..estimators.excitation_monitor import ExcitationMonitor
from ..physics import effects_that_are_on
from ..physics.compensation import Compensation
from ..reference.setpoints import Reference
from ..signals.conditioning import Conditioned, Conditioner
from ..signals.contact_sample import ContactSample
from ..signals.relations import NoiseGain, Row

NO_REFERENCE = Reference(nan, nan, nan)
_HOLD_REASONS = {
    Held(False, False): '',
    Held(False, True): 'damping held: weak excitation',
    Held(True, False): 'stiffness held: weak excitation',
    Held(True, True): 'weak excitation',
}
_WAITING = 'waiting for consecutive samples'
_NOT_PREDICTED = 'predicted force within the noise'
_NOT_FINITE = 'estimate was not finite; started again'
State = tuple[Snapshot, EstimateStatus, str]


class EstimationPipeline:
    """
    Condition samples, decide contact, let the estimator learn.

    Deterministic: the estimates depend on the samples, their stamps and the parameters alone,
    and not on how the samples are cut into runs.

    Parameters
    ----------
    parameters : EstimationParameters
        Which estimator, and all tuning.

    """

    def __init__(self, parameters: EstimationParameters | None = None) -> None:
        self.parameters = parameters or EstimationParameters()
        self._make_estimator()
        p = self.parameters
        self._conditioner = Conditioner(p.contact, p.sample_rate, self._estimator.relation)
        self._make_conditioning()
        self._compensate()
        self._set_location()
        self._monitor = ExcitationMonitor(p.excitation, 1.0 / p.sample_rate)
        self._noise = EquationNoise(p.contact.force_noise**2)
        self._note_prediction()

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
        effects_that_are_on(parameters.physics)  # the only stage that can refuse
        old, self.parameters = self.parameters, parameters
        rate_changed = parameters.sample_rate != old.sample_rate
        if rate_changed or parameters.estimator != old.estimator:
            self._switch_estimator()
            self._make_conditioning()
        elif parameters.conditioning != old.conditioning:
            self._make_conditioning()
        if parameters.environment != old.environment or parameters.tuning != old.tuning:
            self._estimator.environment = parameters.environment
            self._estimator.configure(getattr(parameters.tuning, parameters.estimator))
        if repr(parameters.physics) != repr(old.physics):  # NaN is not equal to itself
            self._compensate()
        self._set_location()
        self._conditioner.detector.configure(parameters.contact)
        if rate_changed:
            self._monitor = ExcitationMonitor(parameters.excitation, 1.0 / parameters.sample_rate)
        self._monitor.configure(parameters.excitation)

    def _make_estimator(self) -> None:
        p = self.parameters
        cls = ESTIMATORS[p.estimator]
        self._estimator: OnlineEstimator = cls(
            getattr(p.tuning, p.estimator), p.environment, 1.0 / p.sample_rate
        )

    def _switch_estimator(self) -> None:
        stiffness, damping = self._estimator.stiffness, self._estimator.damping
        self._make_estimator()
        self._estimator.start_from(*self._estimator.within_limits(stiffness, damping))
        self._noise.forget_claims()
        self._note_prediction()

    def _make_conditioning(self) -> None:
        p, contact = self.parameters, self._conditioner.detector.contact
        self._conditioner.build(p.conditioning, p.sample_rate, self._estimator.relation)
        self._conditioner.detector.contact = contact

    def _compensate(self) -> None:
        p = self.parameters
        compensation = Compensation(
            effects_that_are_on(p.physics), p.environment.initial_stiffness, p.contact.force_noise
        )
        self._conditioner.compensation = compensation if compensation.acts else None

    def _set_location(self) -> None:
        self._conditioner.location = self.parameters.environment.location
        # Where x_e is estimated too, its prior decides how far outside no contact can be.
        self._conditioner.location_margin = 5.0 * (self._estimator.location_std or 0.0)

    # -- events -----------------------------------------------------------------------------

    def reset(self) -> None:
        """Go back to the first guess; the tare stays."""
        self._estimator.reset()
        self._monitor.reset()
        self._noise = EquationNoise(self.parameters.contact.force_noise**2)
        self._conditioner.detector.reset()
        self._conditioner.forget_motion()
        self._note_prediction()

    def restart_time(self) -> None:
        """Accept stamps before the last one, as when a bag loops; K_hat and B_hat stay."""
        self._conditioner.forget_motion()
        self._compensate()

    def tare(self) -> tuple[bool, str]:
        """
        Take the free-flight force of the last moments for zero.

        Returns
        -------
        done : bool
            False in contact or too soon after it.
        message : str
            What was done, or why not.

        """
        return self._conditioner.tare()

    def tare_refusal(self) -> str:
        """Say why no tare is possible now; '' where it is."""
        return self._conditioner.tare_refusal()

    def set_bias(self, bias: float) -> None:
        """
        Take a known force for zero.

        Parameters
        ----------
        bias : float
            Subtracted from the measured F_e [N].

        """
        self._conditioner.set_bias(bias)

    @property
    def bias(self) -> float:
        """Force that is subtracted from the measured F_e, set by `tare` [N]."""
        return self._conditioner.bias

    @property
    def missing(self) -> int:
        """Samples that the spacing of the stamps says are missing."""
        return self._conditioner.missing

    @property
    def sample_period_s(self) -> float:
        """Mean spacing of the last samples by their stamps [s]; 0 before any."""
        return self._conditioner.sample_period_s

    @property
    def noise_std(self) -> float:
        """Standard deviation of the force noise in free flight [N]."""
        return math.sqrt(self._conditioner.detector.noise_variance)

    @property
    def free_flight_level(self) -> float:
        """Pressing force that remains in free flight [N]; far from 0, a tare is due."""
        return self._conditioner.detector.level

    @property
    def excitation(self) -> ExcitationMonitor:
        """The monitor, for its predicted standard deviations."""
        return self._monitor

    @property
    def contact(self) -> bool:
        """Whether the last sample was in contact."""
        return self._conditioner.detector.contact

    @property
    def estimator(self) -> OnlineEstimator:
        """The estimator that runs."""
        return self._estimator

    # -- samples ----------------------------------------------------------------------------

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
        return self.process_run((sample,), reference)[0]

    def process_run(
        self, samples: Sequence[ContactSample], reference: Reference = NO_REFERENCE
    ) -> list[Estimate]:
        """
        Take samples, one after the other.

        Parameters
        ----------
        samples : sequence of ContactSample
            With growing stamps after the last one, and finite position and force.
        reference : Reference
            What the robot follows during all of them.

        Returns
        -------
        estimates : list of Estimate
            One a sample.

        """
        conditioned = self._conditioner.process(samples)
        if self._estimator.follows_reference and reference.position == reference.position:
            self._observe(samples, conditioned, reference)
        states: list[State] = []
        begin, count = 0, len(samples)
        contact, rows = conditioned.contact, conditioned.rows
        while begin < count:
            learns = rows[begin] is not None
            end = begin + 1
            while end < count and (rows[end] is not None) is learns:
                end += 1
            if learns:
                states += self._learn(
                    conditioned.dts[begin:end], rows[begin:end], conditioned.variances[begin],
                    conditioned.gains[begin:end],
                )
            else:
                states += self._stand(contact[begin:end])
            begin = end
        location = self.parameters.environment.location
        surfaces: Iterable[float] = repeat(location)
        if conditioned.shifts:
            surfaces = [location + shift for shift in conditioned.shifts]
        return [
            Estimate(
                sample[0], now[0], now[1], now[2], now[3], surface + now[4], now[5], status, why
            )
            for sample, surface, (now, status, why) in zip(samples, surfaces, states)
        ]

    def _observe(
        self, samples: Sequence[ContactSample], conditioned: Conditioned, reference: Reference
    ) -> None:
        observe, bias = self._estimator.observe, self._conditioner.bias
        for sample, dt, velocity in zip(samples, conditioned.dts, conditioned.velocities):
            observe(dt, sample.position, velocity, sample.force - bias, reference)

    def _stand(self, contact: list[bool]) -> list[State]:
        """Hold still: out of contact, or while consecutive samples are lacking."""
        now = self._known()
        free: State = now, EstimateStatus.FREE, ''
        waiting: State = now, EstimateStatus.FROZEN, _WAITING
        return [waiting if touching else free for touching in contact]

    def _learn(
        self, dts: list[float], rows: Sequence[Row | None], force_variance: float,
        gains: list[NoiseGain],
    ) -> list[State]:
        """Learn between the judgements on excitation, which fall on fixed counts of rows."""
        longest = 2.0 / self.parameters.sample_rate  # never integrate over a gap
        timed: list[TimedRow] = [
            (dt if dt < longest else longest, row) for dt, row in zip(dts, rows) if row
        ]
        states: list[State] = []
        begin = 0
        while begin < len(timed):
            part = timed[begin:begin + self._monitor.until_judgement]
            linear = self._linear
            seen = [linear(row) if linear else row for _, row in part]
            self._monitor.add(seen, gains[begin:begin + len(part)])
            states += self._learn_part(part, max(force_variance, self._noise.variance))
            if self._monitor.until_judgement == 0:
                self._judge(force_variance)
            begin += len(part)
        return states

    def _learn_part(self, part: list[TimedRow], variance: float) -> list[State]:
        held = self._monitor.held
        if held.stiffness and held.damping:
            still = self._known(), EstimateStatus.FROZEN, _HOLD_REASONS[held]
            return [still] * len(part)
        K, B, floor = self._prediction
        if all(K * row[1] + B * row[2] > floor for _, row in part):
            snapshots = self._claimed(part, variance, held)
            reason = _HOLD_REASONS[held]
            return self._checked([(now, EstimateStatus.ESTIMATING, reason) for now in snapshots])
        states: list[State] = []
        for timed in part:
            if K * timed[1][1] + B * timed[1][2] > floor:
                (now,) = self._claimed((timed,), variance, held)
                states.append((now, EstimateStatus.ESTIMATING, _HOLD_REASONS[held]))
            else:
                now = self._known()
                states.append((now, EstimateStatus.FROZEN, _NOT_PREDICTED))
        return self._checked(states)

    def _claimed(
        self, part: Sequence[TimedRow], variance: float, held: Held
    ) -> list[Snapshot]:
        self._noise.note_learning(held)
        return list(map(self._noise.claim, self._estimator.learn(part, variance, held)))

    def _known(self) -> Snapshot:
        return self._noise.claim(self._estimator.snapshot())

    def _checked(self, states: list[State]) -> list[State]:
        """Start again rather than go on from a number that is none."""
        now = states[-1][0]
        if isfinite(now.stiffness) and isfinite(now.damping):
            return states
        self._estimator.reset()
        return [(self._known(), EstimateStatus.FROZEN, _NOT_FINITE)] * len(states)

    def _judge(self, force_variance: float) -> None:
        estimator, environment = self._estimator, self.parameters.environment
        self._noise.judge(
            self._monitor.window(), force_variance, self.parameters.contact.position_noise,
            estimator,
        )
        self._monitor.judge(
            self._noise.variance,
            max(estimator.stiffness, 0.1 * environment.initial_stiffness),
            max(estimator.damping, environment.initial_damping, 1e-3),
            estimator.location_std,
        )
        self._note_prediction()

    def _note_prediction(self) -> None:
        """Keep K_hat, B_hat and the noise by which the next rows are found predictable."""
        self._linear = self._estimator.linearisation()
        if self._estimator.estimates_location:
            self._prediction = 0.0, 0.0, -1.0  # no prediction before the location is known
            return
        K, B = self._estimator.stiffness, self._estimator.damping
        self._prediction = K, B, 3.0 * K * self.parameters.contact.position_noise
