# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The estimate where the posterior of the wall itself is the estimator."""

from math import nan

from .parameters import EstimationParameters
from .publication import Publication
from ..estimators.estimate import EstimateStatus, ParameterEstimate
from ..estimators.multiple_model import CONTACT, FREE, Knowledge, lag_prior, WallPosterior
from ..estimators.parameters import EnvironmentParameters

_FREE, _ESTIMATING, _FROZEN = (  # an enumeration takes long to look up
    EstimateStatus.FREE, EstimateStatus.ESTIMATING, EstimateStatus.FROZEN)

_LEAST_NOISE = 0.01  # of the configured noise: simulated sensors have none

LOCATING = 'locating the surface'
NEITHER = 'a force that is neither that of free flight nor of the wall'


def initial_estimate(environment: EnvironmentParameters) -> ParameterEstimate:
    """Return the estimate before any contact."""
    return ParameterEstimate(
        environment.initial_stiffness, environment.initial_damping, nan, nan, 0.0, nan)


def posterior_of(p: EstimationParameters) -> WallPosterior:
    """Return the posterior of a wall that is not known."""
    return WallPosterior(
        p.environment.location, p.environment.location_std,
        lag_prior(p.physics.force_lag.tau, p.synchronisation.timing_std),
        p.contact.position_noise, p.contact.minimum_force, _LEAST_NOISE * p.contact.force_noise)


def without_band(estimate: ParameterEstimate) -> ParameterEstimate:
    """Return an estimate whose standard deviations are not known."""
    return estimate._replace(stiffness_std=nan, damping_std=nan)


class PosteriorEstimation:
    """
    K_hat and B_hat of the posterior, within limits.

    limits: least and largest K_e [N/m], largest B_e [N s/m]
    held: the last estimate
    """

    def __init__(
        self, posterior: WallPosterior, limits: tuple[float, float, float],
        held: ParameterEstimate, publication: Publication,
    ) -> None:
        self._posterior, self._limits, self.held = posterior, limits, held
        self._publication = publication
        self._held_of: Knowledge | None = None
        self.forget_published()

    def forget_published(self) -> None:
        """Make the next estimate anew, as after a change of parameters."""
        # It stays the same until hypotheses are weighed or the state of contact changes.
        self._now: Knowledge | None = None
        self._same: tuple[int, str, float] | None = None
        self._published: tuple[object, ...] = ()

    def published(self, stamp_ns: int, state: int, location: float) -> tuple[object, ...]:
        """
        Return what an estimate publishes where no physics is known.

        stamp_ns, state, location: of the sample [ns], of the contact; x_e nominal [m]
        """
        now, publication = self._posterior.known, self._publication
        same = state, publication.invalid, location
        if now is not self._now or same != self._same:
            self._now, self._same = now, same
            if state == CONTACT:
                publication.model_fit.note(now, stamp_ns)
            self._published = publication.fields(*self.take(state))
        return self._published

    def take(self, state: int) -> tuple[ParameterEstimate, EstimateStatus, str]:
        """Return the estimate in a state of contact, its status, and the reason for that."""
        now = self._posterior.known
        if now is not self._held_of:
            self._held_of = now
            self.held = self._estimate_of(now)
        if state == CONTACT:
            if now.valid:
                return self.held, _ESTIMATING, ''
            return self.held, _FROZEN, LOCATING
        return self.held, _FREE, '' if state == FREE else NEITHER

    def _estimate_of(self, now: Knowledge) -> ParameterEstimate:
        if not now.valid:
            return without_band(self.held)
        low, high, most = self._limits
        return ParameterEstimate(
            min(max(now.stiffness, low), high), min(max(now.damping, 0.0), most),
            *now.published_stds, 0.0, now.inertia)
