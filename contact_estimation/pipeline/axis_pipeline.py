# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""From the samples of one axis to its estimates: the path of node, replay and off-line runs."""

from __future__ import annotations

from math import hypot, nan, sqrt
from typing import Iterable, Mapping

import numpy as np
from numpy.typing import NDArray

from .checks.check import millimetres
from .first_touch import FirstTouch
from .lasting_error import LastingError
from .parameters import EstimationParameters, include_joint_compliance, remove_robot_compliance
from .row_estimation import RowEstimation
from .wall_law import ModelFitMonitor
from ..estimators import MULTIPLE_MODEL
from ..estimators.estimate import Estimate, EstimateStatus, new_tuple, ParameterEstimate
from ..estimators.estimator import OnlineEstimator
from ..estimators.multiple_model import CONTACT, FREE, Knowledge, lag_prior, LAWS, WallPosterior
from ..kinematics.parameters import TRACKED
from ..physics import effects_that_are_on
from ..physics.compensation import CLIPPED, Compensation
from ..reference.setpoints import Reference
from ..signals.conditioning import Conditioner, ZeroTracker
from ..signals.contact_sample import CompensatedSample, ContactSample

Array = NDArray[np.float64]
NO_REFERENCE = Reference(nan, nan, nan)
_FREE, _ESTIMATING, _FROZEN = (  # an enumeration takes long to look up
    EstimateStatus.FREE, EstimateStatus.ESTIMATING, EstimateStatus.FROZEN)
_MARGIN = 3.0  # standard deviations of the surface, beyond which it is elsewhere
_LEAST_MARGIN = 1e-3  # [m]
_LEAST_NOISE = 0.01  # of the configured noise: simulated sensors have none
_PRESSES = 2.0  # standard deviations of the force below which no row is used
_SEEN = 4.0  # standard deviations of a force that CUSUM finds in four samples
_UNCHECKED = 0.05  # share of K_e that an uncertain surface leaves open

LOCATING = 'locating the surface'
_WEAK = 'force within the noise'
_RELEASED = 'the wall has let go, and the sensor follows'
_NEITHER = 'a force that is neither that of free flight nor of the wall'
_LOST = 'the stiffness has no band: the last contact left open what it is; touch down again'


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
    model_fit : ModelFitMonitor
        Whether a law of the contact fits.
    location : float
        x_e as configured, or as found at the first touch [m]; NaN before.
    location_margin : float
        How far from its location the surface may be [m].
    force_errors : tuple of float
        Errors of F_e that last, such as those of joint torques, each of one deviation [N].
    invalid : str
        Why no estimate is valid now, as told by the checks of the session; '' where it is.

    """

    def __init__(self, parameters: EstimationParameters | None = None) -> None:
        self.parameters = p = parameters or EstimationParameters()
        self.invalid, self.force_errors = '', tuple[float, ...]()
        self._missing = 0  # before the present posterior
        self.model_fit = ModelFitMonitor()
        self._conditioner = Conditioner(p.sample_rate, p.force_sensor.zero == TRACKED)
        self._robot = include_joint_compliance(p.robot, p.physics)
        self._compensate()
        self._begin()

    def _begin(self) -> None:
        """Build what depends on wall, physics and estimator."""
        self._first_ns: int | None = None
        p = self.parameters
        environment = p.environment
        self.location = environment.location
        self.location_margin = max(_MARGIN * environment.location_std, _LEAST_MARGIN)
        self.posterior = WallPosterior(
            environment.location, environment.location_std,
            lag_prior(p.physics.force_lag.tau, p.synchronisation.timing_std),
            p.contact.position_noise, p.contact.minimum_force,
            _LEAST_NOISE * p.contact.force_noise)
        self.posterior.contact.follows_level = self._conditioner.tracker is None
        self._noted: Knowledge | None = None
        self._held_of: Knowledge | None = None
        self._lasting = LastingError()
        # An estimate stays the same until hypotheses are weighed or the state of contact changes.
        self._now: Knowledge | None = None
        self._same: tuple[int, str, float] | None = None
        self._published: tuple[object, ...] = ()
        self._of_rows = self._row_estimation()
        self._held = ParameterEstimate(
            environment.initial_stiffness, environment.initial_damping, nan, nan, 0.0, nan)
        self.posterior.wall.inertia = self._compensation.inertia
        self._await_touch()

    def _begin_anew(self) -> None:
        """Begin with the noise and the level of the force as known."""
        before, self._missing = self.posterior.contact, self.missing
        self._begin()
        self.posterior.keep(before)

    def _row_estimation(self) -> RowEstimation | None:
        p = self.parameters
        self.posterior.wall.rhythm.followed = p.estimator != MULTIPLE_MODEL
        return RowEstimation(p, self.posterior) if p.estimator != MULTIPLE_MODEL else None

    def _await_touch(self) -> None:
        self._first_touch = FirstTouch(self._compensation.forces)
        self._inside, self._let_go, self._x, self._last_d = False, False, nan, nan

    def _compensate(self) -> None:
        """Build what follows known physics; its clock, and dents, outlive a reset."""
        p = self.parameters
        self._compensation = compensation = Compensation(
            effects_that_are_on(p.physics), p.environment.initial_stiffness,
            p.contact.force_noise, p.sample_rate)
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
        old, self.parameters, self._same = self.parameters, parameters, None

        def differs(*names: str) -> bool:  # NaN is not equal to itself
            return any(repr(getattr(parameters, name)) != repr(getattr(old, name))
                       for name in names)

        if differs('sample_rate'):
            self._conditioner.configure(parameters.sample_rate)
        if differs('environment', 'physics', 'contact', 'synchronisation'):
            held = self._held
            if differs('environment', 'physics', 'sample_rate'):
                self._compensate()
            self._begin_anew()
            self._held = held._replace(stiffness_std=nan, damping_std=nan)
            self._start_rows()
        elif differs('estimator', 'sample_rate', 'conditioning'):
            self._of_rows = self._row_estimation()
            self._start_rows()
        if self._of_rows is not None:
            self._of_rows.configure(parameters)
        self._robot = include_joint_compliance(parameters.robot, parameters.physics)

    def _start_rows(self) -> None:
        if self._of_rows is not None:
            estimator = self._of_rows.estimator
            estimator.start_from(*estimator.within_limits(*self._held[:2]))

    # -- events -----------------------------------------------------------------------------

    def reset(self) -> None:
        """Reset the estimate to its initial values; the force bias and the noise stay."""
        self._begin_anew()
        self.invalid = ''
        self.model_fit.reset()

    def restart_time(self) -> None:
        """Accept stamps before the last one, as when a bag loops; K_hat and B_hat stay."""
        self._conditioner.restart()
        self.posterior.restart()
        self._first_ns = None
        if self._of_rows is not None:
            self._of_rows.restart()
        self._compensate()
        self._await_touch()

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
            self.contact, self.location, self.location_margin)

    def set_bias(self, bias: float) -> None:
        """Set the force that is subtracted from the measured F_e [N]."""
        contact = self.posterior.contact
        contact.set_level(0.0, contact.level_variance)
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
    def outliers(self) -> int:
        """Return the number of forces replaced as outliers."""
        return self.posterior.blocks.outliers

    @property
    def sample_period_s(self) -> float:
        """Mean spacing of the stamps [s]; 0 before 20 of them."""
        return self.posterior.period_s

    @property
    def location_shift(self) -> float:
        """Location of the surface found less the configured one [m]."""
        now = self.posterior.known
        found = now.surface - self.parameters.environment.location
        return found if now.valid and found == found else 0.0

    @property
    def location_unchecked(self) -> bool:
        """Whether the stiffness relies on a surface that the present contact has not shown."""
        now = self.posterior.known
        if not self.contact or not now.valid:
            return False
        return now.stiffness_std > _UNCHECKED * now.stiffness

    @property
    def surface_text(self) -> str:
        """Where the surface is, if it is not where it is configured; '' where it is."""
        shift, location = self.location_shift, self.parameters.environment.location
        if abs(shift) <= self.location_margin:
            return ''
        side = 'inside' if shift > 0.0 else 'outside'
        return (f'the surface is at x = {location + shift:.4g} m, {millimetres(abs(shift))} '
                f'{side} the wall; set environment.location to {location + shift:.4g}, or to nan '
                'to take it at first touch')

    @property
    def noise_std(self) -> float:
        """Return the standard deviation of the force noise [N]."""
        return sqrt(self.posterior.contact.variance)

    @property
    def contact_threshold(self) -> float:
        """Pressing force at which a contact is seen within a few samples [N]."""
        return max(_SEEN * self.noise_std, self.parameters.contact.minimum_force)

    @property
    def surface_std(self) -> float:
        """Return the standard deviation of the surface [m]."""
        return self.posterior.known.surface_std

    @property
    def free_flight_level(self) -> float:
        """Mean pressing force in free flight [N]; far from 0, a tare is due."""
        return self.posterior.contact.level

    @property
    def contact(self) -> bool:
        """Whether the last sample was in contact."""
        return self.posterior.contact.state == CONTACT

    @property
    def laws(self) -> Mapping[str, float]:
        """Probability of each law of the contact."""
        return dict(zip(LAWS, self.posterior.known.laws))

    @property
    def estimator(self) -> OnlineEstimator | None:
        """Return the estimator that runs on rows; None where it is the posterior itself."""
        return self._of_rows.estimator if self._of_rows is not None else None

    @property
    def follows_reference(self) -> bool:
        """Whether the estimator observes the reference that the robot follows."""
        return self.estimator is not None and self.estimator.follows_reference

    @property
    def control_force(self) -> float:
        """Force for a force-controlled robot [N]; NaN without one."""
        return self.estimator.control_force if self.estimator is not None else nan

    @property
    def details(self) -> Mapping[str, float]:
        """Further estimated quantities by name, for the diagnostics."""
        return self.estimator.details if self.estimator is not None else {}

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
        stamp_ns, x, v, _ = sample
        if self._first_ns is None:
            self._first_ns = stamp_ns
        t = (stamp_ns - self._first_ns) * 1e-9
        location, posterior, conditioner = self.location, self.posterior, self._conditioner
        dt, pressing, known = conditioner.take(sample, location)
        shift = 0.0
        if known is None:
            state = posterior.take(t, pressing, x, v)
        else:
            if known.depth == known.depth:
                shift = x - location - known.depth
            if self._compensation.lags:
                known = self._follow_release(dt, x, v, known)
            state, pressing = self._take_known(t, x, shift, known), known.pressing
        if state == CONTACT:
            conditioner.note_contact()
        elif not x > location - self.location_margin:
            conditioner.note_free(pressing)
            if conditioner.tracker is not None:
                self._follow_zero(conditioner.tracker, pressing)
        if self.force_errors or conditioner.tracker is not None:
            self._note_lasting(state, dt, x - location, v)
        if location != location:
            self._locate(state, dt, x, v, pressing)
        if known is None and self._of_rows is None:
            return new_tuple(Estimate, (stamp_ns, *self._of_posterior(stamp_ns, state)))
        self._same = None
        self._note_fit(stamp_ns, state)
        if self._of_rows is not None:
            own, status, reason = self._by_rows(
                dt, sample, shift, pressing, known, state, reference)
        else:
            own, status, reason = self._by_posterior(state)
        if known is not None and known.hindrance and state == CONTACT:
            status, reason = _FROZEN, known.hindrance
        return new_tuple(Estimate, (stamp_ns, *self._published_of(own, status, reason, shift)))

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
        return (self._of_rows is not None or conditioner.compensation is not None
                or conditioner.tracker is not None or self.location != self.location)

    def _run(
        self, stamps_ns: NDArray[np.int64], x: Array, v: Array, force: Array
    ) -> list[Estimate]:
        """Let the posterior take samples at once; it alone makes the estimate."""
        stamps, conditioner = stamps_ns.tolist(), self._conditioner
        if self._first_ns is None:
            self._first_ns = stamps[0]
        pressing = conditioner.take_many(stamps_ns, x, force)
        outside = np.logical_not(x > self.location - self.location_margin)
        estimates: list[Estimate] = []
        t, begin = (stamps_ns - self._first_ns) * 1e-9, 0
        for end, state in self.posterior.run(t, pressing, x, v):
            if state == CONTACT:
                conditioner.note_contact()
            else:
                conditioner.note_free(*pressing[begin:end][outside[begin:end]].tolist())
            published = self._of_posterior(stamps[begin], state)
            estimates += [new_tuple(Estimate, (stamp, *published)) for stamp in stamps[begin:end]]
            begin = end
        return estimates

    def _of_posterior(self, stamp_ns: int, state: int) -> tuple[object, ...]:
        """Return what an estimate publishes: the same until knowledge or contact change."""
        now, same = self.posterior.known, (state, self.invalid, self.location)
        if now is not self._now or same != self._same:
            self._now, self._same = now, same
            self._note_fit(stamp_ns, state)
            self._published = self._published_of(*self._by_posterior(state), 0.0)
        return self._published

    def _follow_zero(self, tracker: ZeroTracker, pressing: float) -> None:
        """Let the tracker alone follow the zero; the filter of the contact finds what it is."""
        contact, noise = self.posterior.contact, self.noise_std
        if contact.level:
            tracker.step(contact.level, contact.level_variance / noise**2)
        elif contact.is_quiet:
            tracker.correct(pressing, noise)
        contact.set_level(0.0, (tracker.zero_std * noise)**2)

    def _note_lasting(self, state: int, dt: float, d: float, v: float) -> None:
        """Add up what errors of the force that last may have done to the estimate."""
        rate = v if v == v else (d - self._last_d) / dt if dt > 0.0 else 0.0
        self._last_d, tracker = d, self._conditioner.tracker
        if self.force_errors:
            self.posterior.contact.expect_noise(hypot(*self.force_errors))
        if state != CONTACT or rate != rate:
            self._lasting.end()
            return
        of_zero = (tracker.zero_std * self.noise_std,) if tracker is not None else ()
        self._lasting.add(d, rate, (*self.force_errors, *of_zero))

    def _note_fit(self, stamp_ns: int, state: int) -> None:
        """Let the monitor judge the fit of what is known anew."""
        now = self.posterior.known
        if now is not self._noted and state == CONTACT:
            self._noted = now
            if now.fit == now.fit:
                self.model_fit.note(now.fit, self.posterior.wall.law, stamp_ns)

    def _published_of(
        self, own: ParameterEstimate, status: EstimateStatus, reason: str, shift: float
    ) -> tuple[object, ...]:
        """Return the fields of an estimate after the stamp."""
        own = self._lasting.widened(own)
        if self._robot.compliance or self._robot.compliance_std:
            own = remove_robot_compliance(own, self._robot)
        K, B, K_std, B_std, _, inertia = own
        if self.invalid:
            K_std = B_std = nan
            status, reason = _FREE if status is _FREE else _FROZEN, self.invalid
        now = self.posterior.known
        surface = (now.surface if now.valid else self.location) + shift
        return K, B, K_std, B_std, surface, inertia, status, reason, self.model_fit.now.ratio

    def _locate(self, state: int, dt: float, x: float, v: float, pressing: float) -> None:
        """Take the surface that the first touch shows."""
        found = self._first_touch.take(
            state == CONTACT, x, v, pressing - self.free_flight_level, dt, self.noise_std)
        if found is not None:
            self.location = self._compensation.nominal(found[0])
            self.posterior.expect(self.location, found[1])

    def _take_known(self, t: float, x: float, shift: float, known: CompensatedSample) -> int:
        """Let the posterior see what known physics leave, on a path on which K_e acts."""
        if known.hindrance is CLIPPED and self.contact:
            return CONTACT  # a force that stays the same would pass for that of no wall
        location, v = self.location, known.velocity
        path, felt, bent = x, x - shift, (0.0, 0.0)
        if location == location:
            path = location + known.stiffness_column
            bent = known.travel - known.stiffness_column, known.constant_column - 1.0
        # Without a force the known physics that are taken out would pass for one.
        usable = not known.hindrance and self._presses(known.pressing)
        rest = known.rest + known.inertial_force  # the posterior has a less noisy acceleration
        return self.posterior.take(t, rest, path, v, usable, (known.pressing, felt), bent)

    def _follow_release(
        self, dt: float, x: float, v: float, known: CompensatedSample
    ) -> CompensatedSample:
        """Say that the wall, which cannot pull, has let go, where a sensor still feels it."""
        inside, now = known.depth > 0.0, self.posterior.known
        if inside and not self._inside:
            self._let_go = False
        elif inside and now.valid:
            rate = v if v == v else (x - self._x) / dt if dt > 0.0 else 0.0
            self._let_go |= now.stiffness * known.depth + now.damping * rate < 0.0
        self._inside, self._x = inside, x
        if self._let_go and not known.hindrance:
            return known._replace(hindrance=_RELEASED)
        return known

    def _presses(self, pressing: float) -> bool:
        """Return whether a force is above the noise: the end of a contact is seen late."""
        return pressing - self.free_flight_level > _PRESSES * self.noise_std

    def _by_posterior(self, state: int) -> tuple[ParameterEstimate, EstimateStatus, str]:
        now = self.posterior.known
        if now is not self._held_of:
            self._held_of = now
            if now.valid:
                low, high, most = self.parameters.environment.limits
                self._held = ParameterEstimate(
                    min(max(now.stiffness, low), high), min(max(now.damping, 0.0), most),
                    *now.stds_of_depths, 0.0, now.inertia)
            else:
                self._held = self._held._replace(stiffness_std=nan, damping_std=nan)
        if state == CONTACT:
            if now.valid:
                return self._held, _ESTIMATING, ''
            return self._held, _FROZEN, LOCATING
        reasons = [] if state == FREE else [_NEITHER]
        if now.stiffness == now.stiffness and not now.valid:
            reasons.append(_LOST)
        return self._held, _FREE, '; '.join(reasons)

    def _by_rows(
        self, dt: float, sample: ContactSample, shift: float, pressing: float,
        known: CompensatedSample | None, state: int, reference: Reference,
    ) -> tuple[ParameterEstimate, EstimateStatus, str]:
        assert self._of_rows is not None
        _, x, v, force = sample
        rows, now = self._of_rows, self.posterior.known
        estimator = rows.estimator
        if estimator.follows_reference and reference[0] == reference[0]:
            estimator.observe(
                dt, x, rows.rate_of(dt, x, v), force - self._conditioner.offset, reference)
        if state != CONTACT or not self._presses(pressing):
            self._held = rows.leave(over=state != CONTACT)
            if state == CONTACT:
                return self._held, _FROZEN, _WEAK
            return self._held, _FREE, '' if state == FREE else _NEITHER
        if self.location != self.location or known is not None and known.hindrance:
            rows.restart()
            return self._held, _FROZEN, LOCATING
        sure = now.stiffness_std < _UNCHECKED * now.stiffness
        found = now.surface - self.location if sure else nan
        self._held, status, reason = rows.take(
            dt, x - shift - self.location, v, pressing - self.free_flight_level, known, found)
        return self._held, status, reason
