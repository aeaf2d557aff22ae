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

"""The cases on the virtual testbed, the counterpart of the paper's section 5."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import nan
from typing import Any, Mapping

from .cases import BEST, CASES, OnlineCase
from .testbed_constants import TESTBED
from ..reference.excitation import Excitation, PseudoRandomBinary, Sine
from ..reference.experiment import Experiment
from ..reference.experiments import FORCE_EXCITATION, manoeuvre

TESTBED_RUNS = 10
"""The paper's number of experiments of each kind."""

LAW = 'series'
"""It presses with the wanted 50 N, as the paper's experiments did; eq. (20) alone would not."""

LONG_HOLD_S = 12.0

_BEST_TUNING = {
    'tuning.kalman.location_std': 0.0, 'tuning.kalman.relative_walk': 0.0,
    # What bearings and sensors are known to do, measured beforehand.
    'physics.coulomb_friction.F_c': TESTBED.wall.sliding_friction,
    'contact.position_noise': 1.2e-5,
    # At rest the bearings hold any force up to 6 N, so a wall at rest tells nothing.
    'tuning.kalman.resting_speed': 0.005,
}
_POSITION_EXCITATION: dict[str, Excitation | None] = {
    'sine': Sine(0.002, 20.0),  # eq. (41)
    'prbs': PseudoRandomBinary(0.002),
    'none': None,
}


@dataclass(frozen=True)
class TestbedCase:
    """
    An on-line estimator in the closed loop of the testbed.

    Attributes
    ----------
    case : str
        Name of the case, such as 'testbed_sine'.
    excitation : str
        'sine', 'prbs' or 'none'.
    estimator, law : str
        Names; 'pass_through' is eq. (1) on x_d with eq. (41) instead of eq. (40).
    tuning : mapping
        Parameters that differ from the defaults.
    as_paper : bool
        The data come as the paper processed them; otherwise raw.
    hold_s : float
        Time at depth [s].

    """

    __test__ = False  # not a test, whatever pytest makes of its name

    case: str
    excitation: str
    estimator: str
    law: str
    tuning: Mapping[str, Any] = field(default_factory=dict)
    as_paper: bool = True
    hold_s: float = 2.0

    def experiment(self) -> Experiment:
        """Build the manoeuvre of the case."""
        if self.law == 'pass_through':
            excitation = _POSITION_EXCITATION[self.excitation]
            return manoeuvre(
                self.case, position_excitation=excitation, hold_s=self.hold_s, force=nan
            )
        return manoeuvre(self.case, FORCE_EXCITATION[self.excitation], hold_s=self.hold_s)


@dataclass(frozen=True)
class TestbedStepCase:
    """
    An off-line estimator on a step response of the testbed.

    Attributes
    ----------
    case, estimator : str
        Names.
    as_paper : bool
        The data come as the paper processed them, and the arm counts as what it should be;
        otherwise they are raw, and the arm is identified first.

    """

    __test__ = False  # not a test, whatever pytest makes of its name

    case: str
    estimator: str
    as_paper: bool
    law: str = 'step'


def online_cases(name: str, excitation: str, hold_s: float = 2.0) -> list[TestbedCase]:
    """
    Build the on-line cases of one experiment.

    Parameters
    ----------
    name : str
        Of the case.
    excitation : str
        'sine', 'prbs' or 'none'.
    hold_s : float
        Time at depth [s].

    Returns
    -------
    cases : list of TestbedCase
        The paper's two algorithms as it ran them, and the best one here.

    """
    return [
        TestbedCase(name, excitation, 'indirect_adaptive', LAW, _plain('indirect_adaptive'),
                    hold_s=hold_s),
        TestbedCase(name, excitation, 'rls', 'pass_through', _plain('rls'), hold_s=hold_s),
        TestbedCase(name, excitation, BEST, LAW, _BEST_TUNING, as_paper=False, hold_s=hold_s),
    ]


def _plain(estimator: str) -> Mapping[str, Any]:
    """Take the tuning of the simulated cases: the paper had one for both."""
    return next(
        c.tuning for c in CASES if isinstance(c, OnlineCase) and c.estimator == estimator
    )


TESTBED_CASES: list[TestbedCase | TestbedStepCase] = [
    *online_cases('testbed_sine', 'sine'),
    *online_cases('testbed_none', 'none'),
    TestbedStepCase('testbed_none', 'signal_processing', as_paper=True),
    TestbedStepCase('testbed_none', 'signal_processing_refined', as_paper=False),
    *online_cases('testbed_prbs', 'prbs'),
    *online_cases('testbed_sine_long', 'sine', LONG_HOLD_S),
]
