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

"""The cases of the table: which estimator meets which experiment under which law."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import nan
from typing import Any, Mapping

from ..reference.excitation import Excitation, PseudoRandomBinary, Sine
from ..reference.experiment import Experiment
from ..reference.experiments import FORCE_EXCITATION, manoeuvre

PLAIN = {'conditioning.cutoff_frequency': 0.0, 'excitation.maximum_relative_std': 1e9}
"""The paper's simulation has no filter, and its estimators hold nothing."""

BEST = 'kalman'
"""Named before any of these runs: the best on-line estimator, told that x_e is known."""

UNKNOWN_ARM = {'robot.control': 'force', 'robot.mass': 75.0, 'robot.damping': 300.0}
"""The arm that mrac drives: half as much again of both as its controller first assumes."""

_BEST_TUNING = {'tuning.kalman.location_std': 0.0, 'tuning.kalman.relative_walk': 0.0}
_RLS_TUNING = {
    **PLAIN, 'tuning.rls.maximum_relative_std': 1e9, 'tuning.rls.initial_covariance': 1e5,
}
_POSITION_EXCITATION: dict[str, Excitation | None] = {
    'sine': Sine(0.002, 20.0),  # eq. (41)
    'prbs': PseudoRandomBinary(0.002),
    'none': None,
}


@dataclass(frozen=True)
class OnlineCase:
    """
    An on-line estimator in the closed loop.

    Attributes
    ----------
    case : str
        Name of the case, such as 'simulation_sine'.
    excitation : str
        'sine', 'prbs' or 'none'.
    estimator, law : str
        Names; 'pass_through' is eq. (1) on x_d with eq. (41) instead of eq. (40).
    tuning, plant : mapping
        Parameters of estimation and plant that differ from the defaults.
    variant : str
        Added to the estimator's name in the table; '' for the default tuning.

    """

    case: str
    excitation: str
    estimator: str
    law: str
    tuning: Mapping[str, Any] = field(default_factory=dict)
    plant: Mapping[str, Any] = field(default_factory=dict)
    variant: str = ''

    def experiment(self) -> Experiment:
        """Build the manoeuvre of the case."""
        if self.law == 'pass_through':
            excitation = _POSITION_EXCITATION[self.excitation]
            return manoeuvre(self.case, position_excitation=excitation, force=nan)
        return manoeuvre(self.case, FORCE_EXCITATION[self.excitation])


@dataclass(frozen=True)
class StepCase:
    """
    An off-line estimator on a step response.

    Attributes
    ----------
    case, estimator : str
        Names.

    """

    case: str
    estimator: str
    law: str = 'step'


def _online(excitation: str) -> list[OnlineCase]:
    case = f'simulation_{excitation}'
    return [
        OnlineCase(case, excitation, 'indirect_adaptive', 'eq20', PLAIN),
        OnlineCase(case, excitation, 'mrac', 'eq20', PLAIN, UNKNOWN_ARM),
        OnlineCase(case, excitation, 'mrac', 'eq20', {**PLAIN, 'tuning.mrac.memory_s': 0.0},
                   UNKNOWN_ARM, ' (eq. 25 alone)'),
        OnlineCase(case, excitation, 'rls', 'pass_through', _RLS_TUNING),
        OnlineCase(case, excitation, BEST, 'eq20', _BEST_TUNING),
    ]


CASES: list[OnlineCase | StepCase] = [
    *_online('sine'),
    *_online('none'),
    StepCase('simulation_none', 'signal_processing'),
    StepCase('simulation_none', 'signal_processing_refined'),
    *_online('prbs'),
]
