# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Arm and wall of the testbed, integrated at 2 kHz, its sensors, and runs of it."""

from abc import ABC, abstractmethod
from math import exp, nan
from typing import Callable, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .testbed_arm import (
    FlexibleWallConstants, ImpedanceController, PlanarArm, TESTBED, TestbedConstants, Tip)
from ..estimators.offline_estimator import TargetImpedance
from ..estimators.signal_processing_refined import SignalProcessingRefined
from ..parameters import build
from ..physics.numeric import Array
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


def free_rate(state: WallState, wall: FlexibleWallConstants) -> float:
    """Compute w' of the untouched wall [m/s] from 0 = K_e w + B_e w' + F_c z."""
    friction = wall.sliding_friction * state.friction
    return -(wall.stiffness * state.deflection + friction) / wall.damping


def moved(state: WallState, step: float, wall: FlexibleWallConstants) -> WallState:
    """Compute the state after a change `step` of the deflection [m]."""
    # Dahl's model, dz/dw = (1 - z sgn w') / s, integrated exactly over a step in one direction:
    # friction depends on the travelled distance only and approaches its limit over s.
    if step == 0.0:
        return state
    end = 1.0 if step > 0.0 else -1.0
    left = exp(-abs(step) / wall.presliding)
    return WallState(state.deflection + step, end + (state.friction - end) * left)


def pressing_force(state: WallState, rate: float, wall: FlexibleWallConstants) -> float:
    """Compute K_e w + B_e w' + F(w') z of a tool at a rate [m/s]; < 0: it retreats faster [N]."""
    # Stribeck's curve: F = F_c + (F_s - F_c) exp(-(v / v_s)^2)
    more = wall.static_friction - wall.sliding_friction
    limit = wall.sliding_friction + more * exp(-(rate / wall.stribeck_velocity) ** 2)
    return wall.stiffness * state.deflection + wall.damping * rate + limit * state.friction


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
        self._rates: Array = np.zeros(3)
        self._torques: Array = np.zeros(3)
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
        rate = float(self._arm.jacobian(angles)[0] @ rates)
        return max(0.0, pressing_force(wall, rate, self._p.wall))

    def _tip_acceleration(self, force: float) -> float:
        accelerations = self._arm.accelerations(
            self._angles, self._rates, self._torques, -force)
        x, y = self._arm.jacobian(self._angles)
        return float(x @ accelerations - y @ self._rates**2)

    def _step(self, h: float) -> None:
        """Integrate one step by the midpoint rule."""
        before, accelerations = self._wall, self._arm.accelerations
        force = self._force(self._angles, self._rates, before)
        a = accelerations(self._angles, self._rates, self._torques, -force)
        angles, rates = self._angles + 0.5 * h * self._rates, self._rates + 0.5 * h * a
        force = self._force(angles, rates, self._follow(before, angles, 0.5 * h))
        a = accelerations(angles, rates, self._torques, -force)
        self._angles, self._rates = self._angles + h * rates, self._rates + h * a
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
        """Return force [N], position [m] and velocity [m/s] (or NaN) of F_e and deflection."""


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


class ArmRecording(NamedTuple):
    """Signals of a run without an estimator."""

    truths: list[Truth]  # True state of the wall
    contact: ContactRecording  # force and deflection of the wall after acquisition
    # (N,) x of the tip relative to the wall's surface, from the joint encoders [m]
    tip: NDArray[np.float64]


def run_testbed(
    session: ContactSession, experiment: Experiment, acquisition: Acquisition, seed: int
) -> ClosedLoopRun:
    """Run in closed loop; the reference of sample k is followed from sample k + 1 on."""
    period = 1.0 / TESTBED.sample_rate
    period_ns = round(1e9 * period)
    begin = experiment.desired(0.0).position
    world, sensors = TestbedWorld(TESTBED, TRACKING_TARGET, begin), make_sensors(TESTBED, seed)
    reference, run = Reference(begin, 0.0, 0.0, 0.0), ClosedLoopRun([], [])
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
    def step(t: float) -> Reference:
        return Reference(_START + (FREE_STEP if t >= _STEP_AT_S else 0.0), 0.0, 0.0, 0.0)

    recording = record_testbed(target, step, _START, _RUN_S, RawAcquisition(), seed)
    contact = recording.contact
    # The tip position replaces the force, in mm: with M = 1, B = K = 0 eqs. (17) and (18) give
    # w_n^2 and 2 zeta w_n.
    moved = ContactRecording(
        contact.stamp_ns, contact.position, contact.velocity,
        -1e3 * np.asarray(recording.tip - recording.tip[0]))
    fit = SignalProcessingRefined(_UNIT).estimate(moved)
    mass = target.stiffness / fit.stiffness
    return TargetImpedance(float(mass), float(mass * fit.damping), target.stiffness)
