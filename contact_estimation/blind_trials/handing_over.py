# Copyright 2026 contact_estimation authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""The files of a trial: recording and nominal model to hand over, the truth to seal."""

from __future__ import annotations

from dataclasses import asdict
import json
import os
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.random import Generator
import yaml

from .concealment import acting, degree, residual
from .drawing import is_exact, Trial
from .sensing import INTEGRATED_HZ, NOTED_HZ, record, Recorded
from .simulation import Run, simulate
from .unknown import made, UNKNOWN
from ..messages import JointStateEncoder, TrajectoryEncoder, WrenchEncoder
from ..physics import EFFECTS
from ..physics.physics import RobotEffect
from ..recordings import RecordingWriter

_EPOCH_NS = 1_760_000_000_000_000_000
_JOINT = 'contact_axis'
_TRANSPORT_NS = 150_000


class Handed(NamedTuple):
    """
    Where a trial's files are.

    Attributes
    ----------
    recording, nominal : Path
        For the diagnosis.
    report : Path
        What it says.
    truth : Path
        Sealed: in a folder that the diagnosis is never told of.

    """

    recording: Path
    nominal: Path
    report: Path
    truth: Path

    @classmethod
    def of(cls, folder: Path, name: str) -> 'Handed':
        """
        Name the files of a trial.

        Parameters
        ----------
        folder : Path
            Of the study.
        name : str
            Of the trial.

        Returns
        -------
        handed : Handed
            Their paths.

        """
        given = folder / 'handed_over'
        return cls(given / f'{name}.mcap', given / f'{name}.nominal.yaml',
                   folder / 'reports' / f'{name}.json', folder / 'sealed' / f'{name}.truth.json')


def hand_over(trial: Trial, files: Handed, rng: Generator) -> None:
    """
    Simulate a trial finely and write its files; the truth comes last, and complete or not at all.

    Parameters
    ----------
    trial : Trial
        What was drawn.
    files : Handed
        Where to write.
    rng : numpy.random.Generator
        Source of the noise.

    """
    run = simulate(trial.setup, trial.physics, NOTED_HZ, INTEGRATED_HZ)
    recorded = record(run, trial.setup.sensing, rng)
    files.recording.parent.mkdir(parents=True, exist_ok=True)
    files.recording.unlink(missing_ok=True)  # of a study that was stopped amid it
    _write_recording(files.recording, recorded, trial)
    files.nominal.write_text(nominal_model(trial))
    write_json(files.truth, truth_of(trial, run, recorded))


def write_json(path: Path, content: Any) -> None:
    """
    Write a file complete or not at all.

    Parameters
    ----------
    path : Path
        The file.
    content : object
        What JSON can say.

    """
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_suffix('.part')
    part.write_text(json.dumps(content, indent=1) + '\n')
    os.replace(part, path)


def nominal_model(trial: Trial) -> str:
    """
    Write the nominal model: the wall as somebody believes it to be, and the robot as told.

    Parameters
    ----------
    trial : Trial
        What was drawn.

    Returns
    -------
    text : str
        A model file.

    """
    wall, robot = trial.nominal, trial.setup.robot
    values = {
        'environment': {'stiffness': wall.stiffness, 'damping': wall.damping,
                        'location': wall.location},
        'robot': {'mass': robot.mass, 'damping': robot.damping, 'stiffness': robot.stiffness},
    }
    return str(yaml.safe_dump({'plant_node': {'ros__parameters': values}}, sort_keys=False))


def truth_of(trial: Trial, run: Run, recorded: Recorded) -> dict[str, Any]:
    """
    Tell the truth.

    Parameters
    ----------
    trial : Trial
        What was drawn.
    run : Run
        The fine simulation.
    recorded : Recorded
        What the sensors made of it.

    Returns
    -------
    truth : dict
        Of the form of the neighbouring data's truth files, with how well the effect is concealed
        and what the sensors are like.

    """
    setup, cls = trial.setup, EFFECTS.get(trial.effect)
    unknown = None
    if trial.effect in UNKNOWN:
        seen = _as_recorded(trial, run)
        effect = made(trial.effect, trial.values)
        # A robot's own drag is known; its residual shows blows rather than that.
        shown = (np.asarray(effect.drag(seen.v, np)) if isinstance(effect, RobotEffect)
                 else residual(trial.port, setup, seen))
        span = trial.values.get('first', 0.0), trial.values.get('last', np.inf)
        shown = np.where((seen.t >= span[0]) & (seen.t <= span[1]), shown, 0.0)
        unknown = {'name': trial.effect, 'port': trial.port, 'parameters': dict(trial.values),
                   'intervals_s': acting(shown, seen.t)}
    effects = [] if cls is None else [
        {'name': trial.effect, 'port': cls.port, 'parameters': dict(trial.values)}]
    replaced = [getattr(cls, f'replaces_{name}', False) for name in ('stiffness', 'damping')]
    verdict = 'consistent' if is_exact(trial) else 'recalibrate'
    return {
        'effects': effects,
        'unknown': unknown,
        'verdict': ('physics_missing' if effects else 'unexplained' if unknown else verdict),
        'stiffness': None if replaced[0] else setup.wall.stiffness,
        'damping': 0.0 if replaced[1] else setup.wall.damping,
        'concealed': _degree(trial, run),
        'force_floor_n': recorded.force_floor,
        'experiment': setup.experiment.name,
        'sensing': asdict(setup.sensing),
    }


def _degree(trial: Trial, run: Run) -> float:
    """Measure the concealment on the fine simulation, at the rate of the recording."""
    if not trial.effect:
        return 1.0
    setup = trial.setup
    without = simulate(setup, {}, setup.sensing.rate)
    return degree(trial.port, setup, _as_recorded(trial, run), without)


def _as_recorded(trial: Trial, run: Run) -> Run:
    every = round(NOTED_HZ / trial.setup.sensing.rate)
    return Run(*(signal[::every] for signal in run))


def _write_recording(path: Path, recorded: Recorded, trial: Trial) -> None:
    with_velocity = trial.setup.sensing.velocity_noise is not None
    wrench = WrenchEncoder('tool')
    joint = JointStateEncoder('base', _JOINT, with_velocity)
    reference = TrajectoryEncoder('base', _JOINT)
    rows: list[tuple[int, str, str, bytes]] = []
    for stamp, force in zip(recorded.force.stamps.tolist(), recorded.force.values.tolist()):
        data = wrench.encode(_EPOCH_NS + stamp, force, 0.0, 0.0)
        rows.append((stamp, '/wrench', 'geometry_msgs/msg/WrenchStamped', data))
    for stamp, motion in zip(recorded.joint.stamps.tolist(), recorded.joint.values.tolist()):
        data = joint.encode(_EPOCH_NS + stamp, *motion)
        rows.append((stamp, '/joint_states', 'sensor_msgs/msg/JointState', data))
    for stamp, point in zip(
        recorded.reference.stamps.tolist(), recorded.reference.values.tolist()
    ):
        x_r, v_r, a_r = point
        data = reference.encode(_EPOCH_NS + stamp, x_r, v_r, a_r, 0.0)
        rows.append((stamp, '/reference_trajectory', 'trajectory_msgs/msg/JointTrajectory', data))
    rows.sort(key=lambda row: row[0])
    with RecordingWriter.file(path) as writer:
        for stamp, topic, type_name, data in rows:
            writer.write(topic, type_name, data, _EPOCH_NS + stamp + _TRANSPORT_NS)
