# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The simulated cases, section 4 of the paper."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Mapping

from .case import BEST, BEST_TUNING, Case, OnlineCase, step_reference, STEP_RUN_S, StepCase
from ...estimators import OFFLINE_ESTIMATORS
from ...estimators.offline_estimator import OfflineEstimate, TargetImpedance
from ...parameters.values import build
from ...plant.closed_loop import ClosedLoopRun, run_closed_loop
from ...plant.plant_parameters import PAPER_NOISE, PlantParameters
from ...plant.simulation import run_open_loop
from ...signals.contact_sample import ContactRecording

PLAIN = {'conditioning.cutoff_frequency': 0.0, 'excitation.maximum_relative_std': 1e9}
"""The paper's simulation has no filter, and its estimators never freeze."""

RLS_TUNING = {
    **PLAIN, 'tuning.rls.maximum_relative_std': 1e9, 'tuning.rls.initial_covariance': 1e5,
}

UNKNOWN_ARM = {'robot.control': 'force', 'robot.mass': 75.0, 'robot.damping': 300.0}
"""The arm that mrac drives: mass and damping 1.5 times its controller's initial values."""


@dataclass(frozen=True)
class SimulationCase(OnlineCase):
    """An on-line estimator in the closed loop with the simulated plant."""

    # plant parameters that differ from the defaults
    plant: Mapping[str, Any] = field(default_factory=dict)

    def simulate(self, seed: int) -> ClosedLoopRun:
        """Simulate the closed loop; see `OnlineCase.simulate`."""
        plant = build(PlantParameters, {**PAPER_NOISE, 'seed': seed, **self.plant})
        experiment = self.experiment()
        return run_closed_loop(plant, self.session(), experiment, experiment.duration)


@dataclass(frozen=True)
class SimulationStepCase(StepCase):
    """An off-line estimator on a step response of the simulated plant."""

    def estimate(self, seed: int) -> OfflineEstimate:
        """Record and estimate; see `StepCase.estimate`."""
        method = OFFLINE_ESTIMATORS[self.estimator](TargetImpedance())
        return method.estimate(step_recording(seed))


def step_recording(seed: int) -> ContactRecording:
    """Record the step response of the simulated plant."""
    target = TargetImpedance()
    plant = build(PlantParameters, {
        **PAPER_NOISE, 'seed': seed, 'robot.mass': target.mass, 'robot.damping': target.damping,
        'robot.stiffness': target.stiffness,
    })
    return run_open_loop(plant, step_reference, 0.0, STEP_RUN_S)[1]


def _online(excitation: str) -> list[Case]:
    case = f'simulation_{excitation}'
    mrac: dict[str, Any] = {'excitation': excitation, 'plant': UNKNOWN_ARM}
    return [
        SimulationCase(case, 'indirect_adaptive', 'eq20', excitation=excitation, tuning=PLAIN),
        SimulationCase(case, 'mrac', 'eq20', tuning=PLAIN, **mrac),
        SimulationCase(case, 'mrac', 'eq20', ' (eq. 25 alone)',
                       tuning={**PLAIN, 'tuning.mrac.memory_s': 0.0}, **mrac),
        SimulationCase(case, 'rls', 'pass_through', excitation=excitation, tuning=RLS_TUNING),
        SimulationCase(case, BEST, 'eq20', excitation=excitation, tuning=BEST_TUNING),
    ]


SIMULATION_CASES: list[Case] = [
    *_online('sine'),
    *_online('none'),
    SimulationStepCase('simulation_none', 'signal_processing'),
    SimulationStepCase('simulation_none', 'signal_processing_refined'),
    *_online('prbs'),
]
