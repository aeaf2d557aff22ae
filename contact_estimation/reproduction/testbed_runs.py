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

"""One run of one case on the testbed with one seed."""

from __future__ import annotations

from .arm_identification import identify_arm
from .runs import bounds, DESIRED_FORCE, Errors
from .testbed_acquisition import PaperAcquisition, RawAcquisition
from .testbed_cases import TestbedCase, TestbedStepCase
from .testbed_constants import TESTBED
from .testbed_running import record_testbed, run_testbed
from ..estimation.parameters import EstimationParameters
from ..estimation.session import ContactSession
from ..estimators import OFFLINE_ESTIMATORS
from ..estimators.offline_estimator import TargetImpedance
from ..parameters.values import build
from ..plant.closed_loop import ClosedLoopRun
from ..reference.setpoints import Reference
from ..signals.contact_recording import ContactRecording

K_E, B_E = TESTBED.wall.stiffness, TESTBED.wall.damping
_STEP_AT_S, _STEP_RUN_S = 0.5, 4.5


def run_testbed_case(case: TestbedCase | TestbedStepCase, seed: int) -> Errors:
    """
    Run a case.

    Parameters
    ----------
    case : TestbedCase or TestbedStepCase
        What to run.
    seed : int
        Of the sensors.

    Returns
    -------
    errors : Errors
        At the last instant of contact, signed. The bounds are those of the force noise alone,
        with motion and friction known.

    """
    return _run_step(case, seed) if isinstance(case, TestbedStepCase) else _run(case, seed)


def simulate_testbed(case: TestbedCase, seed: int) -> ClosedLoopRun:
    """
    Run the closed loop of a case; parameters as `run_testbed_case`.

    Returns
    -------
    run : ClosedLoopRun
        Truth and results of every sample.

    """
    parameters = build(
        EstimationParameters,
        {'estimator': case.estimator, 'reference_law': case.law, **case.tuning},
    )
    acquisition = PaperAcquisition(TESTBED) if case.as_paper else RawAcquisition()
    return run_testbed(ContactSession(parameters), case.experiment(), acquisition, seed)


def _run(case: TestbedCase, seed: int) -> Errors:
    run = simulate_testbed(case, seed)
    last = run.last_contact
    assert last is not None, 'the manoeuvre touches the wall'
    estimate = run.results[last].estimate
    used = [truth for truth in run.truths if truth.force < 0.0]
    bound_K, bound_B = bounds(used, with_inertia=case.estimator == 'rls')
    return Errors(_percent(estimate.stiffness, K_E), _percent(estimate.damping, B_E),
                  100.0 * bound_K / K_E, 100.0 * bound_B / B_E)


def record_step(seed: int, as_paper: bool) -> ContactRecording:
    """
    Record the step response of the testbed: x_r from x_e to the depth of 50 N.

    Parameters
    ----------
    seed : int
        Of the sensors.
    as_paper : bool
        As the paper processed the data; otherwise raw.

    Returns
    -------
    recording : ContactRecording
        With half a second of rest before the step.

    """
    target = TargetImpedance()
    depth = DESIRED_FORCE * (target.stiffness + K_E) / (target.stiffness * K_E)

    def step(t: float) -> Reference:
        return Reference(depth if t >= _STEP_AT_S else 0.0, 0.0, 0.0, 0.0)

    acquisition = PaperAcquisition(TESTBED) if as_paper else RawAcquisition()
    return record_testbed(target, step, 0.0, _STEP_RUN_S, acquisition, seed).contact


def _run_step(case: TestbedStepCase, seed: int) -> Errors:
    target = TargetImpedance()
    arm = target if case.as_paper else identify_arm(target, seed)
    method = OFFLINE_ESTIMATORS[case.estimator](arm)
    estimate = method.estimate(record_step(seed, case.as_paper))
    return Errors(
        _percent(estimate.stiffness, K_E), _percent(estimate.damping, B_E),
        100.0 * estimate.stiffness_std / K_E, 100.0 * estimate.damping_std / B_E,
    )


def _percent(estimate: float, true: float) -> float:
    return 100.0 * (estimate / true - 1.0)
