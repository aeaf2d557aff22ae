# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0
"""
The residuals of a model in the channels of a recording: pure functions of both.

Force: measured force less the sensor chain applied to the wall's force for the measured motion.
Motion: innovations of the robot (or of a permanently attached wall) driven by its reference and
the wall's force. A contact effect shows in both channels, a sensor effect in the force alone, a
robot effect in the motion alone; the noise of the two is independent.
"""

from typing import NamedTuple

import numpy as np

from .channel import ROBUST, sum_blocks
from .driven_wall import DrivenWall
from .model import Laws, Model
from .observer import at_touch_down, innovations, innovations_of, run, run_jointed
from .prepared_recording import PreparedRecording
from ...physics.numeric import Array, discretise
from ...physics.robot_law import RobotLaw

_ONE = 2.0  # widths, from which on a smooth sign is one: tanh 2 = 0.96


def residuals(
    recording: PreparedRecording, model: Model, robust: bool = True, briefly: bool = False
) -> Array:
    """Stack the residuals of both channels, less the recording's discount."""
    laws = model.laws()
    if recording.driven_by_force(model):
        memory = _wall_time(recording, model) if briefly else np.inf
        stacked = recording.motion.average(_wall_innovations(recording, model, memory))
    else:
        stacked = _of_channels(recording, model, laws)
    if recording.dropped is not None and not any(e.lets_go for e in laws.contact.effects):
        charge = ROBUST * np.sqrt(sum_blocks(recording.dropped.astype(float), recording.block))
        stacked[:len(charge)] = np.hypot(stacked[:len(charge)], charge)
    if recording.discount is not None:
        stacked = recording.discount.apply(stacked)
    return huber(stacked) if robust and bends(recording, model) else stacked


def bends(recording: PreparedRecording, model: Model) -> bool:
    """Return whether large residuals count linearly."""
    return model.nominal.environment.unilateral or recording.carries_discrepancy


def _of_channels(recording: PreparedRecording, model: Model, laws: Laws) -> Array:
    wall = _at_wall(recording, model, laws)
    parts = [recording.force.average(_force_error(recording, laws, wall))]
    if recording.observed.reference is not None:
        parts.append(recording.motion.average(_robot_innovations(recording, model, laws, wall)))
    return np.concatenate(parts)


def force_residual(recording: PreparedRecording, model: Model) -> Array:
    """Subtract the predicted from the measured force."""
    laws = model.laws()
    return _force_error(recording, laws, _at_wall(recording, model, laws))


def motion_residual(recording: PreparedRecording, model: Model) -> Array | None:
    """Compute the innovations of the motion channel; parameters as `force_residual`."""
    if recording.observed.reference is not None:
        laws = model.laws()
        return _robot_innovations(recording, model, laws, _at_wall(recording, model, laws))
    if recording.driven_by_force(model):
        return _wall_innovations(recording, model)
    return None


def response_to(recording: PreparedRecording, push: Array, model: Model) -> Array | None:
    """Compute the innovations that an unknown force on the robot would leave."""
    if recording.observer is None:
        return None
    robot, o = model.laws().robot, recording.observed
    system = discretise(robot.mass, robot.damping, robot.stiffness, o.h)
    return innovations_of(push, system, recording.observer, o.observer_cutoff, o.h)


def force_explains_motion(recording: PreparedRecording, model: Model) -> bool:
    """Return whether the force that a model lacks is also what its motion lacks."""
    missing = force_residual(recording, model) * recording.use
    response, innovations = response_to(recording, missing, model), motion_residual(
        recording, model)
    if response is None or innovations is None:
        return True
    pushed = recording.motion.average(response)
    motion = recording.motion.average(innovations)
    share = float(pushed @ motion) / max(float(pushed @ pushed), 1e-300)
    left = float(np.sum((motion - share * pushed) ** 2)) / max(float(motion @ motion), 1e-300)
    return left < 0.5 and share > 0.5


class _AtWall(NamedTuple):
    """What the model expects at the wall; shapes (N,)."""

    force: Array  # [N]
    penetration: Array  # [m]
    acceleration: Array  # of what touches it and of the tool [m/s^2]


def _at_wall(recording: PreparedRecording, model: Model, laws: Laws) -> _AtWall:
    """Evaluate the wall's law at the measured motion."""
    # What touches the wall behind a flexible joint depends on that joint.
    ports = ('contact',) if laws.robot.joint is None else ('contact', 'robot')
    return recording.walls.of(
        (model.base_values, model.values_at(*ports)), lambda: _evaluate(recording, laws))


def _evaluate(recording: PreparedRecording, laws: Laws) -> _AtWall:
    o = recording.observed
    x, v, a = laws.at_wall(o)
    force, d = laws.contact.force_and_depth(o.t, x, v, a)
    if recording.dropped is not None:
        force = np.where(recording.dropped, 0.0, force)
    return _AtWall(force, d, a)


def _force_error(recording: PreparedRecording, laws: Laws, wall: _AtWall) -> Array:
    o, force = recording.observed, wall.force
    for effect in laws.chain:
        force = effect.sense_along(o.t, force, wall.acceleration)
    return o.force - force


def _robot_innovations(
    recording: PreparedRecording, model: Model, laws: Laws, wall: _AtWall
) -> Array:
    """Run the robot free under its reference and the wall's force on the measured motion."""
    o, robot, observer = recording.observed, laws.robot, recording.observer
    assert observer is not None
    force = wall.force
    if laws.contact.unilateral:
        force = at_touch_down(force, wall.penetration)
    if robot.joint is not None:
        push = _push(recording, model, robot, wall)
        moved = run_jointed(robot, push, force, float(o.x[0]), o.h)
        return innovations(o.raw_position - moved, observer, o.observer_cutoff, o.h)
    system = discretise(robot.mass, robot.damping, robot.stiffness, o.h)

    def without_wall() -> Array:
        push = _push(recording, model, robot, wall)
        moved = run(system, push, float(o.x[0]), robot.stiffness)
        return innovations(o.raw_position - moved, observer, o.observer_cutoff, o.h)

    held = (model.base_values, model.values_at('contact')) if robot.drags else ()
    alone = recording.robots.of((model.values_at('robot'), held), without_wall)
    return np.asarray(alone - innovations_of(force, system, observer, o.observer_cutoff, o.h))


def _push(recording: PreparedRecording, model: Model, robot: RobotLaw, wall: _AtWall) -> Array:
    """Return the force on the robot beside its own damping and stiffness, and the wall [N]."""
    o = recording.observed
    reference = o.reference_at(robot.reference_delay)
    if robot.is_linear:
        return np.asarray(robot.impedance_force(0.0, 0.0, reference))
    driven = robot.force_along(
        o.t, o.x, o.v, reference, wall.force - robot.mass * o.a,
        _ONE * model.nominal.sign_velocity)
    return np.asarray(driven + robot.damping * o.v + robot.stiffness * o.x)


def _wall_innovations(recording: PreparedRecording, model: Model, memory: float = np.inf) -> Array:
    wall = DrivenWall(model, recording.observed)
    return wall.innovations(
        recording.picard_rounds, recording.force_noise, memory, recording.widening)


def _wall_time(recording: PreparedRecording, model: Model) -> float:
    """Return the time in which the nominal wall springs back [s]."""
    wall = model.nominal.environment
    slowest = recording.observed.observer_cutoff
    return 0.5 / max(slowest, np.sqrt(max(wall.stiffness, 0.0) / wall.inertia))


def huber(values: Array) -> Array:
    """Bend residuals so that their squares are Huber's loss."""
    size = np.abs(values)
    far = size > ROBUST
    if not far.any():
        return values
    bent = values.copy()
    bent[far] = np.sign(values[far]) * np.sqrt(ROBUST * (2.0 * size[far] - ROBUST))
    return bent
