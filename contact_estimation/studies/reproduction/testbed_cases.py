# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The cases on the virtual testbed, section 5 of the paper."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Mapping

from .case import BEST, BEST_TUNING, Case, OnlineCase, step_reference, STEP_RUN_S, StepCase
from .simulation_cases import PLAIN, RLS_TUNING
from .testbed_constants import TESTBED
from .testbed_runs import identify_arm, record_testbed, run_testbed
from .testbed_world import Acquisition, PaperAcquisition, RawAcquisition
from ...estimators import OFFLINE_ESTIMATORS
from ...estimators.offline_estimator import OfflineEstimate, TargetImpedance
from ...plant.closed_loop import ClosedLoopRun
from ...signals.contact_sample import ContactRecording

TESTBED_RUNS = 10
"""Number of experiments of each kind in the paper."""

LAW = 'series'
"""It presses with the desired 50 N, as the paper's experiments did; eq. (20) alone does not."""

LONG_HOLD_S = 12.0

_BEST_TESTBED_TUNING = {
    **BEST_TUNING,
    # Known properties of bearings and sensors, measured beforehand.
    'physics.coulomb_friction.F_c': TESTBED.wall.sliding_friction,
    'contact.position_noise': 1.2e-5,
    # At rest the bearings hold any force up to 6 N: a wall at rest is not informative.
    'tuning.kalman.resting_speed': 0.005,
}


@dataclass(frozen=True)
class TestbedCase(OnlineCase):
    """An on-line estimator in the closed loop with the testbed."""

    __test__ = False  # not a test, despite its name
    max_runs: ClassVar[int] = TESTBED_RUNS

    as_paper: bool = True  # whether the data are processed as in the paper, else raw

    def simulate(self, seed: int) -> ClosedLoopRun:
        """Simulate the closed loop; see `OnlineCase.simulate`."""
        return run_testbed(self.session(), self.experiment(), _acquisition(self.as_paper), seed)


@dataclass(frozen=True)
class TestbedStepCase(StepCase):
    """An off-line estimator on a step response of the testbed."""

    __test__ = False  # not a test, despite its name
    max_runs: ClassVar[int] = TESTBED_RUNS

    # whether the data are processed as in the paper and the arm is assumed to have its target
    # impedance; else the data are raw and the arm is identified first
    as_paper: bool = True

    def estimate(self, seed: int) -> OfflineEstimate:
        """Record and estimate; see `StepCase.estimate`."""
        target = TargetImpedance()
        arm = target if self.as_paper else identify_arm(target, seed)
        method = OFFLINE_ESTIMATORS[self.estimator](arm)
        return method.estimate(record_testbed_step(seed, self.as_paper))


def record_testbed_step(seed: int, as_paper: bool) -> ContactRecording:
    """Record the step response of the testbed."""
    acquisition = _acquisition(as_paper)
    target = TargetImpedance()
    return record_testbed(target, step_reference, 0.0, STEP_RUN_S, acquisition, seed).contact


def _acquisition(as_paper: bool) -> Acquisition:
    return PaperAcquisition(TESTBED) if as_paper else RawAcquisition()


def online_cases(case: str, excitation: str, hold_s: float = 2.0) -> list[TestbedCase]:
    """
    Build the on-line cases of one experiment.

    hold_s: duration of the hold at depth [s]
    """
    def online(estimator: str, law: str, tuning: Mapping[str, Any], **more: Any) -> TestbedCase:
        return TestbedCase(case, estimator, law, excitation=excitation, tuning=tuning,
                           hold_s=hold_s, **more)

    return [
        online('indirect_adaptive', LAW, PLAIN),
        online('rls', 'pass_through', RLS_TUNING),
        online(BEST, LAW, _BEST_TESTBED_TUNING, as_paper=False),
    ]


TESTBED_CASES: list[Case] = [
    *online_cases('testbed_sine', 'sine'),
    *online_cases('testbed_none', 'none'),
    TestbedStepCase('testbed_none', 'signal_processing'),
    TestbedStepCase('testbed_none', 'signal_processing_refined', as_paper=False),
    *online_cases('testbed_prbs', 'prbs'),
    *online_cases('testbed_sine_long', 'sine', LONG_HOLD_S),
]
