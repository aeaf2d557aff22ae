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

"""From the samples of one axis to its estimates: the path of node, replay and off-line runs."""

from __future__ import annotations

import math
from math import nan
from typing import Iterable

from .checks.touch_down import TouchDown
from .model_fit import ModelFitMonitor
from .parameters import EstimationParameters
from .supervised_estimator import SupervisedEstimator
from .surface_search import REACH
from ..estimators.estimate import Estimate, EstimateStatus, new_tuple
from ..estimators.estimator import OnlineEstimator
from ..estimators.excitation_monitor import ExcitationMonitor
from ..physics import effects_that_are_on
from ..physics.compensation import Compensation
from ..physics.known_wall import IN_PLAY
from ..reference.setpoints import Reference
from ..signals.conditioning import Conditioner
from ..signals.contact_sample import ContactSample

NO_REFERENCE = Reference(nan, nan, nan)
_FREE, _FROZEN = EstimateStatus.FREE, EstimateStatus.FROZEN  # an enumeration takes long


class EstimationPipeline:
    """
    Condition the samples of one axis, detect contact, update the estimate.

    Deterministic: the estimates depend on the samples, their stamps and the parameters alone.

    Parameters
    ----------
    parameters : EstimationParameters
        All parameters; `environment` is that of the axis.

    Attributes
    ----------
    model_fit : ModelFitMonitor
        Whether the model of the estimator fits.
    touch_down : TouchDown
        Where contacts begin.
    invalid : str
        Why no estimate is valid now, as told by the checks of the session; '' where it is.

    """

    def __init__(self, parameters: EstimationParameters | None = None) -> None:
        self.parameters = p = parameters or EstimationParameters()
        self.touch_down = TouchDown()
        self.invalid = ''
        self._supervised = SupervisedEstimator(p)
        self.model_fit = ModelFitMonitor(p.sample_rate)
        self._conditioner = Conditioner(
            p.contact, p.conditioning, p.sample_rate, self.estimator.relation
        )
        self._compensate()
        self._set_location()

    # -- parameters -------------------------------------------------------------------------

    def configure(self, parameters: EstimationParameters) -> None:
        """
        Set new parameters while running; K_hat and B_hat stay.

        Only the stages whose parameters differ change. A new estimator starts from the present
        K_hat and B_hat.

        Parameters
        ----------
        parameters : EstimationParameters
            The new values.

        Raises
        ------
        ContactEstimationError
            If they are inconsistent; nothing has changed then.

        """
        effects_that_are_on(parameters.physics)  # the only stage that can refuse
        old, self.parameters = self.parameters, parameters
        self._supervised.configure(parameters)
        if any(getattr(parameters, name) != getattr(old, name)
               for name in ('sample_rate', 'estimator', 'conditioning')):
            self._conditioner.configure(
                parameters.conditioning, parameters.sample_rate, self.estimator.relation
            )
        if repr(parameters.physics) != repr(old.physics):  # NaN is not equal to itself
            self._compensate()
        if repr(parameters.environment.location) != repr(old.environment.location):
            self._set_location()
            self.touch_down.trust()
            self.touch_down.taken = False
        else:
            self._note_parameters()
        self._conditioner.detector.configure(parameters.contact)
        if parameters.sample_rate != old.sample_rate:
            self.model_fit = ModelFitMonitor(parameters.sample_rate)
        self.model_fit.restart()

    def _compensate(self) -> None:
        p = self.parameters
        self._compensation = compensation = Compensation(
            effects_that_are_on(p.physics), p.environment.initial_stiffness,
            p.contact.force_noise, p.sample_rate)
        self._conditioner.compensation = compensation if compensation.acts else None
        self.touch_down.known_forces = compensation.forces if compensation.acts else None

    def _set_location(self) -> None:
        self._conditioner.location = self.parameters.environment.location
        self._note_parameters()

    def _note_parameters(self) -> None:
        self._position_noise = self.parameters.contact.position_noise
        self._observes = self.estimator.follows_reference
        # Where x_e is estimated too, its prior bounds how far outside contact is possible.
        environment = self.parameters.environment
        self._conditioner.location_margin = max(
            5.0 * (self.estimator.location_std or 0.0), REACH * environment.location_std)

    def _take_location(self, location: float, std: float) -> None:
        """Use the surface that the first touch has shown, from the next sample on."""
        self._conditioner.location = self._compensation.nominal(location)
        self._conditioner.configure(  # its filters hold rows of an unknown depth
            self.parameters.conditioning, self.parameters.sample_rate, self.estimator.relation)
        self._supervised.take_location(std)
        self.touch_down.trust()

    # -- events -----------------------------------------------------------------------------

    def reset(self) -> None:
        """Reset the estimate to its initial values; the force bias stays."""
        self._supervised.reset()
        self._conditioner.detector.reset()
        self._conditioner.restart()
        self._set_location()
        self.touch_down.reset()
        self.invalid = ''
        self.model_fit.reset()

    def restart_time(self) -> None:
        """Accept stamps before the last one, as when a bag loops; K_hat and B_hat stay."""
        self._conditioner.restart()
        self._compensate()
        self.model_fit.restart()

    def tare(self) -> tuple[bool, str]:
        """Set the force bias to the mean free-flight force; see `Conditioner.tare`."""
        return self._conditioner.tare()

    def tare_refusal(self) -> str:
        """Return why no tare is possible now, '' where it is."""
        return self._conditioner.tare_refusal()

    def set_bias(self, bias: float) -> None:
        """Set the force that is subtracted from the measured F_e [N]."""
        self._conditioner.set_bias(bias)

    # -- state ------------------------------------------------------------------------------

    @property
    def bias(self) -> float:
        """Force that is subtracted from the measured F_e, set by `tare` [N]."""
        return self._conditioner.bias

    @property
    def missing(self) -> int:
        """Return the number of samples missing, from the spacing of the stamps."""
        return self._conditioner.missing

    @property
    def location(self) -> float:
        """Location of the surface, configured or taken at the first touch [m]; NaN before."""
        return self._conditioner.location

    @property
    def location_margin(self) -> float:
        """How far from its location the surface may be [m]."""
        return self._conditioner.location_margin

    @property
    def location_shift(self) -> float:
        """Location of the surface found less the configured one [m]."""
        return self._supervised.shift

    @property
    def location_unchecked(self) -> bool:
        """Whether the present contact has not shown where its surface is."""
        return self._supervised.location_unchecked

    @property
    def outliers(self) -> int:
        """Return the number of forces replaced as outliers."""
        return self._conditioner.gate.count

    @property
    def sample_period_s(self) -> float:
        """Mean spacing of the last stamps [s]; 0 before any."""
        return self._conditioner.sample_period_s

    @property
    def noise_std(self) -> float:
        """Return the standard deviation of the force noise in free flight [N]."""
        return math.sqrt(self._conditioner.detector.noise_variance)

    @property
    def contact_threshold(self) -> float:
        """Force above which contact begins [N]."""
        contact = self.parameters.contact
        return max(contact.on_ratio * self.noise_std, contact.minimum_force)

    @property
    def free_flight_level(self) -> float:
        """Mean pressing force in free flight [N]; far from 0, a tare is due."""
        return self._conditioner.detector.level

    @property
    def contact(self) -> bool:
        """Whether the last sample was in contact."""
        return self._conditioner.detector.contact

    @property
    def excitation(self) -> ExcitationMonitor:
        """Return the excitation monitor, for its predicted standard deviations."""
        return self._supervised.monitor

    @property
    def hindrance(self) -> str:
        """Return what hinders the estimator on the present contact; '' for nothing."""
        return self._supervised.hindrance

    @property
    def estimator(self) -> OnlineEstimator:
        """Return the estimator that runs."""
        return self._supervised.estimator

    # -- samples ----------------------------------------------------------------------------

    def process(
        self, samples: Iterable[ContactSample], reference: Reference = NO_REFERENCE
    ) -> list[Estimate]:
        """Take consecutive samples, one after the other; see `take`."""
        return [self.take(sample, reference) for sample in samples]

    def take(self, sample: ContactSample, reference: Reference = NO_REFERENCE) -> Estimate:
        """
        Process the next sample.

        Parameters
        ----------
        sample : ContactSample
            Stamped after the last one, with finite position and force.
        reference : Reference
            What the robot follows then; needed where the estimator follows it.

        Returns
        -------
        estimate : Estimate
            After the sample.

        """
        conditioner, supervised = self._conditioner, self._supervised
        dt, v, touching, variance, row, gain, moved = conditioner.take(sample)
        touch_down = self.touch_down
        if conditioner.hindrance is IN_PLAY:  # its end is met inside the wall
            touch_down.trust()
        if touch_down.watches or not touching:
            reason = touch_down.take(
                sample, dt, touching, sample[1] - conditioner.location - moved,
                conditioner.pressing, conditioner.location_margin, variance)
        else:
            reason = touch_down.text
        withheld = self.invalid or reason
        if withheld:
            row = None
        if self._observes and reference[0] == reference[0]:
            supervised.estimator.observe(
                dt, sample[1], v, sample[3] - conditioner.bias, reference)
        (K, B, K_std, B_std, shift, M), status, reason = supervised.take(
            dt, touching, variance, row, gain)
        fit = self.model_fit
        if not touching:
            fit.leave(dt)
        else:
            fit.t = t = fit.t + dt
            if (fit.settled or fit.settle(dt)) and row is not None:
                fit.pending.append((t, row, sample, gain))
                if len(fit.pending) >= fit.due:
                    fit.judge(variance, supervised.estimator, self._position_noise)
        location = conditioner.location + supervised.shift + moved + shift
        if touch_down.found is not None:
            self._take_location(*touch_down.found)
        if touching and row is None and conditioner.hindrance:
            reason = conditioner.hindrance
        if withheld:
            K_std = B_std = nan
            status, reason = _FREE if status is _FREE else _FROZEN, withheld
        return new_tuple(Estimate, (
            sample[0], K, B, K_std, B_std, location, M, status, reason, fit.now[0]))
