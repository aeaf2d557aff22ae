# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""What a worker does: replay and diagnose one recording, or several together."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any, Callable, NamedTuple, Sequence

import numpy as np

from .episodes import replay_episodes
from .fingerprint import Settings
from ..diagnosis.conclude.diagnose import diagnose
from ..diagnosis.conclude.next_experiment import choose
from ..diagnosis.conclude.result import Diagnosis
from ..diagnosis.observe.read_recording import read_recording
from ..diagnosis.observe.signals import Recording
from ..diagnosis.report.json_report import as_dict
from ..diagnosis.report.page import as_html
from ..exceptions import ContactEstimationError, MissingPackageError
from ..recordings import RecordingReader
from ..texts import printable

Outcome = dict[str, Any]
"""Plain data with `OUTCOME_NAMES`; of recordings together, with `POOLED_NAMES`."""
OUTCOME_NAMES = {
    'version', 'start_ns', 'duration_s', 'episodes', 'diagnosed_s', 'report', 'error'}
POOLED_NAMES = {'version', 'report', 'error'}


class Result(NamedTuple):
    """What a worker returns."""

    outcome: Outcome  # ready for JSON
    page: str  # the diagnosis as HTML; '' without


def process(path: str, settings: Settings, with_page: bool) -> Result:
    """Replay and diagnose a recording."""
    outcome: Outcome = {
        'version': settings.version, 'start_ns': None, 'duration_s': None, 'episodes': [],
        'diagnosed_s': None, 'report': None, 'error': '',
    }
    page = ''
    errors: list[str] = []

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
        return Result({'version': settings.version, 'report': None,
                       'error': str(error)}, '')
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
    diagnosis = diagnose(
        recordings, settings.nominal, held_out=held_out, seed=settings.seed)
    proposal = choose(diagnosis)
    return diagnosis if proposal is None else replace(diagnosis, next_experiment=proposal.text)
