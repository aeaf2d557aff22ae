# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The steps of a trial, of a contact or an arm: written, diagnosed blind, read for its score."""

import json
from pathlib import Path
import sys
import tempfile
from typing import Any, NamedTuple, Protocol, Sequence

from ...commands.command_line import as_json
from ...commands.progress import computed
from ...exceptions import ParameterRangeError
from ...scheduling import Call, finished
from ...texts import write_whole

_TIMEOUT_S = 1800.0  # of one diagnosis


class TrialFiles(NamedTuple):
    """Paths of the files of a trial."""

    # recording, nominal: input of the diagnosis
    recording: Path
    nominal: Path
    report: Path  # what the diagnosis answers
    truth: Path  # in a folder that the diagnosis does not know

    @classmethod
    def of(cls, folder: Path, name: str, nominal: str = '.nominal.yaml', truth: str = '.truth.json'
           ) -> 'TrialFiles':
        """Return the paths of a trial, with the suffixes of two of them."""
        inputs = folder / 'handed_over'
        return cls(inputs / f'{name}.mcap', inputs / f'{name}{nominal}',
                   folder / 'reports' / f'{name}.json', folder / 'sealed' / f'{name}{truth}')


class Planned(Protocol):
    """A trial of a plan, not drawn yet."""

    @property
    def name(self) -> str:
        """Name of the files; it does not reveal what is concealed."""

    def files(self, folder: Path) -> TrialFiles:
        """Return the paths of its files."""

    def write(self, files: TrialFiles) -> Any:
        """Draw the trial, write what is handed over, and return the truth."""

    def options(self, files: TrialFiles) -> list[str]:
        """Return the options of `diagnose` that hand over all but the recording."""


def run_trials(
    folder: Path, trials: Sequence[Planned], jobs: int | None, scheduler: str | None = None,
    only_write: bool = False,
) -> list[tuple[Any, Any]]:
    """Run the remaining steps of trials; return truth and answer of each, if there are answers."""
    computed('blind_trials', {
        trial.name: Call(run_trial, (folder.absolute(), trial, only_write)) for trial in trials},
        jobs, scheduler)
    return [] if only_write else [_read(trial.files(folder)) for trial in trials]


def _read(files: TrialFiles) -> tuple[Any, Any]:
    """Return truth and answer of a trial."""
    truth, answer = (json.loads(path.read_text()) for path in (files.truth, files.report))
    if 'kind' not in truth or 'report' not in answer:
        raise ParameterRangeError(
            f'--output {files.truth.parents[1]} must hold trials of this version, got '
            f'{files.truth.name} of another one; choose another folder')
    return truth, answer


def run_trial(folder: Path, planned: Planned, only_write: bool = False) -> None:
    """Run the missing steps of a trial."""
    files = planned.files(folder)
    if not files.truth.exists():
        files.recording.parent.mkdir(parents=True, exist_ok=True)
        files.recording.unlink(missing_ok=True)  # incomplete: the study was interrupted
        write_json(files.truth, planned.write(files))
        files.report.unlink(missing_ok=True)
    if not only_write and not files.report.exists():
        found = diagnosed(files.recording, *planned.options(files), timeout_s=_TIMEOUT_S)
        write_json(files.report, {'report': found.report, 'error': found.error,
                                  'seconds': round(found.wall_s, 1),
                                  'comparison': found.comparison})


class Answer(NamedTuple):
    """What a diagnosis answers, and what it takes."""

    report: dict[str, Any] | None  # None after a failure
    comparison: Any  # of the models, from which constants are fitted
    error: str  # message of a failure; '' on success
    # wall_s, cpu_s: elapsed time, and processor time [s]
    wall_s: float
    cpu_s: float


def diagnosed(recording: Path, *options: str, timeout_s: float | None = None) -> Answer:
    """Diagnose in a process of its own, which is given nothing else."""
    with tempfile.TemporaryDirectory() as folder:
        output, models = Path(folder) / 'report.json', Path(folder) / 'models.json'
        done = finished([
            sys.executable, '-m', 'contact_estimation', 'diagnose', str(recording), '--json',
            str(output), '--write-comparison', str(models), *options], timeout_s)
        report, comparison = (None if done.error else json.loads(path.read_text())
                              for path in (output, models))
    return Answer(report, comparison, done.error, done.wall_s, done.cpu_s)


def write_json(path: Path, content: Any) -> None:
    """Write a JSON file whole or not at all."""
    path.parent.mkdir(parents=True, exist_ok=True)
    write_whole(path, as_json(content).encode('utf-8'))
