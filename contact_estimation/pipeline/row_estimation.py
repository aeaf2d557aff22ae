# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The estimators of the paper and their kin, on the contact that the posterior has found."""

from math import isfinite, nan, sqrt

from .parameters import EstimationParameters
from .posterior_estimation import LOCATING, NEITHER, without_band
from .surface import Surface
from ..estimators import ESTIMATORS
from ..estimators.estimate import EstimateStatus, Frozen, ParameterEstimate
from ..estimators.estimator import OnlineEstimator
from ..estimators.multiple_model import CONTACT, FREE, WallPosterior
from ..reference.setpoints import Reference
from ..signals.conditioning import OutlierGate
from ..signals.contact_sample import CompensatedSample
from ..signals.filters import ButterworthBank
from ..signals.relations import GatedRows, Row

_FREE, _ESTIMATING, _FROZEN = (
    EstimateStatus.FREE, EstimateStatus.ESTIMATING, EstimateStatus.FROZEN)
_WEAK = 'force within the noise'
_REASONS = {
    Frozen(False, False): '',
    Frozen(False, True): 'damping frozen: weak excitation',
    Frozen(True, False): 'stiffness frozen: weak excitation',
    Frozen(True, True): 'weak excitation',
}
_UNKNOWN_DAMPING_S = 1e-2  # prior of B_e / K_e at a restart [s]
_DIFFERENT = 3.0  # standard deviations from which an estimate is that of another wall
_NEVER = 1e9  # limit of excitation from which nothing is frozen
_ELSEWHERE = 4.0  # the same of a surface, which is looked at with every row


class RowEstimation:
    """
    Rows of an estimator's relation, its updates, and restarts where the wall has changed.

    held: the last estimate, from which the estimator starts
    """

    def __init__(
        self, parameters: EstimationParameters, posterior: WallPosterior, surface: Surface,
        held: ParameterEstimate,
    ) -> None:
        self._p = p = parameters
        self._posterior, self._surface, self.held = posterior, surface, held
        self.estimator: OnlineEstimator = ESTIMATORS[p.estimator](
            getattr(p.tuning, p.estimator), p.environment, 1.0 / p.sample_rate)
        self.estimator.start_from(*self.estimator.within_limits(*held[:2]))
        conditioning = p.conditioning
        self._gate = OutlierGate(conditioning.outlier_threshold, conditioning.outlier_samples)
        self._rows = GatedRows(
            self.estimator.relation, conditioning.cutoff_frequency, p.sample_rate)
        self._rate = ButterworthBank(1, conditioning.cutoff_frequency, p.sample_rate)
        self._last_x = nan
        self._changes = posterior.wall.changes
        self._updated = self._touched = False
        self._shift = 0.0

    def configure(self, parameters: EstimationParameters) -> None:
        """Set new tuning while running; the estimate stays."""
        self._p = parameters
        self.estimator.environment = parameters.environment
        self.estimator.configure(getattr(parameters.tuning, parameters.estimator))

    def restart(self) -> None:
        """Start afresh with the next sample, as after a clock jump."""
        self._rows.restart()
        self._gate.leave()
        self._rate.reset()
        self._last_x = nan

    def observe(
        self, dt: float, x: float, v: float, force: float, reference: Reference
    ) -> None:
        """Let an estimator that follows the reference see the robot, in contact or not."""
        if self.estimator.follows_reference and reference[0] == reference[0]:
            self.estimator.observe(dt, x, self._rate_of(dt, x, v), force, reference)

    def _rate_of(self, dt: float, x: float, v: float) -> float:
        """Return a measured rate [m/s], or that of the filtered differences of the positions."""
        raw = (x - self._last_x) / dt if dt > 0.0 and self._last_x == self._last_x else 0.0
        self._last_x = x
        return self._rate.take((raw,))[0] if v != v else v

    def take(
        self, dt: float, x: float, v: float, pressing: float, known: CompensatedSample | None,
        state: int,
    ) -> tuple[ParameterEstimate, EstimateStatus, str]:
        """
        Process a sample; return the estimate, its status, and the reason for that.

        dt: time since the last sample [s]
        x, v, pressing: position [m], its measured rate (NaN without) [m/s], force [N]
        known: what known physics leave; None without any
        state: of the contact
        """
        contact = self._posterior.contact
        if state != CONTACT or not contact.exceeds_noise(pressing):
            self._rows.leave()
            self._gate.leave()
            self._touched = self._touched and state == CONTACT
            status, reason = _FROZEN, _WEAK
            if state != CONTACT:
                status, reason = _FREE, '' if state == FREE else NEITHER
        else:
            depth = x - self._surface.location
            if depth != depth or known is not None and known.hindrance:
                self.restart()
                return self.held, _FROZEN, LOCATING
            status, reason = self._update(dt, depth, v, pressing - contact.level, known)
        self.held = self._published()
        return self.held, status, reason

    def _update(
        self, dt: float, depth: float, v: float, pressing: float, known: CompensatedSample | None
    ) -> tuple[EstimateStatus, str]:
        """
        Update with a sample in contact.

        depth, pressing: x less the nominal surface [m]; force above that of free flight [N]
        """
        posterior = self._posterior
        if not self._touched:
            self._begin_contact()
        deviation = sqrt(posterior.contact.variance) or 1e-9
        row: Row | None
        if known is None:
            row = self._rows.in_contact(
                dt, depth, v, self._gate.replace(depth, pressing, deviation))
        else:
            rest = self._gate.replace(known.travel, known.rest, deviation)
            row = self._rows.compensated(dt, known._replace(rest=rest))
        if row is None:
            return _FROZEN, 'waiting for consecutive samples'
        self._follow_changes()
        found = self._surface.found_offset
        elsewhere = abs(found - self._shift) > _ELSEWHERE * posterior.known.surface_std
        if elsewhere and self._p.tracking.restarts:
            self._shift = found
        y, f_K, f_B, f_c, f_M = row
        row = y, f_K - self._shift * f_c, f_B, f_c, f_M  # the linear filter passes it unchanged
        frozen = self._frozen()
        if frozen.stiffness and frozen.damping:
            return _FROZEN, _REASONS[frozen]
        longest = 2.0 / self._p.sample_rate  # never integrate over a gap
        (estimate,) = self.estimator.update(
            ((min(dt, longest), row),), posterior.wall.residuals.variance_of(pressing), frozen)
        if not (isfinite(estimate[0]) and isfinite(estimate[1])):
            self.estimator.reset()
            return _FROZEN, 'not finite; reset to the initial values'
        self._updated = True
        return _ESTIMATING, _REASONS[frozen]

    def _begin_contact(self) -> None:
        """Let what was learned in the last contact be a prior: the wall may be another."""
        self._touched = True
        estimator, tracking = self.estimator, self._p.tracking
        linear = estimator.fits_linear_damping  # else an exponent couples depths
        if tracking.restarts and estimator.may_restart and self._updated and linear:
            K, B, share = estimator.stiffness, estimator.damping, tracking.carried_std
            estimator.restart(K, B, share * K, share * max(B, _UNKNOWN_DAMPING_S * K))

    def _follow_changes(self) -> None:
        """Restart at the wall that the posterior has found after a change."""
        posterior = self._posterior
        if posterior.wall.changes != self._changes:
            self._changes = posterior.wall.changes
            now, estimator = posterior.known, self.estimator
            off = abs(estimator.stiffness - now.stiffness)
            if (self._p.tracking.restarts and estimator.may_restart and now.valid
                    and off > _DIFFERENT * now.stiffness_std):
                K, B = estimator.within_limits(now.stiffness, now.damping)
                estimator.restart(K, B, now.stiffness_std, now.damping_std)

    def _frozen(self) -> Frozen:
        """Freeze what the last second could determine only poorly."""
        limit = self._p.excitation.maximum_relative_std
        K_std, B_std = self._posterior.wall.excitation
        return Frozen(min(K_std, _NEVER) > limit, min(B_std, _NEVER) > limit)

    def _published(self) -> ParameterEstimate:
        """Add what the posterior does not know, and where it differs, to the deviations."""
        own, now = self.estimator.current(), self._posterior.known
        if not self._updated:
            return without_band(own)
        if now.stiffness_std != now.stiffness_std:
            return own
        off = own.stiffness - now.stiffness, own.damping - now.damping
        return own._replace(
            stiffness_std=sqrt(own.stiffness_std**2 + now.stiffness_std**2 + off[0] ** 2),
            damping_std=sqrt(own.damping_std**2 + now.damping_std**2 + off[1] ** 2))
