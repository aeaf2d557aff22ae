# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Files of a trial: the recording and the nominal model that are handed over, the sealed truth."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any, NamedTuple

from numpy.random import Generator
import yaml

from .trial import Trial
from .world import measure, Measurement
from ...plant.plant_parameters import RobotParameters, WallParameters
from ...recordings import RecordingWriter
from ...recordings.encoding import JointStateEncoder, TrajectoryEncoder, WrenchEncoder

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
    """Simulate a trial, and write recording, nominal model and, last, the truth."""
    world, run = trial.world, trial.simulate(rng)
    measurement = measure(run, world.sensors, rng)
    files.recording.parent.mkdir(parents=True, exist_ok=True)
    files.recording.unlink(missing_ok=True)  # incomplete: the study was interrupted
    _write_recording(files.recording, measurement, world.sensors.velocity_noise is not None,
                     world.robot is not None)
    files.nominal.write_text(nominal_model(trial.nominal, world.robot))
    write_json(files.truth, trial.truth(run, measurement.force_floor))


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
