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

"""What every estimator is and gives."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from math import nan
from typing import Callable, ClassVar, Mapping, NamedTuple, Sequence

from ..exceptions import ParameterRangeError
from ..parameters.specification import parameter, ParameterGroup
from ..reference.setpoints import Reference
from ..signals.relations import Relation, Row, VelocityRelation

TimedRow = tuple[float, Row]

UNKNOWN_DAMPING_S = 1e-2
"""Standard deviation of a B_e that no data have shown, as a share of K_hat [s]."""


class EstimateStatus(str, Enum):
    """Whether an estimate moves."""

    FREE = 'free'
    ESTIMATING = 'estimating'
    FROZEN = 'frozen'


class Estimate(NamedTuple):
    """
    What is known of the environment after one sample.

    Attributes
    ----------
    stamp_ns : int
        Stamp of the wrench used [ns].
    stiffness, damping : float
        K_hat [N/m] and B_hat [N s/m].
    stiffness_std, damping_std : float
        Their standard deviations; NaN where the estimator has none.
    location : float
        x_e: estimated where the estimator does so, else as configured [m].
    inertia : float
        M_hat [kg]; NaN where not estimated.
    status : EstimateStatus
        Free, estimating or frozen.
    reason : str
        Why it is frozen, or which parameter is frozen; '' where there is nothing to say.

    """

    stamp_ns: int
    stiffness: float
    damping: float
    stiffness_std: float
    damping_std: float
    location: float
    inertia: float
    status: EstimateStatus
    reason: str


class ParameterEstimate(NamedTuple):
    """
    The numbers of an estimator at one instant; NaN for what it does not estimate.

    Attributes
    ----------
    stiffness, damping : float
        K_hat [N/m], B_hat [N s/m].
    stiffness_std, damping_std : float
        Their standard deviations.
    location_shift : float
        Estimated x_e less the configured one [m]; 0 where not estimated.
    inertia : float
        M_hat [kg].

    """

    stiffness: float
    damping: float
    stiffness_std: float
    damping_std: float
    location_shift: float
    inertia: float


class Frozen(NamedTuple):
    """Which parameters the data cannot tell at present, so that they must not move."""

    stiffness: bool
    damping: bool


@dataclass(frozen=True)
class EnvironmentParameters(ParameterGroup):
    """First guess and limits of the environment."""

    location: float = parameter(0.0, 'Surface of the untouched wall, x_e', 'm')
    initial_stiffness: float = parameter(
        3000.0, 'First guess of K_e; err on the soft side, or the force overshoots', 'N/m',
        minimum=1e-3, maximum=1e9,
    )
    initial_damping: float = parameter(
        50.0, 'First guess of B_e', 'N s/m', minimum=0.0, maximum=1e9
    )
    minimum_stiffness: float = parameter(1.0, 'K_hat stays above', 'N/m', minimum=1e-3)
    maximum_stiffness: float = parameter(1e8, 'K_hat stays below', 'N/m', minimum=1.0)
    maximum_damping: float = parameter(1e6, 'B_hat stays below, and above 0', 'N s/m', minimum=1.0)

    def __post_init__(self) -> None:
        """Check that the limits leave room between them."""
        super().__post_init__()
        if self.minimum_stiffness > self.maximum_stiffness:
            raise ParameterRangeError(
                'environment.minimum_stiffness must be <= environment.maximum_stiffness '
                f'({self.maximum_stiffness:g} N/m), got {self.minimum_stiffness:g}'
            )

    @cached_property
    def limits(self) -> tuple[float, float, float]:
        """Least and greatest K_hat [N/m] and greatest B_hat [N s/m]."""
        return self.minimum_stiffness, self.maximum_stiffness, self.maximum_damping


class OnlineEstimator(ABC):
    """
    Base of the estimators that run sample by sample.

    A subclass declares its tuning in `Parameters`, the relation that it fits in `relation`, and
    moves `stiffness` and `damping` in `update`, which is called in contact only.

    Parameters
    ----------
    tuning : ParameterGroup
        An instance of the class's `Parameters`.
    environment : EnvironmentParameters
        First guess and limits.
    sample_period_s : float
        Nominal T [s].

    """

    Parameters: ClassVar[type[ParameterGroup]]
    relation: ClassVar[type[Relation]] = VelocityRelation
    estimates_location: ClassVar[bool] = False
    biased_by_position_noise: ClassVar[bool] = True
    """Whether noise of phi_B, a differentiated position, makes B_hat too small."""

    fits_linear_damping: ClassVar[bool] = True
    """Whether B_e v, the same at every depth, is what the law contains."""

    follows_reference: ClassVar[bool] = False
    """Whether `observe` needs the reference that the robot follows."""

    control_force: float = nan
    """Force for a robot that is commanded by force [N], made by `observe`; NaN: none."""

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
        Take new tuning while running; estimates and covariance stay.

        Parameters
        ----------
        tuning : ParameterGroup
            An instance of the class's `Parameters`.

        """

    def reset(self) -> None:
        """Go back to the first guess."""
        self.start_from(self.environment.initial_stiffness, self.environment.initial_damping)

    @abstractmethod
    def start_from(self, stiffness: float, damping: float) -> None:
        """
        Begin anew at given values, as after a switch from another estimator.

        Parameters
        ----------
        stiffness : float
            K_hat [N/m].
        damping : float
            B_hat [N s/m].

        """

    @abstractmethod
    def update(
        self, rows: Sequence[TimedRow], noise_variance: float, frozen: Frozen
    ) -> list[ParameterEstimate]:
        """
        Learn from gated and filtered rows, one after the other.

        Rows come in runs, since a loop inside the estimator costs half of a call for each; the
        result must not depend on how the rows are cut into runs.

        Parameters
        ----------
        rows : sequence of tuple
            (dt, row): time since the last sample [s], at most two sample periods, and
            (y, phi_K, phi_B, phi_c, ...) of the class's relation.
        noise_variance : float
            Of the unfiltered force [N^2].
        frozen : Frozen
            Parameters that must not move.

        Returns
        -------
        estimates : list of ParameterEstimate
            What is known after each row.

        """

    @abstractmethod
    def current(self) -> ParameterEstimate:
        """Tell what is known now."""

    def observe(  # noqa: B027 - most estimators need nothing here
        self, dt: float, position: float, velocity: float, force: float, reference: Reference
    ) -> None:
        """
        See every sample, in and out of contact; only where `follows_reference`.

        Parameters
        ----------
        dt : float
            Time since the last sample [s].
        position, velocity, force : float
            x [m], its rate [m/s] and F_e [N].
        reference : Reference
            What the robot follows now.

        """

    def linearisation(self) -> Callable[[Row], Row] | None:
        """
        Tell how to read a row of a law that is not linear; asked at each judgement.

        Returns
        -------
        linear : callable or None
            From a row to one whose y is linear in K_e and B_e as published, and in what the
            further columns stand for, about the present estimate; None where rows are so.

        """
        return None

    @property
    def details(self) -> Mapping[str, float]:
        """What else is known, by names, for the diagnostics."""
        return {}

    @property
    def location_std(self) -> float | None:
        """Prior standard deviation of the wall's location [m]; None where it is not estimated."""
        return None

    def within_limits(self, stiffness: float, damping: float) -> tuple[float, float]:
        """
        Bring a pair back into the limits.

        Parameters
        ----------
        stiffness, damping : float
            K_hat [N/m], B_hat [N s/m].

        Returns
        -------
        stiffness, damping : float
            Within the limits.

        """
        K_low, K_high, B_high = self.environment.limits
        return min(max(stiffness, K_low), K_high), min(max(damping, 0.0), B_high)
