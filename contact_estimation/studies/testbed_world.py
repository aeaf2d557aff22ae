# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Arm and wall of the testbed, integrated at 2 kHz, its sensors, and runs of it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import replace
from math import exp, nan
from typing import Callable, NamedTuple

import numpy as np

from .testbed_arm import (
    Array, FlexibleWallConstants, ImpedanceController, PlanarArm, TESTBED, TestbedConstants, Tip)
from ..estimators.offline_estimator import TargetImpedance
from ..estimators.signal_processing_refined import SignalProcessingRefined
from ..parameters import build
from ..pipeline.session import ContactSession
from ..plant.closed_loop import ClosedLoopRun, Sensors
from ..plant.plant_parameters import PlantParameters
from ..plant.world import Truth
from ..reference.experiment import Experiment
from ..reference.setpoints import Reference
from ..signals.contact_sample import ContactRecording, ContactSample
from ..signals.filters import ButterworthBank


class WallState(NamedTuple):
    """Deflection [m] and friction as a fraction of its limit, -1 to 1."""

    deflection: float
    friction: float


def friction_limit(rate: float, wall: FlexibleWallConstants) -> float:
    """Compute F_c + (F_s - F_c) exp(-(v / v_s)^2) of the bearings [N], the Stribeck curve."""
    more = wall.static_friction - wall.sliding_friction
    return wall.sliding_friction + more * exp(-(rate / wall.stribeck_velocity) ** 2)


def free_rate(state: WallState, wall: FlexibleWallConstants) -> float:
    """Compute w' of the untouched wall [m/s] from 0 = K_e w + B_e w' + F_c z."""
    friction = wall.sliding_friction * state.friction
    return -(wall.stiffness * state.deflection + friction) / wall.damping


def moved(state: WallState, step: float, wall: FlexibleWallConstants) -> WallState:
    """
    Compute the state after a change of the deflection.

    Dahl's model, dz/dw = (1 - z sgn w') / s, integrated exactly over a step in one direction:
    friction depends on the travelled distance only and approaches its limit over s.

    step: change of the deflection [m]
    """
    if step == 0.0:
        return state
    end = 1.0 if step > 0.0 else -1.0
    left = exp(-abs(step) / wall.presliding)
    return WallState(state.deflection + step, end + (state.friction - end) * left)


def pressing_force(state: WallState, rate: float, wall: FlexibleWallConstants) -> float:
    """Compute K_e w + B_e w' + F(w') z of a tool at a rate [m/s]; < 0: it retreats faster [N]."""
    friction = friction_limit(rate, wall) * state.friction
    return wall.stiffness * state.deflection + wall.damping * rate + friction


_CLOSED = 1e-12  # gap between tool and wall that counts as contact [m]


class TestbedWorld:
    """
    True state of the testbed.

    The deflection of the wall is a state: in contact, tool and wall move together; when the tool
    retreats faster than spring and damper push, the wall follows alone and comes to rest where
    the friction of its bearings balances the spring.

    position: tip position at t = 0, relative to the wall's surface [m]
    """

    __test__ = False  # not a test, despite its name

    def __init__(
        self, constants: TestbedConstants, target: TargetImpedance, position: float
    ) -> None:
        self._p = constants
        self._arm = PlanarArm(constants.arm)
        self._controller = ImpedanceController(constants, target)
        arm = constants.arm
        self._angles = self._arm.angles_at(arm.surface_x + position, arm.tip_y, arm.tip_angle)
        self._rates, self._torques = np.zeros(3), np.zeros(3)
        self._wall = WallState(max(0.0, position), 0.0)
        self.t = 0.0

    def tip(self) -> Tip:
        """Return the tip pose from the joint encoders, x relative to the wall's surface."""
        tip = self._arm.tip(self._angles, self._rates)
        return tip._replace(x=tip.x - self._p.arm.surface_x)

    def truth(self) -> Truth:
        """Return the current state of the wall."""
        force = self._force(self._angles, self._rates, self._wall)
        touching = force > 0.0
        rate = self.tip().x_dot if touching else free_rate(self._wall, self._p.wall)
        acceleration = self._tip_acceleration(force) if touching else 0.0
        return Truth(self.t, self._wall.deflection, rate, acceleration, -force, -force)

    def advance(self, duration: float, reference: Reference, force: float) -> None:
        """Compute the torques once from F_e [N], and integrate over a sample period [s]."""
        self._torques = self._controller.torques(self._angles, self._rates, force, reference)
        steps = self._p.steps_per_sample
        for _ in range(steps):
            self._step(duration / steps)
        self.t += duration

    def _force(self, angles: Array, rates: Array, wall: WallState) -> float:
        """Compute the pressing force, 0 out of contact."""
        if self._arm.tip_x(angles) - self._p.arm.surface_x < wall.deflection - _CLOSED:
            return 0.0
        return max(0.0, pressing_force(wall, self._arm.tip_rate(angles, rates), self._p.wall))

    def _accelerations(self, angles: Array, rates: Array, force: float) -> Array:
        return self._arm.accelerations(angles, rates, self._torques, -force)

    def _tip_acceleration(self, force: float) -> float:
        a = self._accelerations(self._angles, self._rates, force)
        return float(self._arm.jacobian(self._angles)[0] @ a
                     + self._arm.bent(self._angles, self._rates)[0])

    def _step(self, h: float) -> None:
        """Integrate one step by the midpoint rule."""
        a, w, before = self._angles, self._rates, self._wall
        b = self._accelerations(a, w, self._force(a, w, before))
        angles, rates = a + 0.5 * h * w, w + 0.5 * h * b
        force = self._force(angles, rates, self._follow(before, angles, 0.5 * h))
        self._angles = a + h * rates
        self._rates = w + h * self._accelerations(angles, rates, force)
        self._wall = self._follow(before, self._angles, h)

    def _follow(self, wall: WallState, angles: Array, h: float) -> WallState:
        """Move the wall by itself, or by the tool where that is further."""
        tool = self._arm.tip_x(angles) - self._p.arm.surface_x
        alone = wall.deflection + h * free_rate(wall, self._p.wall)
        return moved(wall, max(alone, tool) - wall.deflection, self._p.wall)


class Acquisition(ABC):
    """Processing of sensor samples before estimation."""

    @abstractmethod
    def process(self, force: float, position: float) -> tuple[float, float, float]:
        """
        Process one sample.

        force: F_e from the force sensor [N]
        position: deflection of the wall from the potentiometer [m]
        Returns force, position, velocity: input of the estimator [N], [m], [m/s]; NaN without a
        velocity
        """


class RawAcquisition(Acquisition):
    """Raw samples, for estimators that filter and differentiate themselves."""

    def process(self, force: float, position: float) -> tuple[float, float, float]:
        return force, position, nan


class PaperAcquisition(Acquisition):
    """
    The paper's processing, section 5.1.

    All signals are Butterworth-filtered; the velocity is the filtered finite difference of the
    deflection; the static friction is subtracted from the force, whichever way the wall moves.
    """

    def __init__(self, constants: TestbedConstants) -> None:
        self._rate, self._friction = constants.sample_rate, constants.wall.static_friction
        self._filter = ButterworthBank(3, constants.sensing.filter_cutoff, self._rate)
        self._last = nan

    def process(self, force: float, position: float) -> tuple[float, float, float]:
        last = self._last if self._last == self._last else position
        self._last = position
        row = force, position, (position - last) * self._rate
        force, position, velocity = self._filter.take(row)
        return min(0.0, force + self._friction), position, velocity


def make_sensors(constants: TestbedConstants, seed: int) -> Sensors:
    """Build force sensor and potentiometer."""
    sensing = constants.sensing
    return Sensors(build(PlantParameters, {
        'sensors.force_noise': sensing.force_noise,
        'sensors.position_noise': sensing.potentiometer_noise,
        'sensors.position_quantisation': sensing.potentiometer_step,
        'sensors.publish_velocity': False,
        'sensors.distribution': 'uniform',
        'sample_rate': constants.sample_rate,
        'seed': seed,
    }))


TRACKING_TARGET = TargetImpedance(50.0, 1000.0, 5000.0)
"""Target impedance of the time-domain algorithms."""


PERIOD_S = 1.0 / TESTBED.sample_rate
"""Of the controller and of all samples [s]."""


def _run(
    target: TargetImpedance, start: float, duration: float, acquisition: Acquisition, seed: int,
    follow: Callable[[int, ContactSample, Truth, Tip], Reference],
) -> None:
    """Run the testbed from a tip position [m]; `follow` turns samples into references."""
    world, sensors = TestbedWorld(TESTBED, target, start), make_sensors(TESTBED, seed)
    for k in range(round(duration * TESTBED.sample_rate)):
        truth = world.truth()
        measured, deflection, _ = sensors.measure(truth)
        force, position, velocity = acquisition.process(measured, deflection)
        sample = ContactSample(round(1e9 * k * PERIOD_S), position, velocity, force)
        world.advance(PERIOD_S, follow(k, sample, truth, world.tip()), measured)


def run_testbed(
    session: ContactSession, experiment: Experiment, acquisition: Acquisition, seed: int
) -> ClosedLoopRun:
    """
    Run an experiment in closed loop.

    The reference computed from sample k is followed from sample k + 1 on.
    """
    start, run = experiment.desired(0.0).position, ClosedLoopRun([], [])
    following = [Reference(start, 0.0, 0.0, 0.0)]

    def follow(k: int, sample: ContactSample, truth: Truth, tip: Tip) -> Reference:
        desired = experiment.desired((k + 1) * PERIOD_S)
        session.add_desired(round(1e9 * (k + 1) * PERIOD_S), desired)
        session.add_motion(sample.stamp_ns, sample.position, sample.velocity)
        (result,) = session.add_wrench(sample.stamp_ns, sample.force)
        run.truths.append(truth)
        run.results.append(result)
        following.append(result.reference or following[-1])
        return following[-2]

    _run(TRACKING_TARGET, start, experiment.duration, acquisition, seed, follow)
    return run


def record_testbed(
    target: TargetImpedance, reference_at: Callable[[float], Reference], start: float,
    duration: float, acquisition: Acquisition, seed: int,
) -> tuple[ContactRecording, Array]:
    """Record along a reference; return force and deflection of the wall, and x of the tip [m]."""
    samples: list[ContactSample] = []
    tips: list[float] = []

    def follow(k: int, sample: ContactSample, truth: Truth, tip: Tip) -> Reference:
        samples.append(sample)
        tips.append(tip.x)
        return reference_at(k * PERIOD_S)

    _run(target, start, duration, acquisition, seed, follow)
    return ContactRecording.of(samples), np.array(tips)


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
    def step(t: float) -> Reference:
        return Reference(_START + (FREE_STEP if t >= _STEP_AT_S else 0.0), 0.0, 0.0, 0.0)

    contact, tip = record_testbed(target, step, _START, _RUN_S, RawAcquisition(), seed)
    # The tip position replaces the force, in mm: with M = 1, B = K = 0 eqs. (17) and (18) give
    # w_n^2 and 2 zeta w_n.
    fit = SignalProcessingRefined(_UNIT).estimate(replace(contact, force=-1e3 * (tip - tip[0])))
    mass = target.stiffness / fit.stiffness
    return TargetImpedance(float(mass), float(mass * fit.damping), target.stiffness)
