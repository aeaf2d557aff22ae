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
