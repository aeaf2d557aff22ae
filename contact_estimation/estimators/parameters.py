# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Initial values and limits of the environment, and supervision of estimators on rows."""

from dataclasses import dataclass
from functools import cached_property

from ..exceptions import ParameterRangeError
from ..parameters import parameter, ParameterGroup


@dataclass(frozen=True)
class EnvironmentParameters(ParameterGroup):
    """Initial values and limits of the environment."""

    location: float = parameter(
        0.0, 'Surface of the untouched wall, x_e; NaN: it is taken at the first touch', 'm',
        nan_is_off=True)
    location_std: float = parameter(
        0.002,
        'Standard deviation of location. A surface up to 3 of them away is found from the offset '
        'of the force against position where the contact shows it; 0: location is exact',
        'm', minimum=0.0, maximum=1.0)
    initial_stiffness: float = parameter(
        3000.0, 'Initial K_hat; too soft rather than too stiff, or the force overshoots', 'N/m',
        minimum=1e-3, maximum=1e9)
    initial_damping: float = parameter(50.0, 'Initial B_hat', 'N s/m', minimum=0.0, maximum=1e9)
    minimum_stiffness: float = parameter(1.0, 'Lower limit of K_hat', 'N/m', minimum=1e-3)
    maximum_stiffness: float = parameter(1e8, 'Upper limit of K_hat', 'N/m', minimum=1.0)
    maximum_damping: float = parameter(
        1e6, 'Upper limit of B_hat; the lower is 0', 'N s/m', minimum=1.0)

    def __post_init__(self) -> None:
        """Check that the lower limit is below the upper."""
        super().__post_init__()
        if self.minimum_stiffness > self.maximum_stiffness:
            raise ParameterRangeError(
                'environment.minimum_stiffness must be <= environment.maximum_stiffness '
                f'({self.maximum_stiffness:g} N/m), got {self.minimum_stiffness:g}')

    @cached_property
    def limits(self) -> tuple[float, float, float]:
        """Least and greatest K_hat [N/m] and greatest B_hat [N s/m]."""
        return self.minimum_stiffness, self.maximum_stiffness, self.maximum_damping


@dataclass(frozen=True)
class ExcitationParameters(ParameterGroup):
    """When a parameter is frozen for lack of excitation."""

    maximum_relative_std: float = parameter(
        0.2,
        'A parameter is frozen while the last second alone would leave it with a relative '
        'standard deviation above this; large: never frozen',
        minimum=1e-4)


@dataclass(frozen=True)
class TrackingParameters(ParameterGroup):
    """How estimates follow a wall that changes."""

    restarts: bool = parameter(
        True,
        'Reopen the estimate where the wall has changed, and at every new contact, which '
        'starts with K_hat and B_hat as a prior, and follow its surface; false: as the estimator '
        'alone follows, at the configured surface')
    carried_std: float = parameter(
        1.0, 'Standard deviation of K_hat and B_hat, relative to them, at a new contact',
        minimum=1e-3, maximum=100.0)
