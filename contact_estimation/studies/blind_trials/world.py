# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""A world in which the nominal model lacks nothing, its true signals and its measurement."""

from dataclasses import dataclass
from math import pi, sqrt
from typing import NamedTuple

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray
from scipy.signal import butter, lfilter

from ...physics.numeric import Array
from ...physics.prior import Scales
from ...plant.plant_parameters import RobotParameters, WallParameters
from ...reference.experiment import Experiment


@dataclass(frozen=True)
class SensorModel:
    """Sampling, noise, quantisation, filtering and timing errors of the recording."""

    rate: float = 500.0  # sample rate of all three signals [Hz]
    # force_noise, position_noise: standard deviations [N], [m]
    force_noise: float = 0.3
    position_noise: float = 3e-6
    distribution: str = 'normal'  # force noise: 'normal' or 'uniform'
    # force_step, position_step: quantisation steps [N], [m]; 0: none
    force_step: float = 0.0
    position_step: float = 1e-6
    velocity_noise: float | None = 3e-4  # standard deviation [m/s]; None: velocity is not recorded
    # cut-off of the force sensor's anti-alias filter [Hz]; the driver subtracts the filter's delay
    # from the stamps. 0: no filter.
    low_pass: float = 0.0
    jitter: float = 0.0  # standard deviation of the stamps [s]
    # delay of the position samples after the force samples, in sample periods
    joint_phase: float = 0.0
    dropped: float = 0.0  # fraction of dropped samples

    @property
    def force_std(self) -> float:
        """Return the standard deviation of force noise and rounding [N]."""
        return sqrt(self.force_noise**2 + self.force_step**2 / 12.0)

    @property
    def position_std(self) -> float:
        """Return the standard deviation of position noise and rounding [m]."""
        return sqrt(self.position_noise**2 + self.position_step**2 / 12.0)


@dataclass(frozen=True)
class Nuisances:
    """Small departures of a laboratory from the ideal world."""

    bias: float = 0.0  # residue of gravity compensation on the force [N]
    cable: float = 0.0  # stiffness of the cable that pulls at the sensor [N/m]
    # hum, hum_frequency: amplitude [N] and frequency [Hz] of mains hum on the force
    hum: float = 0.0
    hum_frequency: float = 0.0
    # colour, colour_corner: standard deviation [N] and corner [Hz] of coloured force noise
    colour: float = 0.0
    colour_corner: float = 0.0
    cubic: float = 0.0  # relative change of the elastic force at the largest depth
    robot_friction: float = 0.0  # friction of the joint [N]


@dataclass(frozen=True)
class World:
    """A world in which the spring-damper model is complete, but for nuisances."""

    stage: str  # kind of experiment
    wall: WallParameters  # True K_e, B_e, x_e and M_e; attached except when pressing
    robot: RobotParameters | None  # True robot; None: the experiment prescribes the position
    sensors: SensorModel  # sensors of the recording
    experiment: Experiment  # commanded or prescribed motion
    depth: float  # planned largest penetration [m]
    nuisances: Nuisances = Nuisances()  # of unknown size to the diagnosis

    @property
    def is_rig(self) -> bool:
        """Whether there are nuisances; else the world is ideal."""
        return self.nuisances != Nuisances()


class Run(NamedTuple):
    """True signals of a world, all of shape (N,)."""

    t: Array  # time, evenly spaced [s]
    # x, v, force: position [m] and velocity [m/s] of the end-effector, and F_e [N]
    x: Array
    v: Array
    force: Array
    sensed: Array  # F_e after the effects at the force sensor [N]
    # x_r, v_r, a_r: reference [m], [m/s], [m/s^2]
    x_r: Array
    v_r: Array
    a_r: Array

    @property
    def contact_s(self) -> float:
        """Return how long the tool presses [s]."""
        return float(np.mean(self.force < 0.0)) * float(self.t[-1])

    def control(self, robot: RobotParameters) -> Array:
        """Return the control force of eq. (1) without F_e [N]."""
        return np.asarray(robot.mass * self.a_r - robot.damping * (self.v - self.v_r)
                          - robot.stiffness * (self.x - self.x_r))


def scales_of(world: World, run: Run, percentile: float = 100.0) -> Scales:
    """Return the orders of magnitude of a world, the force that of a percentile."""
    touching = np.abs(run.force) > 0.0
    force = float(np.percentile(np.abs(run.force), percentile))
    speed = float(np.percentile(np.abs(run.v[touching]), 98)) if touching.any() else 1e-3
    control, mass = 0.0, world.wall.inertia or 1e-3 * force
    if world.robot is not None:
        control, mass = float(np.max(np.abs(run.control(world.robot)))), world.robot.mass
    return Scales(
        depth=float(np.max(run.x - world.wall.location)), speed=max(speed, 1e-9), force=force,
        control=control, greatest_pull=0.0, duration=float(run.t[-1]),
        stiffness=world.wall.stiffness, damping=world.wall.damping, mass=mass,
        sample_period=float(run.t[1] - run.t[0]))


class StampedSignal(NamedTuple):
    """One recorded signal."""

    stamps: NDArray[np.int64]  # (N,) time since the first sample, increasing [ns]
    values: Array  # (N, ...) measured values


class Measurement(NamedTuple):
    """Recorded signals of a world."""

    force: StampedSignal  # F_e [N]
    joint: StampedSignal  # columns x [m] and its rate [m/s]
    reference: StampedSignal  # columns x_r, its rate and acceleration
    force_floor: float  # RMS of the force noise, rounding included [N]


def measure(run: Run, sensors: SensorModel, rng: Generator) -> Measurement:
    """Apply the sensor model to true signals."""
    period = 1.0 / sensors.rate
    # The delay of the filter reaches beyond the last sample: keep two periods clear.
    t: Array = period * np.arange(int((run.t[-1] - 2.0 * period) / period), dtype=float)
    force, clean = _force(run, t, sensors, rng)
    t_joint: Array = t + sensors.joint_phase * period
    x = np.interp(t_joint, run.t, run.x) + sensors.position_noise * rng.standard_normal(len(t))
    v = np.interp(t_joint, run.t, run.v)
    if sensors.velocity_noise is not None:
        v = v + sensors.velocity_noise * rng.standard_normal(len(t))
    motion = np.column_stack((_quantised(x, sensors.position_step), v))
    reference = np.column_stack([np.interp(t, run.t, r) for r in (run.x_r, run.v_r, run.a_r)])
    return Measurement(
        _stamped(t, force, sensors, rng), _stamped(t_joint, motion, sensors, rng),
        _stamped(t, reference, sensors, rng), float(np.sqrt(np.mean((force - clean) ** 2))))


def _force(run: Run, t: Array, sensors: SensorModel, rng: Generator) -> tuple[Array, Array]:
    """Return the measured force and the same without noise and quantisation."""
    sensed, delay = run.sensed, 0.0
    if sensors.low_pass:
        b, a = butter(2, sensors.low_pass, fs=1.0 / float(run.t[1] - run.t[0]))
        sensed = lfilter(b, a, sensed - sensed[0]) + sensed[0]
        delay = sqrt(2.0) / (2.0 * pi * sensors.low_pass)  # group delay at low frequency
    clean = np.interp(t + delay, run.t, sensed)
    noise = rng.standard_normal(len(t))
    if sensors.distribution == 'uniform':
        noise = rng.uniform(-sqrt(3.0), sqrt(3.0), len(t))
    return _quantised(clean + sensors.force_noise * noise, sensors.force_step), clean


def _quantised(values: Array, step: float) -> Array:
    return np.asarray(np.round(values / step) * step) if step else values


def _stamped(t: Array, values: Array, sensors: SensorModel, rng: Generator) -> StampedSignal:
    """Add jitter and drop samples, but never the first and the last."""
    jitter = np.clip(sensors.jitter * rng.standard_normal(len(t)), -0.4 / sensors.rate,
                     0.4 / sensors.rate)
    jitter[0] = 0.0
    kept = rng.uniform(size=len(t)) >= sensors.dropped
    kept[[0, -1]] = True
    stamps = np.round(1e9 * (t + jitter)).astype(np.int64)
    return StampedSignal(stamps[kept], values[kept])
