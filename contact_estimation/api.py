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

"""Read recordings and models, and diagnose: what scripts and notebooks call."""

from __future__ import annotations

from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import Mapping, Sequence

from .diagnosis.conclude.result import Diagnosis
from .diagnosis.diagnosis import diagnose as diagnose_recordings
from .diagnosis.observe.signals import Recording, signals_of
from .exceptions import ModelFileError, ParameterRangeError, UnknownNameError
from .messages import FORCE_OF_AXIS
from .parameters.file import read_parameter_file
from .parameters.values import build, without
from .physics import effects_that_are_on
from .plant.plant_parameters import PlantParameters
from .recordings import RecordingReader
from .recordings.recorded_signals import read_signals
from .recordings.source import RecordingSource
from .ros.plant_node_parameters import PlantNodeParameters

TOPICS = ('wrench', 'joint_states', 'reference_trajectory')


def read_recording(
    path: str | PathLike[str], *, topics: Mapping[str, str] | None = None, axis: str = 'x',
    joint: str = '',
) -> Recording:
    """
    Read the signals of a recording.

    Parameters
    ----------
    path : str or path-like
        An `.mcap` file or a rosbag2 folder.
    topics : mapping of str to str, optional
        Recorded topic names by 'wrench', 'joint_states' and 'reference_trajectory'. A topic that
        is not given has that name.
    axis : {'x', 'y', 'z'}
        Force axis of the wrench.
    joint : str
        Joint of the contact axis; '' if the recording has only one.

    Returns
    -------
    recording : Recording
        Name and signals, time in seconds from the first wrench.

    Raises
    ------
    RecordingError
        If the recording cannot be read or lacks wrenches or joint states.
    UnknownNameError
        If `axis` or a key of `topics` is unknown.

    """
    if axis not in FORCE_OF_AXIS:
        raise UnknownNameError.among('axis', axis, FORCE_OF_AXIS)
    for name in topics or {}:
        if name not in TOPICS:
            raise UnknownNameError.among('topic', name, TOPICS)
    source = RecordingSource(**(topics or {}))
    signals = read_signals(RecordingReader(str(path)), source, axis, joint)
    return Recording(Path(path).name, signals_of(signals))


def read_model(path: str | PathLike[str], seed: int | None = None) -> PlantParameters:
    """
    Read a model file: the section `plant_node` of a ROS 2 parameter file.

    Parameters
    ----------
    path : str or path-like
        YAML file; a missing key has its default.
    seed : int, optional
        Seed of all noise, >= 0; default: the seed of the file.

    Returns
    -------
    model : PlantParameters
        Environment, robot, sensors and physics.

    Raises
    ------
    ModelFileError
        If the file is missing or has no section `plant_node`.
    ContactEstimationError
        If a key is unknown or a value is out of range.

    """
    values = read_parameter_file(Path(path), 'plant_node')
    if not values:
        raise ModelFileError(
            f'model file {path} must have a section plant_node with ros__parameters, got none; '
            'see config/plant_node.yaml for an example'
        )
    model = build(PlantParameters, without(PlantNodeParameters, values))
    return model if seed is None else replace(model, seed=seed)


def diagnose(
    recordings: Recording | Sequence[Recording], model: PlantParameters, *,
    held_out: Sequence[Recording] = (), seed: int = 0,
) -> Diagnosis:
    """
    Compare recordings with the model that simulates them, and name the physics it lacks.

    Parameters
    ----------
    recordings : Recording or sequence of Recording
        From `read_recording`; several are fitted together.
    model : PlantParameters
        Nominal model, from `read_model`, without extra physics.
    held_out : sequence of Recording
        Recordings that are excluded from fitting; without any, a part of each recording is.
    seed : int
        Seed of the bootstraps, >= 0.

    Returns
    -------
    diagnosis : Diagnosis
        `verdict`, `effects` with fitted parameters, `stiffness`, `damping` and held-out errors.

    Raises
    ------
    ModelFileError
        If the model already has extra physics.
    ParameterRangeError
        If there is no recording or `seed` is negative.
    RecordingError
        If a recording has too little data, no contact or a constant signal.

    """
    several = [recordings] if isinstance(recordings, Recording) else list(recordings)
    if not several:
        raise ParameterRangeError('recordings must hold at least one recording, got none')
    if seed < 0:
        raise ParameterRangeError(f'seed must be >= 0, got {seed}')
    named = [effect.name for effect in effects_that_are_on(model.physics)]
    if named:
        raise ModelFileError(
            f'the model must have no physics, got {", ".join(named)}; leave them out: diagnose '
            'names what a model without them lacks'
        )
    return diagnose_recordings(several, held_out, model, seed)
