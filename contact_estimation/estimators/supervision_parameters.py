# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""How the estimators that run on rows are supervised."""

from __future__ import annotations

from dataclasses import dataclass

from ..parameters.specification import parameter, ParameterGroup


@dataclass(frozen=True)
class ExcitationParameters(ParameterGroup):
    """When a parameter is frozen for lack of excitation."""

    maximum_relative_std: float = parameter(
        0.2,
        'A parameter is frozen while the last second alone would leave it with a relative '
        'standard deviation above this; large: never frozen',
        minimum=1e-4,
    )


@dataclass(frozen=True)
class TrackingParameters(ParameterGroup):
    """How estimates follow a wall that changes."""

    restarts: bool = parameter(
        True,
        'Reopen the estimate where the wall has changed, and at every new contact, which '
        'starts with K_hat and B_hat as a prior, and follow its surface; false: as the estimator '
        'alone follows, at the surface as told',
    )
    carried_std: float = parameter(
        1.0, 'Standard deviation of K_hat and B_hat, relative to them, at a new contact',
        minimum=1e-3, maximum=100.0,
    )
