# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Recursive estimation of the Hunt-Crossley contact law F = K d^n + chi d^n v."""

from dataclasses import dataclass
from math import exp, inf, log, nan, sqrt
from typing import Mapping, NamedTuple, Sequence

from .estimate import Frozen, new_tuple, ParameterEstimate
from .estimator import OnlineEstimator, TimedRow
from .three_states import constrain, correct, Covariance, diagonal, State
from ..parameters import parameter, ParameterGroup
from ..signals.relations import Row

_SETTLED = 0.01  # error of the filtered gate below which a nonlinear law holds for the row
_SLOWEST_SHARE = 0.05  # lower limit of 1 + r v
_LOGARITHMIC = 0.2  # relative force error above which the error is logarithmic
_LOWEST_EXPONENT, _HIGHEST_EXPONENT = 0.5, 4.0


@dataclass(frozen=True)
class HuntCrossleyParameters(ParameterGroup):
    """Prior and random walk of (ln K, n, chi / K)."""

    exponent: float = parameter(
        1.5, 'Initial value of n: 1 linear, 1.5 two spheres (Hertz)', minimum=0.5, maximum=4.0)
    exponent_std: float = parameter(
        0.5, 'Prior standard deviation of n; 0: known', minimum=0.0, maximum=10.0)
    reference_depth: float = parameter(
        0.01, 'Penetration to which the initial K_hat and B_hat refer', 'm', minimum=1e-7,
        maximum=10.0)
    log_stiffness_std: float = parameter(
        3.0, 'Prior standard deviation of ln K_e at reference_depth; 3: a factor 20', minimum=1e-3,
        maximum=30.0)
    dissipation_std: float = parameter(
        20.0, 'Prior standard deviation of chi / K', 's/m', minimum=1e-6, maximum=1e6)
    relative_walk: float = parameter(
        0.002, 'Random walk of K and chi relative to their values, and of n; larger: follows '
        'changes faster, noisier', '1/sqrt(s)', minimum=0.0)
    depth_memory_s: float = parameter(
        0.5, 'Time constant of the mean penetration at which K_e and B_e are published', 's',
        minimum=1e-3, maximum=1e3)


class Law(NamedTuple):
    """Parameters of the law: K [N/m^n], n and chi [N s/m^(n + 1)], with standard deviations."""

    K: float
    n: float
    chi: float
    K_std: float
    n_std: float
    chi_std: float


class HuntCrossley(OnlineEstimator):
    """
    Extended Kalman filter for F = K d^n + chi d^n v (Hunt and Crossley 1975).

    With r = chi / K and a depth d_0, F = exp(a + n ln(d / d_0)) (1 + r v): the logarithm is
    linear in a and n, and K cannot become negative. The innovation is the relative error of the
    force, or its logarithm while that error is large: an initial value wrong by a factor of 100
    converges, and later the logarithm does not distort the force noise, as it does in the
    two-stage log-linear form of Diolaiti, Melchiorri and Stramigioli (2005).

    The published stiffness and damping give the force of the law through eq. (3) at the mean
    recent penetration d: the secant K_e = K d^(n - 1) and B_e = chi d^n, so that eq. (20) yields
    the correct depth; the tangent stiffness is n K_e. `details` contains the law itself.
    """

    Parameters = HuntCrossleyParameters
    fits_linear_damping = False
    _depth_0 = 0.0  # that _x is written for; 0 before there is one
    _log_depth, _depth_share = 0.0, 1.0  # of the mean penetration, as a multiple of _depth_0
    _x: State  # a, n, r
    _P: Covariance

    def configure(self, tuning: ParameterGroup) -> None:
        """Set new tuning; see `OnlineEstimator.configure`."""
        assert isinstance(tuning, HuntCrossleyParameters)
        self._p = tuning
        self._walk_rate = tuning.relative_walk**2
        if self._depth_0 > 0.0:  # a, moved to the new reference depth
            step = log(tuning.reference_depth / self._depth_0)
            (a, n, r), (aa, an, ar, nn, nr, rr) = self._x, self._P
            self._x = a + step * n, n, r
            self._P = (
                aa + step * (2.0 * an + step * nn), an + step * nn, ar + step * nr, nn, nr, rr)
            self._set_log_depth(self._log_depth - step)
            self._depth_0 = tuning.reference_depth

    def start_from(self, stiffness: float, damping: float) -> None:
        """Restart with the prior; see `OnlineEstimator.start_from`."""
        p = self._p
        d_0 = p.reference_depth
        self.stiffness, self.damping, self._depth_0 = stiffness, damping, d_0
        self._x = log(stiffness * d_0), p.exponent, damping / (stiffness * d_0)
        self._P = diagonal(p.log_stiffness_std, p.exponent_std, p.dissipation_std)
        self._set_log_depth(0.0)
        self._seen_s = 0.0
        self._stiffness_updated = self._damping_updated = False
        self._std = self._spread()

    def restart(
        self, stiffness: float, damping: float, stiffness_std: float, damping_std: float
    ) -> None:
        """Restart at the mean penetration; see `OnlineEstimator.restart`."""
        p, n, ln_d = self._p, self._x[1], self._log_depth
        force = stiffness * self._depth_share * p.reference_depth
        self.stiffness, self.damping = stiffness, damping
        self._x = log(force) - n * ln_d, n, damping / force
        n_std = sqrt(max(self._P[3], 0.0))
        share, r_std = stiffness_std / stiffness, damping_std / force
        if share > 1.0:  # nothing is known: the law of another wall may differ by a factor
            share, n_std, r_std = p.log_stiffness_std, p.exponent_std, p.dissipation_std
            self._seen_s = 0.0
        nn = n_std * n_std  # ln K at the mean penetration is independent of n
        self._P = (share * share + ln_d * ln_d * nn, -ln_d * nn, 0.0, nn, 0.0, r_std * r_std)
        self._std = self._spread()

    def update(
        self, rows: Sequence[TimedRow], noise_variance: float, frozen: Frozen
    ) -> list[ParameterEstimate]:
        """Predict and correct for each row; see `OnlineEstimator.update`."""
        free = (not frozen.stiffness, not frozen.stiffness and self._p.exponent_std > 0.0,
                not frozen.damping)
        estimates = []
        for dt, row in rows:
            if row[1] > 0.0 and abs(row[3] - 1.0) < _SETTLED:
                self._note_depth(dt, row[1])
                self._update(dt, row, noise_variance, free)
                self._publish(frozen)
            estimates.append(self.current())
        return estimates

    def _set_log_depth(self, log_depth: float) -> None:
        self._log_depth, self._depth_share = log_depth, exp(log_depth)

    def _note_depth(self, dt: float, depth: float) -> None:
        seen_s, longest = self._seen_s + dt, self._p.depth_memory_s
        self._seen_s = seen_s = seen_s if seen_s < longest else longest
        share = dt / seen_s if dt < seen_s else 1.0
        mean = self._depth_share
        mean += share * (depth / self._p.reference_depth - mean)
        self._set_log_depth(log(mean if mean > 1e-12 else 1e-12))

    def _update(
        self, dt: float, row: Row, noise_variance: float, free: tuple[bool, bool, bool]
    ) -> None:
        a, n, r = self._x
        aa, an, ar, nn, nr, rr = P = self._walked(dt, free)
        y, depth, v = row[0], row[1], row[2]
        log_depth, factor = log(depth / self._p.reference_depth), 1.0 + r * v
        by_r = v / factor if factor > _SLOWEST_SHARE else 0.0
        exponent = a + n * log_depth
        force = (exp(exponent if exponent < 60.0 else 60.0)
                 * (factor if factor > _SLOWEST_SHARE else _SLOWEST_SHARE))
        spread = (aa + log_depth * (2.0 * an + log_depth * nn)
                  + by_r * (2.0 * (ar + nr * log_depth) + by_r * rr))
        error = y / force - 1.0
        if abs(error) > _LOGARITHMIC or spread > _LOGARITHMIC**2:
            error = log(max(y / force, 1e-3))
        # Mean second-order term of ln(1 + r v): without it, the first rows would have too much
        # weight along a wrong direction.
        bend = 0.5 * rr * by_r ** 2
        variance = max(noise_variance, 1e-18) / force**2 + 2.0 * bend**2
        x, self._P, _ = correct(self._x, P, (1.0, log_depth, by_r), error, variance, free)
        if not _LOWEST_EXPONENT <= x[1] <= _HIGHEST_EXPONENT:
            x = constrain(x, self._P, (0.0, 1.0, 0.0), _LOWEST_EXPONENT, _HIGHEST_EXPONENT)
        self._x = x if not x[2] < 0.0 else constrain(x, self._P, (0.0, 0.0, 1.0), 0.0, inf)

    def _walked(self, dt: float, free: tuple[bool, bool, bool]) -> Covariance:
        """Return the covariance after the random walk over a time."""
        aa, an, ar, nn, nr, rr = self._P
        step, r = self._walk_rate * dt, self._x[2]
        if free[0]:
            aa += step
        if free[1]:
            nn += step
        if free[2]:
            rr += step * r**2 if r > 1.0 else step
        return aa, an, ar, nn, nr, rr

    def _publish(self, frozen: Frozen) -> None:
        """Evaluate the law at the mean penetration."""
        (a, n, r), (K_low, K_high, B_high) = self._x, self.environment.limits
        exponent = a + n * self._log_depth
        force = exp(exponent if exponent < 60.0 else 60.0)
        K, B = force / (self._depth_share * self._p.reference_depth), r * force
        if not (K_low < K < K_high and 0.0 < B < B_high):
            K, B = self.within_limits(K, B)
        self._stiffness_updated |= not frozen.stiffness
        self._damping_updated |= not frozen.damping
        # The parameters of a frozen law stay, but its value changes with the mean penetration.
        if self._stiffness_updated:
            self.stiffness = K
        if self._damping_updated:
            self.damping = B
        self._std = self._spread()

    def _spread(self) -> tuple[float, float]:
        ln_d, r = self._log_depth, self._x[2]
        force = self.stiffness * self._depth_share * self._p.reference_depth
        K_share = _std(self._P, 1.0, ln_d, 0.0)
        return self.stiffness * K_share, force * _std(self._P, r, r * ln_d, 1.0)  # d (r F_s) / F_s

    @property
    def law(self) -> Law:
        """Present estimates of K, n and chi."""
        a, n, r = self._x
        ln_0, P = log(self._p.reference_depth), self._P
        K = exp(a - n * ln_0)
        return Law(
            K, n, r * K, K * _std(P, 1.0, -ln_0, 0.0), sqrt(max(P[3], 0.0)),
            K * _std(P, r, -r * ln_0, 1.0))

    @property
    def details(self) -> Mapping[str, float]:
        """Return the law by name; see `OnlineEstimator.details`."""
        return self.law._asdict()

    def current(self) -> ParameterEstimate:
        """Return the present estimate; see `OnlineEstimator.current`."""
        K_std, B_std = self._std
        return new_tuple(ParameterEstimate, (self.stiffness, self.damping, K_std, B_std, 0.0, nan))


def _std(P: Covariance, a: float, b: float, c: float) -> float:
    """Return the standard deviation of the combination a x_0 + b x_1 + c x_2."""
    aa, ab, ac, bb, bc, cc = P
    variance = (a * (a * aa + 2.0 * (b * ab + c * ac)) + b * (b * bb + 2.0 * c * bc) + c * c * cc)
    return sqrt(variance) if variance > 0.0 else 0.0
