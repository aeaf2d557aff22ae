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

"""One run of one case with one seed, and what its data allow at best."""

from __future__ import annotations

from math import nan
from typing import NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray

from .cases import OnlineCase, StepCase
from ..estimation.parameters import EstimationParameters
from ..estimation.session import ContactSession
from ..estimators import OFFLINE_ESTIMATORS
from ..estimators.offline_estimator import TargetImpedance
from ..parameters.values import build
from ..plant.closed_loop import ClosedLoopRun, run_closed_loop
from ..plant.open_loop import run_open_loop
from ..plant.plant_parameters import PAPER_NOISE, PlantParameters
from ..plant.world import Truth
from ..signals.contact_recording import ContactRecording

K_E, B_E = 4800.0, 200.0
DESIRED_FORCE = 50.0
NOISE_VARIANCE = 1.0 / 3.0
"""Of the uniform noise of +-1 N [N^2]."""

_STEP_AT_S, _STEP_RUN_S = 0.5, 4.5


class Errors(NamedTuple):
    """
    Errors of one run and the Cramer-Rao standard deviations of its data, all in percent.

    The bounds come from all samples that the estimator used, under its model, with the known
    noise.

    """

    stiffness: float
    damping: float
    stiffness_bound: float
    damping_bound: float


def run_case(case: OnlineCase | StepCase, seed: int) -> Errors:
    """
    Run a case.

    Parameters
    ----------
    case : OnlineCase or StepCase
        What to run.
    seed : int
        Of the noise.

    Returns
    -------
    errors : Errors
        At the last instant of contact, signed.

    """
    return run_step(case, seed) if isinstance(case, StepCase) else errors_of(case, seed)


def errors_of(case: OnlineCase, seed: int) -> Errors:
    """Run an on-line case; see `run_case`."""
    run = simulate(case, seed)
    last = run.last_contact
    assert last is not None, 'the manoeuvre touches the wall'
    estimate = run.results[last].estimate
    used = [truth for truth in run.truths if truth.force < 0.0]
    bound_K, bound_B = bounds(used, with_inertia=case.estimator == 'rls')
    return Errors(_percent(estimate.stiffness, K_E), _percent(estimate.damping, B_E),
                  100.0 * bound_K / K_E, 100.0 * bound_B / B_E)


def simulate(case: OnlineCase, seed: int) -> ClosedLoopRun:
    """
    Run the closed loop of a case; parameters as `run_case`.

    Returns
    -------
    run : ClosedLoopRun
        Truth and results of every sample.

    """
    plant = build(PlantParameters, {**PAPER_NOISE, 'seed': seed, **case.plant})
    parameters = build(
        EstimationParameters,
        {'estimator': case.estimator, 'reference_law': case.law, **case.tuning},
    )
    experiment = case.experiment()
    return run_closed_loop(plant, ContactSession(parameters), experiment, experiment.duration)


def bounds(used: Sequence[Truth], with_inertia: bool) -> tuple[float, float]:
    """
    Compute the Cramer-Rao standard deviations of K_e and B_e.

    Parameters
    ----------
    used : sequence of Truth
        Samples in contact; x_e = 0.
    with_inertia : bool
        Whether the model has M_e as a third parameter.

    Returns
    -------
    stiffness, damping : float
        sigma (sum phi phi^T)^-1/2 [N/m], [N s/m].

    """
    columns = [[truth.position, truth.velocity, truth.acceleration] for truth in used]
    phi: NDArray[np.float64] = np.array(columns)[:, : 3 if with_inertia else 2]
    spread = np.sqrt(NOISE_VARIANCE * np.diag(np.linalg.inv(phi.T @ phi)))
    return float(spread[0]), float(spread[1])


def step_recording(seed: int) -> ContactRecording:
    """
    Record the step response of the paper: x_r from x_e to the depth of 50 N.

    Parameters
    ----------
    seed : int
        Of the noise.

    Returns
    -------
    recording : ContactRecording
        With half a second of rest before the step.

    """
    target = TargetImpedance()
    plant = build(PlantParameters, {
        **PAPER_NOISE, 'seed': seed, 'robot.mass': target.mass, 'robot.damping': target.damping,
        'robot.stiffness': target.stiffness,
    })
    depth = DESIRED_FORCE * (target.stiffness + K_E) / (target.stiffness * K_E)

    def step(t: float) -> tuple[float, float, float, float]:
        return (depth if t >= _STEP_AT_S else 0.0), 0.0, 0.0, 0.0

    return run_open_loop(plant, step, 0.0, _STEP_RUN_S)[1]


def run_step(case: StepCase, seed: int) -> Errors:
    """Run an off-line case; see `run_case`."""
    method = OFFLINE_ESTIMATORS[case.estimator](TargetImpedance())
    estimate = method.estimate(step_recording(seed))
    # The refined method's own spread is that of least squares on its model, the bound itself.
    return Errors(
        _percent(estimate.stiffness, K_E), _percent(estimate.damping, B_E),
        _share(estimate.stiffness_std, K_E), _share(estimate.damping_std, B_E),
    )


def _percent(estimate: float, true: float) -> float:
    return 100.0 * (estimate / true - 1.0)


def _share(std: float, true: float) -> float:
    return 100.0 * std / true if std == std else nan
