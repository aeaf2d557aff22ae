# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""What identifies a result: content of the recording, model, version and options."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
import hashlib
import json
import os
from pathlib import Path
from typing import Any, Mapping

from ..parameters import build, flatten
from ..plant.plant_parameters import PlantParameters
from ..recordings.identity import file_sha256
from ..recordings.source import RecordingSource
from ..scheduling import installed_version


@dataclass(frozen=True)
class Settings:
    """What a worker needs besides a recording: plain data, equal on every machine."""

    model: Mapping[str, Any]  # all parameters of the nominal model, by dotted name
    topics: Mapping[str, str] = field(default_factory=dict)  # as in `read_recording`
    # how recordings are read: attributes of `RecordingSource` that are no topics
    reading: Mapping[str, Any] = field(default_factory=dict)
    # of the estimator, chosen over recorded ones
    parameters: Mapping[str, Any] = field(default_factory=dict)
    # axis, joint: contact axis of the force, and its joint; '' for the only joint
    axis: str = 'x'
    joint: str = ''
    seed: int = 0  # of the bootstraps
    most_samples: int = 1_000_000  # wrenches of a recording that are diagnosed, from its start
    version: str = field(default_factory=installed_version)  # of this package

    @classmethod
    def of(cls, model: PlantParameters, **options: Any) -> 'Settings':
        """Return the settings for a model."""
        return cls(dict(flatten(model)), **options)

    @property
    def source(self) -> RecordingSource:
        """Return where and how recordings are read."""
        return RecordingSource.of_topics(self.topics, **self.reading)

    @property
    def nominal(self) -> PlantParameters:
        """Return the nominal model."""
        return build(PlantParameters, dict(self.model))

    @property
    def model_sha256(self) -> str:
        """Hash of the nominal model's parameters; its comments do not count."""
        return _hash_of(dict(self.model))

    def key(self, task: str, *recordings: str) -> str:
        """Return what identifies a result."""
        return _hash_of([task, recordings, asdict(self)])


def _hash_of(data: Any) -> str:
    return hashlib.sha256(json.dumps(data, sort_keys=True).encode()).hexdigest()


def recording_sha256(path: str) -> str:
    """Return the hash of a recording, read block by block."""
    if not Path(path).is_dir():
        return file_sha256(Path(path))
    os.listdir(path)  # rglob passes over a folder that cannot be read
    files = sorted(file for file in Path(path).rglob('*') if file.is_file())
    return _hash_of([(file.relative_to(path).as_posix(), file_sha256(file)) for file in files])
