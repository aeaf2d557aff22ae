# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Runs of the testbed: in closed loop with an estimator, or along a given reference."""

from __future__ import annotations

from typing import Callable, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .testbed_constants import TESTBED
from .testbed_sensors import Acquisition, make_sensors
from .testbed_world import TestbedWorld
from ...estimators.offline_estimator import TargetImpedance
from ...pipeline.session import ContactSession
from ...plant.closed_loop import ClosedLoopRun
from ...plant.world import Truth
from ...reference.experiment import Experiment
from ...reference.setpoints import Reference
from ...signals.contact_sample import ContactRecording, ContactSample

TRACKING_TARGET = TargetImpedance(50.0, 1000.0, 5000.0)
"""Target impedance of the time-domain algorithms."""


class ArmRecording(NamedTuple):
    """Signals of a run without an estimator."""

    truths: list[Truth]  # True state of the wall
    contact: ContactRecording  # force and deflection of the wall after acquisition
    # (N,) x of the tip relative to the wall's surface, from the joint encoders [m]
    tip: NDArray[np.float64]


def run_testbed(
    session: ContactSession, experiment: Experiment, acquisition: Acquisition, seed: int
) -> ClosedLoopRun:
    """
    Run an experiment in closed loop.

    The reference computed from sample k is followed from sample k + 1 on.
    """
    period = 1.0 / TESTBED.sample_rate
    period_ns = round(1e9 * period)
    begin = experiment.desired(0.0)
    world = TestbedWorld(TESTBED, TRACKING_TARGET, begin.position)
    sensors = make_sensors(TESTBED, seed)
    reference = Reference(begin.position, 0.0, 0.0, 0.0)
    run = ClosedLoopRun([], [])
    for k in range(round(experiment.duration * TESTBED.sample_rate)):
        truth = world.truth()
        measured, deflection, _ = sensors.measure(truth)
        force, position, velocity = acquisition.process(measured, deflection)
        session.add_desired((k + 1) * period_ns, experiment.desired((k + 1) * period))
        session.add_motion(k * period_ns, position, velocity)
        (result,) = session.add_wrench(k * period_ns, force)
        run.truths.append(truth)
        run.results.append(result)
        world.advance(period, reference, measured)
        if result.reference is not None:
            reference = result.reference
    return run


def record_testbed(
    target: TargetImpedance, reference_at: Callable[[float], Reference], start: float,
    duration: float, acquisition: Acquisition, seed: int,
) -> ArmRecording:
    """
    Record a run along a given reference.

    reference_at: time [s] to x_r with derivatives
    start: tip position at t = 0, relative to the wall's surface [m]
    duration: duration [s]
    """
    period = 1.0 / TESTBED.sample_rate
    world, sensors = TestbedWorld(TESTBED, target, start), make_sensors(TESTBED, seed)
    truths, samples, tips = [], [], []
    for k in range(round(duration * TESTBED.sample_rate)):
        truth = world.truth()
        measured, deflection, _ = sensors.measure(truth)
        force, position, velocity = acquisition.process(measured, deflection)
        truths.append(truth)
        samples.append(ContactSample(round(1e9 * k * period), position, velocity, force))
        tips.append(world.tip().x)
        world.advance(period, reference_at(k * period), measured)
    return ArmRecording(truths, ContactRecording.of(samples), np.array(tips))
