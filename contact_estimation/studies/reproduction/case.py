# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""A case of the table: an estimator, an experiment and a law, run with a seed to its errors."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from math import nan
import sys
from typing import Any, ClassVar, Mapping, NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray

from ...estimators.estimate import Estimate
from ...estimators.offline_estimator import OfflineEstimate, TargetImpedance
from ...parameters.values import build
from ...pipeline.parameters import EstimationParameters
from ...pipeline.session import ContactSession
from ...plant.closed_loop import ClosedLoopRun
from ...plant.world import Truth
from ...reference.experiment import Excitation, Experiment, PseudoRandomBinary, Sine
from ...reference.experiments import DESIRED_FORCE, FORCE_EXCITATION, manoeuvre
from ...reference.setpoints import Reference


K_E, B_E = 4800.0, 200.0
"""True stiffness [N/m] and damping [N s/m] of the wall."""

NOISE_VARIANCE = 1.0 / 3.0
"""Variance of the uniform force noise of +-1 N [N^2]."""


class PaperError(NamedTuple):
    """Printed |error| at the last instant of contact [%]; in places an upper bound."""

    stiffness: float
    damping: float


PAPER: dict[tuple[str, str], PaperError] = {
    ('simulation_sine', 'indirect_adaptive'): PaperError(0.1, 1.0),
    ('simulation_sine', 'mrac'): PaperError(0.1, 1.0),
    ('simulation_sine', 'rls'): PaperError(1.3, 1.0),
    ('simulation_none', 'signal_processing'): PaperError(13.0, 13.0),
    ('simulation_none', 'indirect_adaptive'): PaperError(2.4, 3.0),
    ('simulation_none', 'mrac'): PaperError(0.1, 0.0),
    ('simulation_none', 'rls'): PaperError(1.7, 2.5),
    ('testbed_sine', 'indirect_adaptive'): PaperError(12.6, 15.7),
    ('testbed_sine', 'rls'): PaperError(3.5, 22.0),
    ('testbed_none', 'signal_processing'): PaperError(37.0, 82.0),
    ('testbed_none', 'indirect_adaptive'): PaperError(8.9, 60.0),
    ('testbed_none', 'rls'): PaperError(19.2, 85.0),
}
"""Printed errors by case and estimator."""


BEST = 'kalman'
"""The best on-line estimator, chosen before any of these runs; x_e is known to it."""

BEST_TUNING = {'tuning.kalman.location_std': 0.0, 'tuning.kalman.relative_walk': 0.0}

AS_THE_PAPER = {
    'tracking.restarts': False, 'conditioning.outlier_threshold': 0.0,
    'environment.location_std': 0.0,
}
"""Equations alone: one wall at a known place, and forces without outliers."""

STEP_RUN_S = 4.5
"""Duration of a step response, with 0.5 s of rest before the step [s]."""

_STEP_AT_S = 0.5
_POSITION_EXCITATION: dict[str, Excitation | None] = {
    'sine': Sine(0.002, 20.0),  # eq. (41)
    'prbs': PseudoRandomBinary(0.002),
    'none': None,
}


class Errors(NamedTuple):
    """
    Signed errors of one run and the Cramer-Rao standard deviations of its data, all in percent.

    The bounds follow from all samples that the estimator used, its model and the known force
    noise; motion and, on the testbed, friction count as known.
    """

    stiffness: float
    damping: float
    stiffness_bound: float
    damping_bound: float

    @classmethod
    def of(
        cls, estimate: Estimate | OfflineEstimate, stiffness_bound: float, damping_bound: float
    ) -> 'Errors':
        """
        Compare an estimate with the true values.

        stiffness_bound, damping_bound: cramer-Rao standard deviations [N/m], [N s/m]
        """
        return cls(
            100.0 * (estimate.stiffness / K_E - 1.0), 100.0 * (estimate.damping / B_E - 1.0),
            100.0 * stiffness_bound / K_E, 100.0 * damping_bound / B_E)


@dataclass(frozen=True)
class Case(ABC):
    """A case of the table."""

    max_runs: ClassVar[int] = sys.maxsize

    case: str  # name of the case, such as 'simulation_sine'
    # estimator, law: names of estimator and reference law; 'pass_through' is eq. (1) on x_d with
    # eq. (41) instead of eq. (40).
    estimator: str
    law: str
    variant: str = ''  # suffix of the estimator's name in the table; '' for the default tuning

    @abstractmethod
    def run(self, seed: int) -> Errors:
        """Run the case."""


@dataclass(frozen=True)
class OnlineCase(Case):
    """An on-line estimator in the closed loop."""

    excitation: str = 'none'  # 'sine', 'prbs' or 'none'
    # estimation parameters that differ from the defaults
    tuning: Mapping[str, Any] = field(default_factory=dict)
    hold_s: float = 2.0  # duration of the hold at depth [s]

    @abstractmethod
    def simulate(self, seed: int) -> ClosedLoopRun:
        """Simulate the closed loop."""

    def experiment(self) -> Experiment:
        """Build the manoeuvre of the case."""
        if self.law == 'pass_through':
            excitation = _POSITION_EXCITATION[self.excitation]
            return manoeuvre(
                self.case, position_excitation=excitation, hold_s=self.hold_s, force=nan)
        return manoeuvre(self.case, FORCE_EXCITATION[self.excitation], hold_s=self.hold_s)

    def session(self) -> ContactSession:
        """Build an estimation session with the tuning of the case."""
        # The paper's x_d has steps, which no limit of the velocity may round.
        steps = {'reference.maximum_velocity': 1e3} if self.law == 'pass_through' else {}
        return ContactSession(build(
            EstimationParameters,
            {'estimator': self.estimator, 'reference_law': self.law, **AS_THE_PAPER, **steps,
             **self.tuning}))

    def run(self, seed: int) -> Errors:
        """Run the closed loop; see `Case.run`."""
        run = self.simulate(seed)
        last = run.last_contact
        assert last is not None, 'the manoeuvre touches the wall'
        used = [truth for truth in run.truths if truth.force < 0.0]
        return Errors.of(
            run.results[last].estimate, *bounds(used, with_inertia=self.estimator == 'rls'))


@dataclass(frozen=True)
class StepCase(Case):
    """An off-line estimator on a step response: x_r from x_e to the depth of 50 N."""

    law: str = 'step'

    @abstractmethod
    def estimate(self, seed: int) -> OfflineEstimate:
        """Record the step response and estimate."""

    def run(self, seed: int) -> Errors:
        """Estimate once; see `Case.run`."""
        estimate = self.estimate(seed)
        # The standard deviation of the refined method is the bound: least squares on its model.
        return Errors.of(estimate, estimate.stiffness_std, estimate.damping_std)


def step_reference(t: float) -> Reference:
    """
    Evaluate the reference of the step response.

    t: time [s]
    """
    K_t = TargetImpedance().stiffness
    depth = DESIRED_FORCE * (K_t + K_E) / (K_t * K_E)
    return Reference(depth if t >= _STEP_AT_S else 0.0, 0.0, 0.0, 0.0)


def bounds(used: Sequence[Truth], with_inertia: bool) -> tuple[float, float]:
    """
    Compute the Cramer-Rao standard deviations of K_e and B_e.

    Returns stiffness, damping: sigma (sum phi phi^T)^-1/2 [N/m], [N s/m]
    """
    columns = [[truth.position, truth.velocity, truth.acceleration] for truth in used]
    phi: NDArray[np.float64] = np.array(columns)[:, : 3 if with_inertia else 2]
    std = np.sqrt(NOISE_VARIANCE * np.diag(np.linalg.inv(phi.T @ phi)))
    return float(std[0]), float(std[1])
