# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Evaluate `diagnose` on randomised worlds with known ground truth."""

import hashlib
from pathlib import Path
from typing import Any, Iterable, NamedTuple, Sequence

import numpy as np

from .arm_trials import arm_text, plan_arms, scored
from .calibration import calibrate, judged
from .foreign_laws import FOREIGN_LAWS, UNKNOWN_LAWS
from .running import run_trials, TrialFiles
from .scoring import as_dict, as_text, score
from .settings import EFFECTS_OF_A_WALL, IDEAL, RIGS
from .trial import draw_trial, write_trial
from ...commands.command_line import (
    as_json, check_outputs, command, Parser, require_at_least, write_results)
from ...exceptions import ParameterRangeError

_ON_RIG = (2, 3)  # kinds of trials: with effects, clean, unknown, foreign
_EVERY_CLEAN = 9  # of the trials of foreign laws


class PlannedTrial(NamedTuple):
    """A trial of the plan, not drawn yet."""

    name: str  # name of the files; it does not reveal the effect
    effect: str  # key of EFFECTS or of ALL_LAWS; '' for a clean world
    seed: tuple[int, int, int]  # seed of all random draws of the trial
    # whether on a rig with nuisances, else in a world that obeys the library's laws exactly
    on_rig: bool = False

    def files(self, folder: Path) -> TrialFiles:
        """Return the paths of its files."""
        return TrialFiles.of(folder, self.name)

    def write(self, files: TrialFiles) -> dict[str, Any]:
        """Draw the trial, write what is handed over, and return the truth."""
        rng, setting = np.random.default_rng(self.seed), RIGS if self.on_rig else IDEAL
        return write_trial(draw_trial(setting, self.effect, rng), files, rng)

    def options(self, files: TrialFiles) -> list[str]:
        """Return the options of `diagnose` that hand over all but the recording."""
        return ['--nominal', str(files.nominal)]


def plan_study(
    count: int, clean: int, seed: int, unknown: int = 0, foreign: int = 0
) -> list[PlannedTrial]:
    """Plan a study."""
    laws = iter(plan_effects(foreign, seed, FOREIGN_LAWS))
    kinds = (plan_effects(count, seed), [''] * clean, plan_effects(unknown, seed, UNKNOWN_LAWS),
             ['' if k % _EVERY_CLEAN == _EVERY_CLEAN - 1 else next(laws) for k in range(foreign)])
    return [PlannedTrial(_name((seed, kind, k)), effect, (seed, kind, k), kind in _ON_RIG)
            for kind, effects in enumerate(kinds) for k, effect in enumerate(effects)]


def plan_effects(count: int, seed: int, names: Iterable[str] = EFFECTS_OF_A_WALL) -> list[str]:
    """Distribute trials evenly over effects."""
    effects: list[str] = []
    while len(effects) < count:
        rng = np.random.default_rng([seed, len(effects)])
        effects += rng.permutation(list(names)).tolist()
    return effects[:count]


def _name(seed: tuple[int, int, int]) -> str:
    return 'trial_' + hashlib.sha256(repr(seed).encode()).hexdigest()[:8]


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
        'same folder; delete the subfolder reports to repeat the diagnoses.')
    parser.add_argument('--count', type=int, default=0,
                        help='trials with an effect (default: %(default)s)')
    parser.add_argument('--clean', type=int, default=0,
                        help='trials without an effect (default: %(default)s)')
    parser.add_argument('--unknown', type=int, default=0,
                        help='trials on a rig with a law that no effect describes '
                        '(default: %(default)s)')
    parser.add_argument('--foreign', type=int, default=0,
                        help='trials on a rig with a law from the literature that the library '
                        'does not have; every ninth has none (default: %(default)s)')
    parser.add_argument('--arms', type=int, default=0,
                        help='trials on whole arms that conceal a law in a joint or a payload, '
                        'with links 5 %% off and friction in every joint (default: %(default)s); '
                        'needs the extra robots')
    parser.add_argument('--pressing', action='store_true',
                        help='let the arms of --arms press on a wall under a Cartesian '
                        'impedance, and conceal a law of their joints or of the wall')
    parser.add_argument('--calibrate', metavar='FILE',
                        help='fit the constants of the decision to these trials, print how much '
                        'each matters, and write them as JSON')
    parser.add_argument('--only-write', action='store_true',
                        help='write recordings, nominal models and truths; diagnose nothing')
    parser.add_argument('--seed', type=int, nargs='+', default=[0], metavar='S',
                        help='seed of all random draws; the trials of several are pooled '
                        '(default: 0)')
    parser.add_argument('--jobs', type=int, metavar='N',
                        help='number of parallel processes (default: 1), or of trials at a time '
                        'on the workers of --scheduler; more than one needs Dask (extra fleet)')
    parser.add_argument('--scheduler', metavar='ADDRESS',
                        help='Dask scheduler whose workers to use, such as tcp://host:8786')
    parser.add_argument('--output', metavar='DIR', default='blind_trials_output',
                        help='folder of recordings, reports, truths and table.txt '
                        '(default: %(default)s)')
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
    jobs = options.jobs or (None if options.scheduler else 1)
    arms = plan_arms(options.arms, options.seed, options.pressing)
    trials = [one for seed in options.seed for one in plan_study(
        options.count, options.clean, seed, options.unknown, options.foreign)]
    told_arms, told = (run_trials(folder, some, jobs, options.scheduler, options.only_write)
                       if some else [] for some in (arms, trials))
    if options.only_write:
        print(f'wrote {len(arms) + len(trials)} trials to {folder / "handed_over"}, truths to '
              f'{folder / "sealed"}')
        return 0
    if arms:
        _report_arms(folder, [scored(*one, arm.name) for arm, one in zip(arms, told_arms)])
    if trials:
        _report(folder, trials, told, options)
    return 0


def _report_arms(folder: Path, outcomes: Sequence[dict[str, Any]]) -> None:
    print(arm_text(outcomes))
    (folder / 'arms.txt').write_text(arm_text(outcomes) + '\n')
    (folder / 'arms.json').write_text(as_json(outcomes))


def _report(
    folder: Path, trials: Sequence[PlannedTrial], told: Sequence[tuple[Any, Any]], options: Any
) -> None:
    scores = [score(trial.name, *one) for trial, one in zip(trials, told)]
    text = as_text(scores, str(folder / 'handed_over'))
    print(text)
    (folder / 'table.txt').write_text(text + '\n')
    write_results(options, {'json': lambda: as_json(as_dict(scores, options.seed))})
    if options.calibrate:
        fitted = calibrate([one for one in map(judged, *zip(*told)) if one is not None])
        print(fitted.text())
        fitted.write(Path(options.calibrate))


main = command(make_parser, run)
