# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""A trial: a randomised world, one effect or none, a nominal model without it; its files."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from functools import partial
import json
import math
from math import exp, log
import os
from pathlib import Path
from typing import Any, Callable, Iterable, NamedTuple

import numpy as np
from numpy.random import Generator
import yaml

from .concealment import conceal, Concealed, degree, TOLERANCE
from .rig import simulate_rig
from .rig_trial import integration_rate, rig_truth, RigTrial
from .worlds import (
    draw_nominal_wall, draw_world, INTEGRATION_HZ, measure, Measurement, RandomWorld, Run,
    scales_of, SensorModel, simulate, TRUTH_HZ)
from ...physics import EFFECTS
from ...physics.contact_effect import ContactEffect
from ...physics.effect import Need
from ...physics.prior import Strength, Values
from ...plant.plant_parameters import RobotParameters, WallParameters
from ...recordings import RecordingWriter
from ...recordings.encoding import JointStateEncoder, TrajectoryEncoder, WrenchEncoder

MIN_DEGREE, MAX_DEGREE = 1.3, 4.0
"""Range of the degree of concealment, log-uniform."""

EFFECTS_OF_A_WALL = [name for name, cls in EFFECTS.items() if Need.ATTACHMENT not in cls.needs]
"""Effects that the worlds of the trials, in all of which a robot touches a wall, can show."""

_MAX_WORLDS = 25
_NOT_CONCEALABLE_WORLDS = 2  # worlds tried before any strength is accepted
_NOT_CONCEALABLE_STRENGTHS = (0.01, 0.3)  # of effects such as backlash: log-uniform
_MAX_FORCE = 320.0  # more is an impact, not an experiment [N]
_MIN_CONTACT_S = 2.0


@dataclass(frozen=True)
class Trial:
    """Everything drawn for one trial."""

    world: RandomWorld  # True world without the effect
    effect: str  # key of EFFECTS; '' in a clean world
    values: Values  # parameters of the effect
    nominal: WallParameters  # wall of the nominal model
    requested_degree: float  # requested degree of concealment; 1 in a clean world

    @property
    def physics(self) -> Values:
        """Parameters of the effect by dotted name."""
        return {f'{self.effect}.{name}': value for name, value in self.values.items()}

    @property
    def port(self) -> str:
        """Port of the effect."""
        return EFFECTS[self.effect].port

    @property
    def is_exact(self) -> bool:
        """Whether the nominal model equals the true world."""
        return not self.effect and self.nominal == self.world.wall


def draw_trial(effect: str, rng: Generator) -> Trial:
    """Draw a trial."""
    requested = exp(rng.uniform(log(MIN_DEGREE), log(MAX_DEGREE))) if effect else 1.0
    nearest: tuple[float, Trial] | None = None
    not_concealable = 0
    for _ in range(_MAX_WORLDS):
        world = draw_world(rng)
        without = simulate(world, {}, world.sensors.rate)
        if not _is_usable(without):
            continue
        if not effect:
            return Trial(world, '', {}, draw_nominal_wall(world.wall, rng, exact=0.4), requested)
        strength = EFFECTS[effect].draw(scales_of(world, without), rng)
        found = _conceal(effect, strength, world, without, requested)
        not_concealable += found.not_concealable
        if not_concealable == _NOT_CONCEALABLE_WORLDS:
            low, high = _NOT_CONCEALABLE_STRENGTHS
            any_strength = exp(rng.uniform(log(low), log(high)))
            return _trial(world, effect, strength(any_strength), requested, rng)
        deviation = abs(found.degree / requested - 1.0)
        if nearest is None or deviation < nearest[0]:
            nearest = deviation, _trial(world, effect, strength(found.strength), requested, rng)
        if deviation < TOLERANCE:
            break
    assert nearest is not None, 'most worlds are usable'
    return nearest[1]


def _trial(
    world: RandomWorld, effect: str, values: Values, requested: float, rng: Generator
) -> Trial:
    values = {name: float(f'{value:.6g}') for name, value in values.items()}
    nominal = draw_nominal_wall(equivalent_wall(effect, values, world), rng, exact=0.1)
    return Trial(world, effect, values, nominal, requested)


def _conceal(
    effect: str, strength: Strength, world: RandomWorld, without: Run, requested: float
) -> Concealed:
    in_motion, rate = Need.ROBOT in EFFECTS[effect].needs, world.sensors.rate

    def degree_of(s: float) -> float:
        physics = {f'{effect}.{name}': value for name, value in strength(s).items()}
        return degree(in_motion, world, simulate(world, physics, rate), without)

    return conceal(degree_of, requested)


def _is_usable(run: Run) -> bool:
    """Return whether the contact is long enough and free of hard impacts."""
    return run.contact_s > _MIN_CONTACT_S and float(-np.min(run.force)) < _MAX_FORCE


def plan_effects(count: int, seed: int, names: Iterable[str] = EFFECTS_OF_A_WALL) -> list[str]:
    """Distribute trials evenly over effects."""
    effects: list[str] = []
    while len(effects) < count:
        rng = np.random.default_rng([seed, len(effects)])
        effects += rng.permutation(list(names)).tolist()
    return effects[:count]


def equivalent_wall(effect: str, values: Values, world: RandomWorld) -> WallParameters:
    """Return the spring-damper by which a modeller unaware of the effect replaces the wall."""
    wall = world.wall
    made, damping = EFFECTS[effect](**values), wall.damping
    if isinstance(made, ContactEffect) and 'damper' in made.changes:
        damping = made.damper(0.5 * world.depth, 1.0, 1.0, math)  # at half the depth
    return WallParameters(
        stiffness=wall.stiffness, damping=float(f'{damping:.6g}'), location=wall.location)


def ground_truth(trial: Trial, run: Run, force_floor: float) -> dict[str, Any]:
    """Collect the ground truth of a trial; force_floor: RMS of the recorded force noise [N]."""
    world, effect = trial.world, EFFECTS.get(trial.effect)
    effects = [] if effect is None else [
        {'name': trial.effect, 'port': trial.port, 'parameters': dict(trial.values)}]
    clean_verdict = 'consistent' if trial.is_exact else 'recalibrate'
    return {
        'effects': effects,
        'verdict': 'physics_missing' if effects else clean_verdict,
        'stiffness': (
            None if effect and 'spring' in effect.changes else world.wall.stiffness),
        'damping': 0.0 if effect and 'damper' in effect.changes else world.wall.damping,
        'concealed': _degree(trial, run),
        'force_floor_n': force_floor,
        'experiment': world.experiment.name,
        'sensing': asdict(world.sensors),
    }


def _degree(trial: Trial, run: Run) -> float:
    """Compute the degree of concealment of the final simulation."""
    if not trial.effect:
        return 1.0
    world = trial.world
    without = simulate(world, {}, world.sensors.rate)
    in_motion = Need.ROBOT in EFFECTS[trial.effect].needs
    return degree(in_motion, world, _at_sample_rate(trial, run), without)


def _at_sample_rate(trial: Trial, run: Run) -> Run:
    every = round(TRUTH_HZ / trial.world.sensors.rate)
    return Run(*(signal[::every] for signal in run))


_EPOCH_NS = 1_760_000_000_000_000_000
_JOINT = 'contact_axis'
_TRANSPORT_NS = 150_000  # from stamp to log time


class TrialFiles(NamedTuple):
    """Paths of the files of a trial."""

    # recording, nominal: input of the diagnosis
    recording: Path
    nominal: Path
    report: Path  # report of the diagnosis
    truth: Path  # ground truth, in a folder that the diagnosis does not know

    @classmethod
    def of(cls, folder: Path, name: str) -> 'TrialFiles':
        """Return the paths of a trial."""
        inputs = folder / 'handed_over'
        return cls(inputs / f'{name}.mcap', inputs / f'{name}.nominal.yaml',
                   folder / 'reports' / f'{name}.json', folder / 'sealed' / f'{name}.truth.json')


def write_trial(trial: Trial, files: TrialFiles, rng: Generator) -> None:
    """Simulate a trial and write its files."""
    world = trial.world
    run = simulate(world, trial.physics, TRUTH_HZ, INTEGRATION_HZ)
    _write(files, run, world.sensors, nominal_model(trial.nominal, world.robot), True,
           partial(ground_truth, trial, run), rng)


def write_rig_trial(trial: RigTrial, files: TrialFiles, rng: Generator) -> None:
    """Simulate a trial on a rig and write its files; a specimen has no robot and no reference."""
    rig = trial.rig
    run = simulate_rig(rig, trial.make_law(), integration_rate(rig), rng)
    _write(files, run, rig.sensors, nominal_model(trial.nominal, rig.robot),
           rig.robot is not None, partial(rig_truth, trial, run), rng)


def _write(
    files: TrialFiles, run: Run, sensors: SensorModel, nominal: str, with_reference: bool,
    truth_of: Callable[[float], Any], rng: Generator,
) -> None:
    """Measure, and write recording, nominal model and, last, the truth, given the noise floor."""
    measurement = measure(run, sensors, rng)
    files.recording.parent.mkdir(parents=True, exist_ok=True)
    files.recording.unlink(missing_ok=True)  # incomplete: the study was interrupted
    _write_recording(
        files.recording, measurement, sensors.velocity_noise is not None, with_reference)
    files.nominal.write_text(nominal)
    write_json(files.truth, truth_of(measurement.force_floor))


def write_json(path: Path, content: Any) -> None:
    """Write a JSON file atomically."""
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_suffix('.part')
    part.write_text(json.dumps(content, indent=1) + '\n')
    os.replace(part, path)


def nominal_model(wall: WallParameters, robot: RobotParameters | None) -> str:
    """Write the nominal model: the wall as modelled, the true robot."""
    environment = {'stiffness': wall.stiffness, 'damping': wall.damping, 'location': wall.location}
    values: dict[str, Any] = {'environment': environment}
    if not wall.unilateral:
        environment.update(inertia=wall.inertia, unilateral=False)
    if robot is not None:
        values['robot'] = {
            'mass': robot.mass, 'damping': robot.damping, 'stiffness': robot.stiffness}
    return str(yaml.safe_dump({'plant_node': {'ros__parameters': values}}, sort_keys=False))


def _write_recording(
    path: Path, measurement: Measurement, with_velocity: bool, with_reference: bool
) -> None:
    wrench = WrenchEncoder('tool')
    joint = JointStateEncoder('base', _JOINT, with_velocity)
    reference = TrajectoryEncoder('base', _JOINT)
    topics = (
        (measurement.force, '/wrench', 'geometry_msgs/msg/WrenchStamped',
         lambda stamp, force: wrench.encode(stamp, force, 0.0, 0.0)),
        (measurement.joint, '/joint_states', 'sensor_msgs/msg/JointState',
         lambda stamp, motion: joint.encode(stamp, *motion)),
        (measurement.reference, '/reference_trajectory', 'trajectory_msgs/msg/JointTrajectory',
         lambda stamp, r: reference.encode(stamp, r[0], r[1], r[2], 0.0)),
    )
    messages = [
        (_EPOCH_NS + stamp, topic, type_name, encode(_EPOCH_NS + stamp, value))
        for signal, topic, type_name, encode in topics[:3 if with_reference else 2]
        for stamp, value in zip(signal.stamps.tolist(), signal.values.tolist())
    ]
    messages.sort(key=lambda message: message[0])
    with RecordingWriter.file(path) as writer:
        for stamp, topic, type_name, data in messages:
            writer.write(topic, type_name, data, stamp + _TRANSPORT_NS)
