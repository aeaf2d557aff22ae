# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Runs of the testbed with an estimator or a given reference; identification of the impedance."""

from __future__ import annotations

from typing import Callable, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .testbed_constants import TESTBED
from .testbed_world import Acquisition, make_sensors, RawAcquisition, TestbedWorld
from ..estimators.offline_estimator import TargetImpedance
from ..estimators.signal_processing_refined import SignalProcessingRefined
from ..pipeline.session import ContactSession
from ..plant.closed_loop import ClosedLoopRun
from ..plant.world import Truth
from ..reference.experiment import Experiment
from ..reference.setpoints import Reference
from ..signals.contact_sample import ContactRecording, ContactSample

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
    """Record some seconds along a reference, from a tip position relative to the wall [m]."""
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


FREE_STEP = 0.015
"""
Step of x_r in free flight [m]; the tip reaches 0.1 m/s, as after the step in contact.

Dry friction of the joints acts as damping that depends on the speed, so that the identified B_t
holds in contact only at similar speeds.
"""

_START, _STEP_AT_S, _RUN_S = -0.10, 0.5, 4.5
_UNIT = TargetImpedance(1.0, 0.0, 0.0)


def identify_arm(target: TargetImpedance, seed: int) -> TargetImpedance:
    """
    Identify the impedance from the decay after a step in free flight.

    The step gives w_n and zeta of M xdd + B xd + K (x - x_r) = 0. The scale follows from
    K_t, which the controller realises exactly: at rest neither inertia nor damping acts.
    """
    recording = _free_step(target, seed)
    contact = recording.contact
    # The tip position replaces the force, in mm: with M = 1, B = K = 0 eqs. (17) and (18) give
    # w_n^2 and 2 zeta w_n.
    moved = ContactRecording(
        contact.stamp_ns, contact.position, contact.velocity,
        -1e3 * np.asarray(recording.tip - recording.tip[0]),
    )
    fit = SignalProcessingRefined(_UNIT).estimate(moved)
    mass = target.stiffness / fit.stiffness
    return TargetImpedance(float(mass), float(mass * fit.damping), target.stiffness)


def _free_step(target: TargetImpedance, seed: int) -> ArmRecording:
    def step(t: float) -> Reference:
        return Reference(_START + (FREE_STEP if t >= _STEP_AT_S else 0.0), 0.0, 0.0, 0.0)

    return record_testbed(target, step, _START, _RUN_S, RawAcquisition(), seed)
