# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Closed loop of plant and estimation session without ROS, as fast as possible."""

from dataclasses import dataclass
from math import isnan
from typing import Iterator

import numpy as np

from .plant_parameters import PlantParameters
from .world import Truth, World
from ..estimators.estimate import Estimate
from ..exceptions import ParameterRangeError
from ..pipeline.axes import Result
from ..pipeline.session import ContactSession
from ..reference.experiment import Experiment
from ..reference.setpoints import Reference, ReferenceAt

_BLOCK = 1024


class Sensors:
    """Noise on the sensed force; noise, then quantisation on the position."""

    def __init__(self, parameters: PlantParameters) -> None:
        self.configure(parameters)
        seeds = np.random.SeedSequence(parameters.seed).spawn(3)
        # One stream per signal: switching one noise off does not change the others.
        self._streams = [self._noise(np.random.default_rng(seed)) for seed in seeds]

    def configure(self, parameters: PlantParameters) -> None:
        """Change noise and quantisation while running."""
        self._p = parameters.sensors

    def _noise(self, generator: np.random.Generator) -> Iterator[float]:
        while True:
            uniform = self._p.distribution == 'uniform'
            yield from (generator.uniform(-1.0, 1.0, _BLOCK) if uniform
                        else generator.standard_normal(_BLOCK)).tolist()

    def measure(self, truth: Truth) -> tuple[float, float, float]:
        """Return F_e [N], x [m] and its rate [m/s], NaN where velocity is not published."""
        p = self._p
        force = truth.sensed + p.force_noise * next(self._streams[0])
        position = truth.position + p.position_noise * next(self._streams[1])
        if p.position_quantisation > 0.0:
            position = round(position / p.position_quantisation) * p.position_quantisation
        velocity = truth.velocity + p.velocity_noise * next(self._streams[2])
        return force, position, velocity if p.publish_velocity else float('nan')


@dataclass(frozen=True)
class ClosedLoopRun:
    """
    Result of a run, one entry per sample.

    Attributes
    ----------
    truths : list of Truth
        True states of the world.
    results : list of Result
        Samples, estimates and references.

    """

    truths: list[Truth]
    results: list[Result]

    @property
    def last_contact(self) -> int | None:
        """Index of the last sample with true F_e < 0; None without contact."""
        touching = (k for k in range(len(self.truths) - 1, -1, -1) if self.truths[k].force < 0.0)
        return next(touching, None)

    @property
    def last_estimate(self) -> Estimate:
        """Return the estimate at the last instant of contact; at the end where there is none."""
        last = self.last_contact
        return self.results[-1 if last is None else last].estimate


def extrapolate(since: float, reference: Reference) -> ReferenceAt:
    """Extrapolate a reference, which holds since a time [s], by its parabola."""
    x, v, a, F_r = reference

    def at(t: float) -> tuple[float, float, float, float]:
        tau = t - since
        return x + tau * (v + 0.5 * tau * a), v + tau * a, a, F_r

    return at


def push(force: float) -> ReferenceAt:
    """Hold the control force of a bare arm [N], at rest, until the next one arrives."""
    reference = Reference(0.0, 0.0, 0.0, force)
    return lambda t: reference


def run_closed_loop(
    plant: PlantParameters, session: ContactSession, experiment: Experiment, duration: float
) -> ClosedLoopRun:
    """
    Run an experiment in closed loop.

    The reference computed from sample k is followed from sample k + 1, as over ROS. A bare arm
    (`robot.control` is force) is driven by the control force of the estimator: that of sample k,
    held from sample k to k + 1, as by a servo at the sample rate.

    Parameters
    ----------
    plant : PlantParameters
        Parameters of the simulated world.
    session : ContactSession
        New session.
    experiment : Experiment
        Setpoints over time.
    duration : float
        Simulated time [s].

    Returns
    -------
    run : ClosedLoopRun
        One entry per sample.

    Raises
    ------
    ParameterRangeError
        If the estimator computes no control force for a bare arm.

    """
    bare = plant.robot.control == 'force'
    if bare and isnan(session.pipeline.control_force):
        raise ParameterRangeError(
            'robot.control force needs an estimator that computes a control force: expected mrac, '
            f'got {session.parameters.estimator}; use it, or robot.control impedance')
    period = 1.0 / plant.sample_rate
    period_ns = round(1e9 * period)
    begin = experiment.desired(0.0)
    world, sensors = World(plant, begin.position), Sensors(plant)
    reference = Reference(begin.position, 0.0, 0.0)
    run, pushed = ClosedLoopRun([], []), push(0.0)
    for k in range(round(duration * plant.sample_rate)):
        follow = pushed if bare else extrapolate(k * period, reference)
        truth = world.truth(follow)
        force, position, velocity = sensors.measure(truth)
        session.add_desired((k + 1) * period_ns, experiment.desired((k + 1) * period))
        session.add_motion(k * period_ns, position, velocity)
        (result,) = session.add_wrench(k * period_ns, force)
        run.truths.append(truth)
        run.results.append(result)
        if bare:
            follow = pushed = push(session.pipeline.control_force)
        world.advance(period, follow)
        if result.reference is not None:
            reference = result.reference
    return run
