# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Randomised worlds without a missing effect, their simulation and their measurement."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi, sqrt
from typing import NamedTuple

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray
from scipy.signal import butter, lfilter

from .experiments import draw_experiment, Stage
from ...parameters import build, flatten
from ...physics.prior import log_uniform, Scales, Values
from ...plant.plant_parameters import PlantParameters, RobotParameters, WallParameters
from ...plant.world import World
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
class RandomWorld:
    """A world in which the spring-damper model is complete."""

    wall: WallParameters  # True K_e, B_e and x_e
    robot: RobotParameters  # True M_t, B_t and K_t
    sensors: SensorModel  # sensors of the recording
    experiment: Experiment  # commanded motion
    depth: float  # planned maximum penetration [m]


def draw_world(rng: Generator) -> RandomWorld:
    """Draw wall, robot, sensors and experiment."""
    wall = WallParameters(
        stiffness=_round(log_uniform(rng, 1200.0, 16000.0)),
        damping=_round(log_uniform(rng, 20.0, 280.0)),
        location=0.0 if _coin(rng, 0.5) else round(float(rng.uniform(-0.03, 0.03)), 6),
    )
    robot = _draw_robot(rng)
    depth = float(np.clip(log_uniform(rng, 45.0, 160.0) / wall.stiffness, 0.006, 0.06))
    stage = Stage(wall.location, wall.location - float(rng.uniform(0.01, 0.025)),
                  depth * (1.0 + wall.stiffness / robot.stiffness))
    return RandomWorld(wall, robot, _draw_sensors(rng), draw_experiment(stage, rng), depth)


def _draw_robot(rng: Generator) -> RobotParameters:
    mass = log_uniform(rng, 9.0, 50.0)
    stiffness = log_uniform(rng, 1200.0, 16000.0)
    damping = 2.0 * rng.uniform(0.8, 1.2) * sqrt(mass * stiffness)
    return RobotParameters(mass=_round(mass), damping=_round(damping), stiffness=_round(stiffness))


def _draw_sensors(rng: Generator) -> SensorModel:
    noise = log_uniform(rng, 0.16, 0.8)
    return SensorModel(
        rate=float(rng.choice([250.0, 500.0, 1000.0], p=[0.07, 0.86, 0.07])),
        force_noise=_round(noise),
        position_noise=_round(log_uniform(rng, 1.5e-6, 6e-6)),
        distribution='uniform' if _coin(rng, 0.2) else 'normal',
        force_step=_round(rng.uniform(0.1, 0.6) * noise) if _coin(rng, 0.4) else 0.0,
        position_step=float(rng.choice([0.0, 1e-6, 2e-6, 5e-6])),
        velocity_noise=None if _coin(rng, 0.25) else _round(log_uniform(rng, 1e-4, 1e-3)),
        low_pass=_round(rng.uniform(100.0, 200.0)) if _coin(rng, 0.25) else 0.0,
        jitter=_round(rng.uniform(1e-5, 5e-5)) if _coin(rng, 0.5) else 0.0,
        joint_phase=round(float(rng.uniform(0.0, 1.0)), 3) if _coin(rng, 0.25) else 0.0,
        dropped=0.003 if _coin(rng, 0.2) else 0.0,
    )


def draw_nominal_wall(wall: WallParameters, rng: Generator, exact: float) -> WallParameters:
    """Draw the wall of the nominal model: K_e off by up to 25 %, B_e by up to 60 %."""
    if _coin(rng, exact):
        return wall
    error_K, error_B = rng.uniform(-0.25, 0.25), rng.uniform(-0.6, 0.6)
    return WallParameters(
        stiffness=_round(wall.stiffness * (1.0 + error_K)),
        damping=_round(wall.damping * (1.0 + error_B)), location=wall.location)


def _coin(rng: Generator, probability: float) -> bool:
    return bool(rng.uniform() < probability)


def _round(value: float) -> float:
    return float(f'{value:.6g}')


Array = NDArray[np.float64]

TRUTH_HZ = 5000.0
"""Rate of the true signals that `measure` samples."""

INTEGRATION_HZ = 10000.0
"""Minimum integration rate of these signals."""


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
        _stamped(t, reference, sensors, rng), float(np.sqrt(np.mean((force - clean) ** 2))),
    )


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


SEARCH_HZ = 2000.0
"""Minimum integration rate while the strength of an effect is searched."""


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


def simulate(
    world: RandomWorld, physics: Values, rate: float, integration_rate: float = SEARCH_HZ
) -> Run:
    """
    Simulate the experiment of a world.

    physics: effect parameters by dotted name, such as coulomb_friction.F_c. Empty: no effect.
    rate: sample rate of the result [Hz]
    integration_rate: minimum integration rate [Hz]
    """
    experiment = world.experiment
    parameters = build(PlantParameters, {
        **flatten(world.wall, 'environment.'), **flatten(world.robot, 'robot.'),
        **{f'physics.{dotted}': value for dotted, value in physics.items()},
        'sample_rate': rate, 'integration_rate': integration_rate,
    })

    def reference(t: float) -> tuple[float, float, float, float]:
        desired = experiment.desired(t)
        return desired.position, desired.velocity, desired.acceleration, 0.0

    plant = World(parameters, experiment.start)
    rows = []
    for k in range(round(experiment.duration * rate) + 1):
        _, x, v, _, force, sensed = plant.truth(reference)
        rows.append((k / rate, x, v, force, sensed, *reference(k / rate)[:3]))
        plant.advance((k + 1) / rate - plant.t, reference)
    return Run(*np.array(rows).T)


def scales_of(world: RandomWorld, run: Run) -> Scales:
    """Compute the characteristic magnitudes of a world."""
    robot, touching = world.robot, run.force < 0.0
    return Scales(
        depth=float(np.max(run.x - world.wall.location)),
        speed=float(np.percentile(np.abs(run.v[touching]), 98)) if touching.any() else 1e-3,
        force=float(-np.min(run.force)), control=float(np.max(np.abs(run.control(robot)))),
        greatest_pull=0.0, duration=float(run.t[-1]), stiffness=world.wall.stiffness,
        damping=world.wall.damping, mass=robot.mass,
        sample_period=float(run.t[1] - run.t[0]),
    )
