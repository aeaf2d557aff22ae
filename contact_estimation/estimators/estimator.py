# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Base of the on-line estimators."""

from abc import ABC, abstractmethod
from math import nan
from typing import ClassVar, Mapping, Sequence

from .estimate import Frozen, ParameterEstimate
from .parameters import EnvironmentParameters
from ..parameters import ParameterGroup
from ..reference.setpoints import Reference
from ..signals.relations import Relation, Row, VelocityRelation

TimedRow = tuple[float, Row]

UNKNOWN_DAMPING_S = 1e-2
"""Prior standard deviation of a B_e not excited so far, relative to K_hat [s]."""


class OnlineEstimator(ABC):
    """
    Base of the estimators that run sample by sample.

    A subclass declares its tuning in `Parameters`, the relation that it fits in `relation`, and
    updates `stiffness` and `damping` in `update`, which is called in contact only.

    Parameters
    ----------
    tuning : ParameterGroup
        An instance of the class's `Parameters`.
    environment : EnvironmentParameters
        Initial values and limits.
    sample_period_s : float
        Nominal T [s].

    """

    Parameters: ClassVar[type[ParameterGroup]]
    relation: ClassVar[type[Relation]] = VelocityRelation
    fits_linear_damping: ClassVar[bool] = True
    """Whether the law contains B_e v, with B_e independent of depth."""

    may_restart: ClassVar[bool] = True
    """Whether a sudden change of K_hat does no harm to what the estimator controls."""

    follows_reference: ClassVar[bool] = False
    """Whether `observe` needs the reference that the robot follows."""

    control_force: float = nan
    """Force for a force-controlled robot [N], computed by `observe`; NaN: none."""

    def __init__(
        self, tuning: ParameterGroup, environment: EnvironmentParameters, sample_period_s: float
    ) -> None:
        self.environment = environment
        self.sample_period_s = sample_period_s
        self.configure(tuning)
        self.stiffness = environment.initial_stiffness
        self.damping = environment.initial_damping
        self.reset()

    @abstractmethod
    def configure(self, tuning: ParameterGroup) -> None:
        """
        Set new tuning while running; estimates and covariance stay.

        Parameters
        ----------
        tuning : ParameterGroup
            An instance of the class's `Parameters`.

        """

    def reset(self) -> None:
        """Restart from the initial values."""
        self.start_from(self.environment.initial_stiffness, self.environment.initial_damping)

    @abstractmethod
    def start_from(self, stiffness: float, damping: float) -> None:
        """
        Restart from given values, as after a switch from another estimator.

        Parameters
        ----------
        stiffness : float
            K_hat [N/m].
        damping : float
            B_hat [N s/m].

        """

    def restart(
        self, stiffness: float, damping: float, stiffness_std: float, damping_std: float
    ) -> None:
        """
        Restart from values that are known to some precision, as at a new contact.

        Parameters
        ----------
        stiffness, damping : float
            K_hat [N/m], B_hat [N s/m].
        stiffness_std, damping_std : float
            Their standard deviations, which take the place of those of the tuning where the
            estimator has any.

        """
        self.start_from(stiffness, damping)

    @abstractmethod
    def update(
        self, rows: Sequence[TimedRow], noise_variance: float, frozen: Frozen
    ) -> list[ParameterEstimate]:
        """
        Update the estimate with gated and filtered rows, one after the other.

        Rows come in runs, since a loop inside the estimator takes half the time of a call for
        each; the result must not depend on how the rows are cut into runs.

        Parameters
        ----------
        rows : sequence of tuple
            (dt, row): time since the last sample [s], at most two sample periods, and
            (y, phi_K, phi_B, phi_c, ...) of the class's relation.
        noise_variance : float
            Of the unfiltered force [N^2].
        frozen : Frozen
            Parameters that must not be updated.

        Returns
        -------
        estimates : list of ParameterEstimate
            After each row.

        """

    @abstractmethod
    def current(self) -> ParameterEstimate:
        """Return the present estimate."""

    def observe(  # noqa: B027 - most estimators need nothing here
        self, dt: float, position: float, velocity: float, force: float, reference: Reference
    ) -> None:
        """
        Process a sample in or out of contact; called only where `follows_reference`.

        Parameters
        ----------
        dt : float
            Time since the last sample [s].
        position, velocity, force : float
            x [m], its rate [m/s] and F_e [N].
        reference : Reference
            What the robot follows now.

        """

    @property
    def details(self) -> Mapping[str, float]:
        """Further estimated quantities by name, for the diagnostics."""
        return {}

    @property
    def limitation(self) -> str:
        """Return what these parameters cannot estimate, for a warning; '': nothing known."""
        return ''

    def within_limits(self, stiffness: float, damping: float) -> tuple[float, float]:
        """
        Return a pair of K_hat [N/m] and B_hat [N s/m], clipped to the limits.

        Parameters
        ----------
        stiffness, damping : float
            K_hat [N/m], B_hat [N s/m].

        """
        K_low, K_high, B_high = self.environment.limits
        return min(max(stiffness, K_low), K_high), min(max(damping, 0.0), B_high)
