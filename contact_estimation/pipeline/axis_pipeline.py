# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""From the samples of one axis to its estimates: the path of node, replay and off-line runs."""

from itertools import repeat
from math import nan
from typing import Iterable

import numpy as np
from numpy.typing import NDArray

from .known_physics import compensation_of, KnownPhysics
from .parameters import EstimationParameters
from .posterior_estimation import (
    initial_estimate, posterior_of, PosteriorEstimation, without_band)
from .publication import Publication
from .row_estimation import RowEstimation
from .surface import Surface
from .wall_law import ModelFitMonitor
from ..estimators import MULTIPLE_MODEL
from ..estimators.estimate import Estimate, EstimateStatus, new_tuple, ParameterEstimate
from ..estimators.estimator import OnlineEstimator
from ..estimators.multiple_model import CONTACT
from ..kinematics.parameters import TRACKED
from ..physics import effects_that_are_on
from ..reference.setpoints import Reference
from ..signals.conditioning import Conditioner
from ..signals.contact_sample import ContactSample

Array = NDArray[np.float64]
NO_REFERENCE = Reference(nan, nan, nan)


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
    posterior : WallPosterior
        What is known of contact and wall.
    surface : Surface
        Where the surface is nominally, and where it is found.
    model_fit : ModelFitMonitor
        Whether a law of the contact fits.
    publication : Publication
        What is published, and why no estimate is valid now, as told by checks.
    force_errors : tuple of float
        Errors of F_e that last, such as those of joint torques, each of one deviation [N].

    """

    def __init__(self, parameters: EstimationParameters | None = None) -> None:
        self.parameters = p = parameters or EstimationParameters()
        self.force_errors = tuple[float, ...]()
        self._missing = 0  # before the present posterior
        self.model_fit = ModelFitMonitor()
        self.publication = Publication(p, self.model_fit)
        self._conditioner = Conditioner(p.sample_rate, p.force_sensor.zero == TRACKED)
        self._compensate()
        self._begin(initial_estimate(self.parameters.environment))

    def _begin(self, held: ParameterEstimate) -> None:
        """Build what depends on wall, physics and estimator, and start from an estimate."""
        self._first_ns: int | None = None
        self.posterior = posterior_of(self.parameters)
        self.posterior.contact.follows_level = self._conditioner.tracker is None
        self.posterior.wall.inertia = self._compensation.inertia
        self.surface = Surface(self.parameters.environment, self.posterior, self._compensation)
        self._known_physics = KnownPhysics(self.posterior, self._compensation)
        self.publication.begin(self.posterior, self.surface)
        self._begin_estimation(held)

    def _begin_anew(self, held: ParameterEstimate) -> None:
        """Begin with the noise and the level of the force as known."""
        before, self._missing = self.posterior.contact, self.missing
        self._begin(held)
        self.posterior.keep(before)

    def _begin_estimation(self, held: ParameterEstimate) -> None:
        p, posterior = self.parameters, self.posterior
        self._by_posterior = PosteriorEstimation(
            posterior, p.environment.limits, held, self.publication)
        self._by_rows = None if p.estimator == MULTIPLE_MODEL else RowEstimation(
            p, posterior, self.surface, held)
        posterior.wall.rhythm.followed = self._by_rows is not None

    @property
    def _held(self) -> ParameterEstimate:
        return (self._by_rows or self._by_posterior).held

    def _compensate(self) -> None:
        """Build what follows known physics; its clock, and dents, outlive a reset."""
        self._compensation = compensation = compensation_of(self.parameters)
        self._conditioner.compensation = compensation if compensation.acts else None

    # -- parameters -------------------------------------------------------------------------

    def configure(self, parameters: EstimationParameters) -> None:
        """
        Set new parameters while running; K_hat and B_hat stay.

        What depends on parameters that differ begins anew. A new estimator starts from the
        present K_hat and B_hat.

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

        def differs(*names: str) -> bool:  # NaN is not equal to itself
            return any(repr(getattr(parameters, name)) != repr(getattr(old, name))
                       for name in names)

        if differs('sample_rate'):
            self._conditioner.configure(parameters.sample_rate)
        if differs('environment', 'physics', 'contact', 'synchronisation'):
            if differs('environment', 'physics', 'sample_rate'):
                self._compensate()
            self._begin_anew(without_band(self._held))
        elif differs('estimator', 'sample_rate', 'conditioning'):
            self._begin_estimation(self._held)
        if self._by_rows is not None:
            self._by_rows.configure(parameters)
        self.publication.configure(parameters)
        self._by_posterior.forget_published()

    # -- events -----------------------------------------------------------------------------

    def reset(self) -> None:
        """Reset the estimate to its initial values; the force bias and the noise stay."""
        self._begin_anew(initial_estimate(self.parameters.environment))
        self.publication.invalid = ''
        self.model_fit.reset()

    def restart_time(self) -> None:
        """Accept stamps before the last one, as when a bag loops; K_hat and B_hat stay."""
        self._conditioner.restart()
        self.posterior.restart()
        self._first_ns = None
        if self._by_rows is not None:
            self._by_rows.restart()
        self._compensate()
        self.surface.compensation = self._compensation
        self._known_physics = KnownPhysics(self.posterior, self._compensation)
        self.publication.lasting.restart()

    def tare(self) -> tuple[bool, str]:
        """Set the force bias to the mean free-flight force; False with the reason if refused."""
        refusal = self.tare_refusal()
        if refusal:
            return False, refusal
        text = self._conditioner.tare()
        self.posterior.contact.set_level(0.0, self.posterior.contact.level_variance)
        return True, text

    def tare_refusal(self) -> str:
        """Return why no tare is possible now, '' where it is."""
        return self._conditioner.tare_refusal(
            self.contact, self.surface.location, self.surface.margin)

    def set_bias(self, bias: float) -> None:
        """Set the force that is subtracted from the measured F_e [N]."""
        self.posterior.contact.set_level(0.0, self.posterior.contact.level_variance)
        self._conditioner.set_bias(bias)

    # -- state ------------------------------------------------------------------------------

    @property
    def bias(self) -> float:
        """Force that is subtracted from the measured F_e, set by `tare` [N]."""
        return self._conditioner.bias

    @property
    def missing(self) -> int:
        """Return the number of samples missing, from the spacing of the stamps."""
        return self._missing + self.posterior.blocks.missing

    @property
    def contact(self) -> bool:
        """Whether the last sample was in contact."""
        return self.posterior.contact.state == CONTACT

    @property
    def estimator(self) -> OnlineEstimator | None:
        """Return the estimator that runs on rows; None where it is the posterior itself."""
        return self._by_rows.estimator if self._by_rows is not None else None

    @property
    def follows_reference(self) -> bool:
        """Whether the estimator observes the reference that the robot follows."""
        return self.estimator is not None and self.estimator.follows_reference

    @property
    def control_force(self) -> float:
        """Force for a force-controlled robot [N]; NaN without one."""
        return self.estimator.control_force if self.estimator is not None else nan

    @property
    def limitation(self) -> str:
        """Return what these parameters cannot estimate, for a warning; '': nothing known."""
        return self.estimator.limitation if self.estimator is not None else ''

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
        stamp_ns, x, v, force = sample
        if self._first_ns is None:
            self._first_ns = stamp_ns
        t = (stamp_ns - self._first_ns) * 1e-9
        surface, conditioner, rows = self.surface, self._conditioner, self._by_rows
        location, shift = surface.location, 0.0
        dt, pressing, known = conditioner.take(sample, location)
        if known is None:
            state = self.posterior.take(t, pressing, x, v)
        else:
            state, shift, known = self._known_physics.take(t, dt, x, v, known, location)
            pressing = known.pressing
        self._note_force(state, dt, x, v, pressing)
        if location != location:
            surface.locate(state)
        if known is None and rows is None:
            published = self._by_posterior.published(stamp_ns, state, surface.location)
            return new_tuple(Estimate, (stamp_ns, *published))
        if state == CONTACT:
            self.model_fit.note(self.posterior.known, stamp_ns)
        if rows is None:
            own, status, reason = self._by_posterior.take(state)
        else:
            rows.observe(dt, x, v, force - conditioner.offset, reference)
            own, status, reason = rows.take(dt, x - shift, v, pressing, known, state)
        if known is not None and known.hindrance and state == CONTACT:
            status, reason = EstimateStatus.FROZEN, known.hindrance
        return new_tuple(Estimate, (
            stamp_ns, *self.publication.fields(own, status, reason, shift)))

    def _note_force(self, state: int, dt: float, x: float, v: float, pressing: float) -> None:
        """Learn the zero of the force in free flight, and what its errors do in contact."""
        conditioner, location = self._conditioner, self.surface.location
        tracker = conditioner.tracker
        if state == CONTACT:
            conditioner.note_contact()
        elif not x > location - self.surface.margin:
            conditioner.note_free(pressing)
            if tracker is not None:
                self.publication.lasting.follow_zero(tracker, pressing)
        if self.force_errors or tracker is not None:
            self.publication.lasting.note(
                state == CONTACT, dt, x - location, v, self.force_errors, tracker)

    def take_many(
        self, stamps_ns: NDArray[np.int64], x: Array, v: Array, force: Array
    ) -> list[Estimate]:
        """
        Process consecutive samples as `take` does one by one without a reference.

        Parameters
        ----------
        stamps_ns : ndarray of int64, shape (N,)
            Stamps [ns].
        x, v, force : ndarray, shape (N,)
            Position [m], its rate, NaN where not measured [m/s], and F_e [N].

        Returns
        -------
        estimates : list of Estimate
            After each sample.

        """
        estimates: list[Estimate] = []
        if self._one_by_one:
            columns = (column.tolist() for column in (stamps_ns, x, v, force))
            for sample in map(ContactSample, *columns):
                estimates.append(self.take(sample))
                if not self._one_by_one:
                    break
        done = len(estimates)
        if done < len(x):
            estimates += self._run(stamps_ns[done:], x[done:], v[done:], force[done:])
        return estimates

    @property
    def _one_by_one(self) -> bool:
        """Return whether a stage needs samples one at a time."""
        conditioner = self._conditioner
        return (self._by_rows is not None or conditioner.compensation is not None
                or conditioner.tracker is not None
                or self.surface.location != self.surface.location)

    def _run(
        self, stamps_ns: NDArray[np.int64], x: Array, v: Array, force: Array
    ) -> list[Estimate]:
        """Let the posterior take samples at once; it alone makes the estimate."""
        stamps, conditioner = stamps_ns.tolist(), self._conditioner
        if self._first_ns is None:
            self._first_ns = stamps[0]
        pressing = conditioner.take_many(stamps_ns, x, force)
        outside = np.logical_not(x > self.surface.location - self.surface.margin)
        estimates: list[Estimate] = []
        t, begin = (stamps_ns - self._first_ns) * 1e-9, 0
        for end, state in self.posterior.run(t, pressing, x, v):
            if state == CONTACT:
                conditioner.note_contact()
            else:
                conditioner.note_free(*pressing[begin:end][outside[begin:end]].tolist())
            published = self._by_posterior.published(stamps[begin], state, self.surface.location)
            fields = zip(stamps[begin:end], *map(repeat, published))
            estimates += map(new_tuple, repeat(Estimate), fields)
            begin = end
        return estimates
