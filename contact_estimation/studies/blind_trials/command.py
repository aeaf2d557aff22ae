# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Evaluate `diagnose` on randomised worlds with known ground truth."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
import sys
import tempfile
from typing import Any, Callable, Iterable, NamedTuple, Sequence

import numpy as np

from .arm_trials import arm_text, run_arm_trials
from .calibration import calibrate, judged
from .foreign_laws import FOREIGN_LAWS, UNKNOWN_LAWS
from .scoring import as_dict, as_text, plot_reliability, Score, score
from .settings import EFFECTS_OF_A_WALL, IDEAL, RIGS
from .trial import draw_trial
from .trial_files import TrialFiles, write_json, write_trial
from ...commands.command_line import (
    as_json, check_outputs, command, Parser, require_at_least, write_results)
from ...commands.progress import Progress
from ...exceptions import ParameterRangeError
from ...scheduling import Call, finished, values_of, Workers, workers

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


def plan_effects(count: int, seed: int, names: Iterable[str] = EFFECTS_OF_A_WALL) -> list[str]:
    """Distribute trials evenly over effects."""
    effects: list[str] = []
    while len(effects) < count:
        rng = np.random.default_rng([seed, len(effects)])
        effects += rng.permutation(list(names)).tolist()
    return effects[:count]


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
    values_of(workers, calls, progress)
    if only_write:
        return []
    return [score(trial.name, *_truth_and_answer(folder, trial)) for trial in trials]


def run_trial(folder: Path, planned: PlannedTrial, only_write: bool = False) -> None:
    """Run the missing steps of a trial."""
    files = TrialFiles.of(folder, planned.name)
    if not files.truth.exists():
        rng = np.random.default_rng(planned.seed)
        setting = RIGS if planned.on_rig else IDEAL
        write_trial(draw_trial(setting, planned.effect, rng), files, rng)
        files.report.unlink(missing_ok=True)
    if not only_write and not files.report.exists():
        diagnose_blind(files)


def _truth_and_answer(folder: Path, planned: PlannedTrial) -> tuple[Any, Any]:
    files = TrialFiles.of(folder, planned.name)
    return json.loads(files.truth.read_text()), json.loads(files.report.read_text())


def diagnose_blind(files: TrialFiles) -> None:
    """Diagnose a trial, given recording and nominal model only, and write the answer."""
    found = diagnosed(files.recording, files.nominal, timeout_s=_TIMEOUT_S)
    write_json(files.report, {'report': found.report, 'error': found.error,
                              'seconds': round(found.wall_s, 1), 'comparison': found.comparison})


class Answer(NamedTuple):
    """What a diagnosis answers, and what it takes."""

    report: dict[str, Any] | None  # None after a failure
    comparison: Any  # of the models, from which constants are fitted
    error: str  # message of a failure; '' on success
    # wall_s, cpu_s: elapsed time, and processor time [s]
    wall_s: float
    cpu_s: float


def diagnosed(
    recording: Path, nominal: Path, *options: str, timeout_s: float | None = None
) -> Answer:
    """Diagnose in a process of its own, which is given nothing else."""
    with tempfile.TemporaryDirectory() as folder:
        output, models = Path(folder) / 'report.json', Path(folder) / 'models.json'
        done = finished([
            sys.executable, '-m', 'contact_estimation.commands.diagnose', str(recording),
            '--nominal', str(nominal), '--json', str(output), '--write-comparison', str(models),
            *options], timeout_s)
        report, comparison = (None if done.error else json.loads(path.read_text())
                              for path in (output, models))
    return Answer(report, comparison, done.error, done.wall_s, done.cpu_s)


_KINDS = ('count', 'clean', 'unknown', 'foreign', 'arms')


def make_parser() -> Parser:
    """Build the command line of `blind_trials`."""
    parser = Parser(
        prog='blind_trials',
        description='Draw worlds with one concealed effect or none, record them, run diagnose on '
        'recording and nominal model only, and score its reports against the ground truth. '
        '--foreign and --unknown draw rigs with the small nuisances of a laboratory and laws that '
        "are not the library's, scored by family. An "
        'interrupted study resumes, and a larger one reuses the trials of a smaller one in the '
        'same folder; delete the subfolder reports to repeat the diagnoses.',
    )
    parser.add_argument('--count', type=int, default=0, help='trials with an effect (0)')
    parser.add_argument('--clean', type=int, default=0, help='trials without an effect (0)')
    parser.add_argument('--unknown', type=int, default=0,
                        help='trials on a rig with a law that no effect describes (0)')
    parser.add_argument('--foreign', type=int, default=0,
                        help='trials on a rig with a law from the literature that the library '
                        'does not have; every ninth has none (0)')
    parser.add_argument('--arms', type=int, default=0,
                        help='trials on whole arms that conceal a law in a joint or a payload, '
                        'with links 5 %% off and friction in every joint (0); needs the extra '
                        'robots')
    parser.add_argument('--pressing', action='store_true',
                        help='let the arms of --arms press on a wall under a Cartesian '
                        'impedance, and conceal a law of their joints or of the wall')
    parser.add_argument('--calibrate', metavar='FILE',
                        help='fit the constants of the decision to these trials, print how much '
                        'each matters, and write them as JSON')
    parser.add_argument('--only-write', action='store_true',
                        help='write recordings, nominal models and truths; diagnose nothing')
    parser.add_argument('--seed', type=int, nargs='+', default=[0], metavar='S',
                        help='seed of all random draws; the trials of several are pooled (0)')
    parser.add_argument('--jobs', type=int, metavar='N',
                        help='number of parallel processes (1), or of trials at a time on the '
                        'workers of --scheduler; more than one needs Dask (extra fleet)')
    parser.add_argument('--scheduler', metavar='ADDRESS',
                        help='Dask scheduler whose workers to use, such as tcp://host:8786')
    parser.add_argument('--output', metavar='DIR', default='blind_trials_output',
                        help='folder of recordings, reports, truths, table.txt and '
                        'reliability.png (blind_trials_output)')
    parser.add_argument('--json', metavar='FILE', help='write the scores as JSON')
    return parser


def run(options: Any) -> int:
    """Run, score and print a study."""
    require_at_least(options, **dict.fromkeys(_KINDS, 0), jobs=1)
    if min(options.seed) < 0:
        raise ParameterRangeError(f'--seed must be >= 0, got {min(options.seed)}')
    if not any(getattr(options, kind) for kind in _KINDS):
        raise ParameterRangeError(
            '--count, --clean, --unknown, --foreign and --arms are all 0; request at least one '
            'trial')
    check_outputs([options.json, options.calibrate], {})
    folder = Path(options.output)
    folder.mkdir(parents=True, exist_ok=True)
    progress = Progress('blind_trials')
    if options.arms:
        _run_arms(folder, options, progress)
    if any(getattr(options, kind) for kind in _KINDS[:-1]):
        _run_contacts(folder, options, progress)
    progress.done()
    return 0


def _run_arms(folder: Path, options: Any, progress: Progress) -> None:
    outcomes = [one for seed in options.seed for one in run_arm_trials(
        folder, options.arms, seed, progress.show, options.only_write, options.pressing)]
    if outcomes:
        print(arm_text(outcomes))
        (folder / 'arms.txt').write_text(arm_text(outcomes) + '\n')
        (folder / 'arms.json').write_text(as_json(outcomes))


def _run_contacts(folder: Path, options: Any, progress: Progress) -> None:
    trials = [one for seed in options.seed for one in plan_study(
        options.count, options.clean, seed, options.unknown, options.foreign)]
    with workers(options.scheduler, options.jobs or (None if options.scheduler else 1)) as started:
        scores = run_study(folder, trials, started, progress.show, options.only_write)
    progress.done()
    if options.only_write:
        print(f'wrote {len(trials)} trials to {folder / "handed_over"}, truths to '
              f'{folder / "sealed"}')
        return
    text = as_text(scores, str(folder / 'handed_over'))
    print(text)
    (folder / 'table.txt').write_text(text + '\n')
    write_results(options, {'json': lambda: as_json(as_dict(scores, options.seed))})
    if options.calibrate:
        found = [judged(*_truth_and_answer(folder, trial)) for trial in trials]
        fitted = calibrate([one for one in found if one is not None])
        print(fitted.text())
        fitted.write(Path(options.calibrate))
    print(f'wrote {plot_reliability(scores, folder / "reliability.png")}')


main = command(make_parser, run)

if __name__ == '__main__':
    raise SystemExit(main())
