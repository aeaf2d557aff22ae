# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""A study: draw trials, diagnose each without its truth, score; an interrupted study resumes."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
import subprocess
import sys
import tempfile
import time
from typing import Any, Callable, NamedTuple, Sequence

import numpy as np

from .calibration import judged, JudgedTrial
from .foreign_laws import FOREIGN_LAWS, UNKNOWN_LAWS
from .rig_trial import draw_rig_trial
from .scoring import Score, score
from .trial import draw_trial, plan_effects, TrialFiles, write_json, write_rig_trial, write_trial
from ...scheduling import Call, Workers

_TIMEOUT_S = 1800.0  # of one diagnosis
_ON_RIG = (2, 3)  # kinds of trials: with effects, clean, unknown, foreign
_EVERY_CLEAN = 9


class PlannedTrial(NamedTuple):
    """A trial of the plan, not drawn yet."""

    name: str  # name of the files; it does not reveal the effect
    effect: str  # key of EFFECTS or of ALL_LAWS; '' for a clean world
    seed: tuple[int, int, int]  # seed of all random draws of the trial
    # whether on a rig with nuisances, else in a world that obeys the library's laws exactly
    on_rig: bool = False


def plan_study(
    count: int, clean: int, seed: int, unknown: int = 0, foreign: int = 0
) -> list[PlannedTrial]:
    """Plan a study."""
    kinds = (plan_effects(count, seed), [''] * clean, plan_effects(unknown, seed, UNKNOWN_LAWS),
             _plan_foreign(foreign, seed))
    return [PlannedTrial(_name((seed, kind, k)), effect, (seed, kind, k), kind in _ON_RIG)
            for kind, effects in enumerate(kinds) for k, effect in enumerate(effects)]


def _plan_foreign(count: int, seed: int) -> list[str]:
    """Plan laws of the literature with a clean world after every eight."""
    laws = iter(plan_effects(count, seed, FOREIGN_LAWS))
    return ['' if k % _EVERY_CLEAN == _EVERY_CLEAN - 1 else next(laws) for k in range(count)]


def _name(seed: tuple[int, int, int]) -> str:
    return 'trial_' + hashlib.sha256(repr(seed).encode()).hexdigest()[:8]


def run_study(
    folder: Path, trials: Sequence[PlannedTrial], workers: Workers,
    progress: Callable[[float, str], None], only_write: bool = False,
) -> list[Score]:
    """Run the remaining trials of a study and score all."""
    calls = {trial.name: Call(run_trial, (folder.absolute(), trial, only_write))
             for trial in trials}
    for done, (name, answer) in enumerate(workers.answers(calls), 1):
        if answer.error is not None:
            raise answer.error
        progress(done / len(trials), name)
    if only_write:
        return []
    return [score(trial.name, *_truth_and_answer(folder, trial)) for trial in trials]


def run_trial(folder: Path, planned: PlannedTrial, only_write: bool = False) -> None:
    """Run the missing steps of a trial."""
    files = TrialFiles.of(folder, planned.name)
    if not files.truth.exists():
        rng = np.random.default_rng(planned.seed)
        if planned.on_rig:
            write_rig_trial(draw_rig_trial(planned.effect, rng), files, rng)
        else:
            write_trial(draw_trial(planned.effect, rng), files, rng)
        files.report.unlink(missing_ok=True)
    if not only_write and not files.report.exists():
        diagnose_blind(files)


def judged_trials(folder: Path, trials: Sequence[PlannedTrial]) -> list[JudgedTrial]:
    """Return the trials of a study for a calibration."""
    return judged(_truth_and_answer(folder, trial) for trial in trials)


def _truth_and_answer(folder: Path, planned: PlannedTrial) -> tuple[Any, Any]:
    files = TrialFiles.of(folder, planned.name)
    return json.loads(files.truth.read_text()), json.loads(files.report.read_text())


def diagnose_blind(files: TrialFiles) -> None:
    """Diagnose a trial in a process of its own, given recording and nominal model only."""
    with tempfile.TemporaryDirectory() as folder:
        output, models = Path(folder) / 'report.json', Path(folder) / 'models.json'
        begin = time.monotonic()
        error = _run([*diagnose_command(files.recording, files.nominal, output),
                      '--write-comparison', str(models)])
        seconds = time.monotonic() - begin
        report, comparison = (None if error else json.loads(path.read_text())
                              for path in (output, models))
    write_json(files.report, {'report': report, 'error': error, 'seconds': round(seconds, 1),
                              'comparison': comparison})


def diagnose_command(recording: Path, nominal: Path, output: Path) -> list[str]:
    """Build the command line of a diagnosis."""
    return [sys.executable, '-m', 'contact_estimation.commands.diagnose', str(recording),
            '--nominal', str(nominal), '--json', str(output)]


def _run(command: list[str]) -> str:
    """Run a command and return its error message, '' on success."""
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=_TIMEOUT_S,
                              stdin=subprocess.DEVNULL)
    except subprocess.TimeoutExpired:
        return f'not finished within {_TIMEOUT_S:g} s'
    lines = done.stderr.strip().splitlines()
    return '' if done.returncode == 0 else (lines or [f'exit code {done.returncode}'])[-1]
