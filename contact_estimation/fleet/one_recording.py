# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""What a worker does, replay and diagnose one recording, and what identifies its result."""

from dataclasses import asdict, dataclass, field, replace
import hashlib
import json
from math import isfinite, nan
import os
from pathlib import Path
from typing import Any, Callable, Iterable, Mapping, NamedTuple, Sequence

import numpy as np

from ..diagnosis.diagnose import diagnose
from ..diagnosis.next_experiment import choose
from ..diagnosis.observe.signals import read_recording, Recording
from ..diagnosis.report.json_report import as_dict
from ..diagnosis.report.page import as_html
from ..diagnosis.result import Diagnosis
from ..estimators.estimate import Estimate, EstimateStatus
from ..exceptions import ContactEstimationError, MissingPackageError
from ..parameters import build, flatten
from ..pipeline.replay import no_usable_sample, RecordingReplay
from ..plant.plant_parameters import PlantParameters
from ..recordings import RecordingReader
from ..recordings.bag_folder import file_sha256
from ..recordings.source import from_metadata, RecordingSource
from ..scheduling import installed_version
from ..texts import printable


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
        return hash_of(dict(self.model))

    def key(self, task: str, *recordings: str) -> str:
        """Return what identifies a result."""
        return hash_of([task, recordings, asdict(self)])


def hash_of(data: Any) -> str:
    """Return the hash of plain data."""
    return hashlib.sha256(json.dumps(data, sort_keys=True).encode()).hexdigest()


def recording_sha256(path: str) -> str:
    """Return the hash of a recording, read block by block."""
    if not Path(path).is_dir():
        return file_sha256(Path(path))
    os.listdir(path)  # rglob passes over a folder that cannot be read
    files = sorted(file for file in Path(path).rglob('*') if file.is_file())
    return hash_of([(file.relative_to(path).as_posix(), file_sha256(file)) for file in files])


_LEAST_CONTACT_S = 0.2  # as in the diagnosis
_VALUES = ('stiffness', 'stiffness_std', 'damping', 'damping_std', 'model_fit')


class Episodes:
    """Collect the contacts of a stream of estimates, and its first and last stamp [ns]."""

    def __init__(self) -> None:
        self.first_ns: int | None = None
        self.last_ns: int | None = None
        self._begin_ns = 0
        self._last: Estimate | None = None
        self._had_band = False  # in the present contact
        self._found: list[dict[str, Any]] = []

    def add(self, estimates: Iterable[Estimate]) -> None:
        """Take consecutive estimates."""
        for estimate in estimates:
            if self.first_ns is None:
                self.first_ns = estimate.stamp_ns
            self.last_ns = estimate.stamp_ns
            if estimate.status is EstimateStatus.FREE:
                self._finish()
            else:
                if self._last is None:
                    self._begin_ns, self._had_band = estimate.stamp_ns, False
                self._last = estimate
                self._had_band |= isfinite(estimate.stiffness_std)

    def found(self) -> list[dict[str, Any]]:
        """
        Return the contacts.

        Returns episodes: number from 1, begin and end [s] since the first sample, status with its
        reason and estimates at the end; None for what is not estimated, is withheld, or has lost
        its band by what contradicts it. Contacts under 0.2 s are left out.
        """
        self._finish()
        return self._found

    def _finish(self) -> None:
        last, self._last = self._last, None
        if last is None or self.first_ns is None:
            return
        begin, end = ((stamp - self.first_ns) * 1e-9 for stamp in (self._begin_ns, last.stamp_ns))
        if end - begin >= _LEAST_CONTACT_S:
            withheld = self._had_band or last.status is EstimateStatus.FROZEN
            lost = withheld and not isfinite(last.stiffness_std)
            values = {name: nan if lost else float(getattr(last, name)) for name in _VALUES}
            self._found.append({
                'episode': len(self._found) + 1, 'begin_s': begin, 'end_s': end,
                'status': last.status.value, 'reason': last.reason,
                **{name: value if isfinite(value) else None for name, value in values.items()},
            })


def replay_episodes(
    path: str, source: RecordingSource, chosen: Mapping[str, Any],
    over: Mapping[str, Any] | None = None,
) -> Episodes:
    """Replay a recording."""
    reader = RecordingReader(path, source)
    recorded = from_metadata(reader.metadata())
    chosen = {name: value for name, value in chosen.items() if name not in recorded}
    replay = RecordingReplay(reader, source, {**chosen, **(over or {})})
    episodes = Episodes()
    for estimates in replay.estimates():
        episodes.add(of_axes[0] for of_axes in estimates)
    if episodes.first_ns is None:
        raise no_usable_sample(path, replay.session)
    return episodes


Outcome = dict[str, Any]
"""Plain data, as of `nothing`; of recordings together, version, report and error."""


def nothing(settings: Settings, error: str) -> Outcome:
    """Return the outcome of a recording of which nothing is known, ready to be filled."""
    return {'version': settings.version, 'start_ns': None, 'duration_s': None, 'episodes': [],
            'diagnosed_s': None, 'report': None, 'error': error}


class Result(NamedTuple):
    """What a worker returns."""

    outcome: Outcome  # ready for JSON
    page: str  # the diagnosis as HTML; '' without


def process(path: str, settings: Settings, with_page: bool) -> Result:
    """Replay and diagnose a recording."""
    outcome, page, errors = nothing(settings, ''), '', list[str]()

    def attempt(step: Callable[[], Any]) -> Any:
        try:
            return step()
        except MissingPackageError:
            raise  # of the worker, not of the recording
        except ContactEstimationError as error:
            errors.append(str(error).replace(printable(path), printable(Path(path).name)))
        return None

    attempt(lambda: outcome.update(start_ns=RecordingReader(path, settings.source).start_ns))
    recording = attempt(lambda: read(path, settings))
    if recording is not None:
        attempt(lambda: outcome.update(_replayed(path, settings)))
        outcome['diagnosed_s'] = float(np.ptp(recording.signals.wrench_t))
        diagnosis = attempt(lambda: _diagnosed([recording], settings))
        if diagnosis is not None:
            outcome['report'] = as_dict(diagnosis)
            page = as_html(diagnosis, recording.name) if with_page else ''
    outcome['error'] = '; '.join(dict.fromkeys(errors))
    return Result(outcome, page)


def process_pooled(
    paths: Sequence[str], held_out: Sequence[str], settings: Settings, with_page: bool
) -> Result:
    """Diagnose several recordings together: one law for all of them."""
    try:
        fitted, tested = ([read(path, settings) for path in some] for some in (paths, held_out))
        diagnosis = _diagnosed(fitted, settings, tested)
    except MissingPackageError:
        raise
    except ContactEstimationError as error:
        return Result({'version': settings.version, 'report': None, 'error': str(error)}, '')
    title = printable(', '.join(Path(path).name for path in paths))
    page = as_html(diagnosis, title) if with_page else ''
    return Result({'version': settings.version, 'report': as_dict(diagnosis), 'error': ''}, page)


def read(path: str, settings: Settings) -> Recording:
    """Read a recording for the diagnosis."""
    return read_recording(path, topics=settings.topics, axis=settings.axis,
                          joint=settings.joint, most_samples=settings.most_samples,
                          parameters=settings.parameters, **settings.reading)


def _replayed(path: str, settings: Settings) -> Outcome:
    """Replay with the model's wall, unless the node's is recorded."""
    chosen: dict[str, Any] = {
        'environment.location': settings.nominal.environment.location,
        'axis': settings.axis,
    }
    if settings.joint:
        chosen['joint'] = settings.joint
    episodes = replay_episodes(path, settings.source, chosen, settings.parameters)
    first, last = episodes.first_ns or 0, episodes.last_ns or 0
    return {'start_ns': first, 'duration_s': (last - first) * 1e-9, 'episodes': episodes.found()}


def _diagnosed(
    recordings: Sequence[Recording], settings: Settings, held_out: Sequence[Recording] = ()
) -> Diagnosis:
    diagnosis = diagnose(recordings, settings.nominal, held_out=held_out, seed=settings.seed)
    proposal = choose(diagnosis)
    return diagnosis if proposal is None else replace(diagnosis, next_experiment=proposal.text)
