# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Evaluate `diagnose` on randomised worlds with known ground truth."""

from __future__ import annotations

from contextlib import contextmanager
from pathlib import Path
from typing import Any, Iterator

from .arm_trials import arm_text, run_arm_trials
from .calibration import calibrate
from .scoring import as_dict, as_text, plot_reliability
from .study import judged_trials, plan_study, run_study
from ...commands.command_line import (
    as_json, check_outputs, command, Parser, require_at_least, write_results)
from ...commands.progress import Progress
from ...exceptions import ParameterRangeError
from ...scheduling import ThisProcess, Workers, workers

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
    with _workers(options) as started:
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
        fitted = calibrate(judged_trials(folder, trials))
        print(fitted.text())
        fitted.write(Path(options.calibrate))
    print(f'wrote {plot_reliability(scores, folder / "reliability.png")}')


@contextmanager
def _workers(options: Any) -> Iterator[Workers]:
    if options.scheduler is None and (options.jobs or 1) == 1:
        yield ThisProcess()  # Dask would add nothing, and need not be installed
        return
    with workers(options.scheduler, options.jobs) as started:
        yield started


main = command(make_parser, run)

if __name__ == '__main__':
    raise SystemExit(main())
