# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""A recording on an even time grid, with its motion smoothed and its noise known."""

from dataclasses import dataclass
from functools import cached_property
from math import sqrt

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from .observer import OBSERVER_CUTOFF, run
from .shares import MUCH
from .signals import check_signals, Signals
from .smoothing import (
    differentiate, lost_by_lines, motion_error, pace_of, quantisation_step, rate_noise,
    slower_by_force, smooth, smooth_enough, STEADY_CUTOFFS_HZ, white_noise_std)
from ...physics.numeric import Array, discretise, Flags, SecondOrder
from ...physics.robot_law import RobotLaw
from ...plant.driven_wall import BETWEEN
from ...plant.plant_parameters import PlantParameters

_START_S = 0.5
_AT_REST = 0.05  # of the greatest speed
_SLOWER = 1.5  # times the sample period


@dataclass(frozen=True, eq=False)
class Observed:
    """A recording on an even grid."""

    t: Array  # (N,) time from the first wrench stamp of the recording [s], evenly spaced
    h: float  # sample period [s]
    force: Array  # (N,) measured F_e [N]; straight lines over dropped samples
    measured: Flags  # (N,) where a force was measured
    raw_position: Array  # (N,) measured x [m]; smoothed at dropped samples
    # x, v, a (N,): smoothed position [m] and its derivatives [m/s], [m/s^2]
    x: Array
    v: Array
    a: Array
    # (4, N) x_r [m], its derivatives, F_r [N], straight between samples; None without a robot
    reference: Array | None
    position_noise: float  # standard deviation [m]
    cutoff: float  # of the smoothing [Hz]
    jitter: float = 0.0  # standard deviation of the stamps of the positions from an even grid [s]
    # course of the force that drives a wall between its samples, see `BETWEEN`
    between: str = 'straight'
    sampled: Flags | None = None  # (N,) where a position was measured; None for nearly everywhere
    # (2, N) standard deviations of x [m] and v [m/s] where they matter, see `motion_error`
    motion_error: Array | None = None
    # (N,) error of the robot's control force by straight lines between the samples of a reference
    # that is slower than the wrenches [N]; None for one that is not
    command_error: Array | None = None
    # (N,) where a drive is held at rest, which does not count; None if that counts too
    held: Flags | None = None

    @cached_property
    def pace(self) -> float:
        """Factor on all times, see `pace_of`."""
        return pace_of(self.h, float(self.t[-1] - self.t[0]))

    @property
    def start(self) -> Flags:
        """Where a free run has not yet forgotten its initial state, shape (N,)."""
        return np.asarray(self.t - self.t[0] < _START_S * self.pace)

    @property
    def starts_moving(self) -> bool:
        """Whether the first sample is not one at rest, as at the end of a gap."""
        speed = np.abs(self.v)
        return bool(self.t[0] > 0.0 or speed[0] > _AT_REST * np.max(speed))

    @property
    def observer_cutoff(self) -> float:
        """Cut-off of the observer that whitens the motion [rad/s]."""
        return OBSERVER_CUTOFF / self.pace

    @cached_property
    def force_range(self) -> float:
        """Range of the force but for its highest and lowest hundredth [N]."""
        low, high = np.percentile(self.force, (1.0, 99.0))
        return float(high - low)

    @cached_property
    def driving(self) -> Array:
        """Force whose straight lines move a wall without a robot, shape (N,) [N]."""
        return BETWEEN[self.between](self.force)

    @cached_property
    def nearest_line(self) -> Array:
        """Map from a force to its slopes over v and x, shape (2, N)."""
        size = np.array([[np.max(np.abs(self.v))], [np.max(np.abs(self.x))], [1.0]])
        columns = np.array([self.v, self.x, np.ones(len(self.t))]) / size
        return np.asarray((np.linalg.solve(columns @ columns.T, columns) / size)[:2])

    def driven_by_force(self, nominal: PlantParameters) -> bool:
        """Return whether there is no robot, but a wall whose mass the measured force moves."""
        wall = nominal.environment
        return self.reference is None and not wall.unilateral and wall.inertia > 0.0

    def has_dynamics(self, nominal: PlantParameters) -> bool:
        """Return whether a model can be run free: from a reference, or a wall from its force."""
        return self.reference is not None or self.driven_by_force(nominal)

    def observer_of(self, nominal: PlantParameters) -> SecondOrder | None:
        """Discretise the nominal robot, which whitens the motion; None without a reference."""
        robot = nominal.robot
        if self.reference is None:
            return None
        return discretise(robot.mass, robot.damping, robot.stiffness, self.h)

    def reference_at(self, delay: float) -> Array:
        """Return the reference as it reaches a robot after a delay."""
        assert self.reference is not None
        if delay == 0.0:
            return self.reference
        return np.array([np.interp(self.t - delay, self.t, row) for row in self.reference])


def observe(
    signals: Signals, model: PlantParameters, carried: Array | None = None,
    between: str = 'straight',
) -> Observed:
    """
    Put a recording on the grid of its wrenches and smooth its motion.

    The motion of the model's robot (or, without one, its wall) under the measured force is
    subtracted before smoothing and added after: it has the sharp bends of impacts, the difference
    has not.
    """
    check_signals(signals)
    t, h = _even_grid(signals.wrench_t)
    force, measured = _on_grid(signals.wrench_t, signals.force, t, h)
    position, sampled = _on_grid(signals.joint_t, signals.position, t, h)
    with_robot = len(signals.reference_t) > 1
    reference = reference_on_grid(signals, model, t) if with_robot else None
    if carried is None:
        carried = _carried(model, reference, force, position, h)
    # From the samples as they came: on the grid they may be means of two. No model follows a
    # motion to better than a hundred thousandth, even without noise.
    left_raw = signals.position - np.interp(signals.joint_t, t, carried)
    noise = max(white_noise_std(left_raw), 1e-5 * float(np.ptp(position)))
    step = quantisation_step(signals.position)
    coarse = step if step / sqrt(12.0) > noise else 0.0
    noise = max(noise, coarse / sqrt(12.0))
    weight = np.where(sampled, 1.0, 1e-3)
    pace = pace_of(h, float(t[-1] - t[0]))
    left, cutoff = smooth_enough(position - carried, weight, h, noise, pace)
    wall = model.environment
    static = not wall.unilateral and wall.inertia == 0.0
    if static and not with_robot:
        felt = wall.damping * rate_noise(noise, cutoff, h)
        slower = slower_by_force(force, np.where(measured, 1.0, 1e-3), h, felt, pace)
        if slower is not None and slower < cutoff:
            left, cutoff = smooth(position, weight, slower * h), slower
            noise = max(noise, float(np.std((position - left)[sampled])))
        elif slower is not None:  # a steady speed needs less bandwidth than its force
            left, cutoff = smooth_enough(position, weight, h, noise, pace, STEADY_CUTOFFS_HZ)
    x, v, a = differentiate(carried + left, h)
    x.flags.writeable = v.flags.writeable = False  # the states of a law along them are kept
    # A straight line over a dropped sample cuts the bend, and innovations would ring from it.
    position = np.where(sampled, position, x)
    return Observed(
        t, h, force, measured, position, x, v, a, reference, noise, cutoff,
        _jitter(signals.joint_t), between, None if np.mean(sampled) > 1.0 - MUCH else sampled,
        motion_error(x, v, h, coarse, cutoff, noise, position - x if static else None),
        _command_error(signals, model, t) if with_robot else None)


def _even_grid(stamps: Array) -> tuple[Array, float]:
    """Return evenly spaced times from the first to the last stamp, and their period [s]."""
    # Step by step: the median of rounded or jittered stamps drifts off by whole samples.
    steps = np.diff(stamps)
    count = int(np.sum(np.round(steps / np.median(steps)))) + 1
    h = float(stamps[-1] - stamps[0]) / (count - 1)
    return np.asarray(stamps[0] + h * np.arange(count), np.float64), h


def _carried(
    model: PlantParameters, reference: Array | None, force: Array, position: Array, h: float
) -> Array:
    """Simulate the nominal robot, or an attached wall, under the measured force."""
    wall, robot = model.environment, model.robot
    if reference is not None:
        law = RobotLaw(robot.mass, robot.damping, robot.stiffness, ())
        push = law.impedance_force(0.0, 0.0, reference) + force
        system = discretise(law.mass, law.damping, law.stiffness, h)
        return run(system, push, float(position[0]), law.stiffness)
    if not wall.unilateral and wall.inertia > 0.0:
        system = discretise(wall.inertia, wall.damping, wall.stiffness, h)
        return run(system, wall.stiffness * wall.location - force, float(position[0]),
                   wall.stiffness)
    return np.zeros(len(position))


def _command_error(signals: Signals, model: PlantParameters, t: Array) -> Array | None:
    periods = np.diff(signals.reference_t)
    ratio = float(np.median(periods)) / (t[1] - t[0])
    if ratio < _SLOWER:
        return None
    robot = model.robot
    law = RobotLaw(robot.mass, robot.damping, robot.stiffness, ())
    lost = lost_by_lines(law.impedance_force(0.0, 0.0, signals.reference))
    # It is the same sign between two samples of the reference.
    return np.asarray(sqrt(ratio) * np.interp(t, signals.reference_t, lost))


def _jitter(stamps: Array) -> float:
    """Measure the deviation of stamps from their neighbours' middle; gaps do not count."""
    deviations = 0.5 * (stamps[2:] + stamps[:-2]) - stamps[1:-1]
    even = np.abs(np.diff(stamps, 2)) < 0.5 * float(np.median(np.diff(stamps)))
    # The middle of two deviates too: the variances 1, 1/4 and 1/4 add up.
    return float(np.std(deviations[even]) / np.sqrt(1.5)) if even.any() else 0.0


def _on_grid(stamps: Array, values: Array, t: Array, h: float) -> tuple[Array, Flags]:
    """Interpolate; return also which grid points have a sample of their own."""
    sampled = np.zeros(len(t), bool)
    index = np.round((stamps - t[0]) / h).astype(int)
    sampled[index[(index >= 0) & (index < len(t))]] = True
    return np.interp(t, stamps, values), sampled


def reference_on_grid(signals: Signals, model: PlantParameters, t: Array) -> Array:
    """Interpolate a reference: straight lines as in a robot, but splines over dropped samples."""
    # The robot has received those; position and velocity are interpolated with recorded rates.
    stamps, values = signals.reference_t, signals.reference
    reference = np.array([np.interp(t, stamps, row) for row in values])
    after = np.clip(np.searchsorted(stamps, t), 1, len(stamps) - 1)
    steps = np.diff(stamps)
    in_gap = steps[after - 1] > 1.5 * np.median(steps)
    for row in (0, 1):
        if in_gap.any() and values[row + 1].any():  # all rates 0: they were not recorded
            bent = CubicHermiteSpline(stamps, values[row], values[row + 1])
            reference[row, in_gap] = bent(t[in_gap])
    if not model.robot.force_tracking:
        reference[3] = 0.0
    return reference
