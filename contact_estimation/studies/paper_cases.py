# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The cases of the table, sections 4 and 5 of the paper: each runs with a seed to its errors."""

from dataclasses import dataclass, field
from math import nan
import sys
from typing import Any, Mapping, NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray

from .testbed_arm import B_E, K_E, TESTBED
from .testbed_world import (
    Acquisition, identify_arm, PaperAcquisition, RawAcquisition, record_testbed, run_testbed)
from ..estimators import OFFLINE_ESTIMATORS
from ..estimators.estimate import Estimate
from ..estimators.offline_estimator import OfflineEstimate, TargetImpedance
from ..parameters import build
from ..pipeline.parameters import EstimationParameters
from ..pipeline.session import ContactSession
from ..plant.closed_loop import ClosedLoopRun, run_closed_loop
from ..plant.plant_parameters import PAPER_NOISE, PlantParameters
from ..plant.simulation import run_open_loop
from ..plant.world import Truth
from ..reference.experiment import Excitation, Experiment, PseudoRandomBinary, Sine
from ..reference.experiments import DESIRED_FORCE, FORCE_EXCITATION, manoeuvre
from ..reference.setpoints import Reference
from ..signals.contact_sample import ContactRecording

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

STEP = 'step'
"""The law of off-line cases: x_r steps from x_e to the depth of 50 N."""

LONG_HOLD_S = 12.0

_AS_THE_PAPER = {  # equations alone: one wall at a known place, and forces without outliers
    'tracking.restarts': False, 'conditioning.outlier_threshold': 0.0,
    'environment.location_std': 0.0,
}
_STEP_RUN_S, _STEP_AT_S = 4.5, 0.5
_TESTBED_RUNS = 10  # experiments of each kind in the paper
_TESTBED_LAW = 'series'  # presses with 50 N as the paper's experiments did; eq. (20) does not
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
        """Compare an estimate with the true values; the bounds in [N/m] and [N s/m]."""
        return cls(
            100.0 * (estimate.stiffness / K_E - 1.0), 100.0 * (estimate.damping / B_E - 1.0),
            100.0 * stiffness_bound / K_E, 100.0 * damping_bound / B_E)


@dataclass(frozen=True)
class Case:
    """A case of the table: on the simulated plant, or on the testbed if its name begins so."""

    case: str  # name of the case, such as 'simulation_sine'
    # estimator, law: names of estimator and reference law; 'pass_through' is eq. (1) on x_d with
    # eq. (41) instead of eq. (40), STEP a step response for an off-line estimator
    estimator: str
    law: str = STEP
    variant: str = ''  # suffix of the estimator's name in the table; '' for the default tuning
    excitation: str = 'none'  # 'sine', 'prbs' or 'none'
    # estimation parameters that differ from the defaults
    tuning: Mapping[str, Any] = field(default_factory=dict)
    # plant parameters that differ from the defaults
    plant: Mapping[str, Any] = field(default_factory=dict)
    hold_s: float = 2.0  # duration of the hold at depth [s]
    # on the testbed, whether the data are processed as in the paper and the arm is assumed to
    # have its target impedance; else the data are raw, and the arm is identified first
    as_paper: bool = True

    @property
    def on_testbed(self) -> bool:
        """Whether it runs on the virtual testbed."""
        return self.case.startswith('testbed')

    @property
    def max_runs(self) -> int:
        """Return the greatest number of seeds."""
        return _TESTBED_RUNS if self.on_testbed else sys.maxsize

    def experiment(self) -> Experiment:
        """Build the manoeuvre of an on-line case."""
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
            {'estimator': self.estimator, 'reference_law': self.law, **_AS_THE_PAPER, **steps,
             **self.tuning}))

    def simulate(self, seed: int) -> ClosedLoopRun:
        """Simulate the closed loop of an on-line case."""
        experiment = self.experiment()
        if self.on_testbed:
            return run_testbed(self.session(), experiment, _acquisition(self.as_paper), seed)
        plant = build(PlantParameters, {**PAPER_NOISE, 'seed': seed, **self.plant})
        return run_closed_loop(plant, self.session(), experiment, experiment.duration)

    def estimate(self, seed: int) -> OfflineEstimate:
        """Record the step response of an off-line case, and estimate."""
        arm = TargetImpedance() if self.as_paper else identify_arm(TargetImpedance(), seed)
        recording = (record_testbed_step(seed, self.as_paper) if self.on_testbed
                     else step_recording(seed))
        return OFFLINE_ESTIMATORS[self.estimator](arm).estimate(recording)

    def run(self, seed: int) -> Errors:
        """Run the case with a seed."""
        if self.law == STEP:
            found = self.estimate(seed)
            # That of the refined method is the bound: least squares on its model.
            return Errors.of(found, found.stiffness_std, found.damping_std)
        run = self.simulate(seed)
        last = run.last_contact
        assert last is not None, 'the manoeuvre touches the wall'
        used = [truth for truth in run.truths if truth.force < 0.0]
        return Errors.of(
            run.results[last].estimate, *_bounds(used, with_inertia=self.estimator == 'rls'))


def _step_reference(t: float) -> Reference:
    """Evaluate the reference of the step response at a time [s]."""
    K_t = TargetImpedance().stiffness
    depth = DESIRED_FORCE * (K_t + K_E) / (K_t * K_E)
    return Reference(depth if t >= _STEP_AT_S else 0.0, 0.0, 0.0, 0.0)


def step_recording(seed: int) -> ContactRecording:
    """Record the step response of the simulated plant."""
    target = TargetImpedance()
    plant = build(PlantParameters, {
        **PAPER_NOISE, 'seed': seed, 'robot.mass': target.mass, 'robot.damping': target.damping,
        'robot.stiffness': target.stiffness,
    })
    return run_open_loop(plant, _step_reference, 0.0, _STEP_RUN_S)[1]


def record_testbed_step(seed: int, as_paper: bool) -> ContactRecording:
    """Record the step response of the testbed."""
    return record_testbed(TargetImpedance(), _step_reference, 0.0, _STEP_RUN_S,
                          _acquisition(as_paper), seed).contact


def _acquisition(as_paper: bool) -> Acquisition:
    return PaperAcquisition(TESTBED) if as_paper else RawAcquisition()


def _bounds(used: Sequence[Truth], with_inertia: bool) -> tuple[float, float]:
    """Return sigma (sum phi phi^T)^-1/2 of K_e [N/m] and B_e [N s/m], after Cramer and Rao."""
    columns = [[truth.position, truth.velocity, truth.acceleration] for truth in used]
    phi: NDArray[np.float64] = np.array(columns)[:, : 3 if with_inertia else 2]
    std = np.sqrt(NOISE_VARIANCE * np.diag(np.linalg.inv(phi.T @ phi)))
    return float(std[0]), float(std[1])


# The paper's simulation has no filter, and its estimators never freeze.
_PLAIN = {'conditioning.cutoff_frequency': 0.0, 'excitation.maximum_relative_std': 1e9}
_RLS = {**_PLAIN, 'tuning.rls.maximum_relative_std': 1e9, 'tuning.rls.initial_covariance': 1e5}
_BEST = {'tuning.kalman.location_std': 0.0, 'tuning.kalman.relative_walk': 0.0}
_BEST_ON_TESTBED = {
    **_BEST,
    # Known properties of bearings and sensors, measured beforehand.
    'physics.coulomb_friction.F_c': TESTBED.wall.sliding_friction,
    'contact.position_noise': 1.2e-5,
    # At rest the bearings hold any force up to 6 N: a wall at rest is not informative.
    'tuning.kalman.resting_speed': 0.005,
}
# The arm that mrac drives: mass and damping 1.5 times its controller's initial values.
_UNKNOWN_ARM = {'robot.control': 'force', 'robot.mass': 75.0, 'robot.damping': 300.0}


def _simulated(excitation: str) -> list[Case]:
    case = f'simulation_{excitation}'
    more: dict[str, Any] = {'excitation': excitation}
    arm: dict[str, Any] = {**more, 'plant': _UNKNOWN_ARM}
    return [
        Case(case, 'indirect_adaptive', 'eq20', tuning=_PLAIN, **more),
        Case(case, 'mrac', 'eq20', tuning=_PLAIN, **arm),
        Case(case, 'mrac', 'eq20', ' (eq. 25 alone)',
             tuning={**_PLAIN, 'tuning.mrac.memory_s': 0.0}, **arm),
        Case(case, 'rls', 'pass_through', tuning=_RLS, **more),
        Case(case, BEST, 'eq20', tuning=_BEST, **more)]


def _on_testbed(case: str, excitation: str, hold_s: float = 2.0) -> list[Case]:
    more: dict[str, Any] = {'excitation': excitation, 'hold_s': hold_s}
    return [
        Case(case, 'indirect_adaptive', _TESTBED_LAW, tuning=_PLAIN, **more),
        Case(case, 'rls', 'pass_through', tuning=_RLS, **more),
        Case(case, BEST, _TESTBED_LAW, tuning=_BEST_ON_TESTBED, as_paper=False, **more)]


PRBS_LONG = _on_testbed('testbed_prbs_long', 'prbs', LONG_HOLD_S)
"""Of a figure alone."""

ALL_CASES: list[Case] = [
    *_simulated('sine'), *_simulated('none'),
    Case('simulation_none', 'signal_processing'),
    Case('simulation_none', 'signal_processing_refined'),
    *_simulated('prbs'),
    *_on_testbed('testbed_sine', 'sine'), *_on_testbed('testbed_none', 'none'),
    Case('testbed_none', 'signal_processing'),
    Case('testbed_none', 'signal_processing_refined', as_paper=False),
    *_on_testbed('testbed_prbs', 'prbs'), *_on_testbed('testbed_sine_long', 'sine', LONG_HOLD_S),
]
