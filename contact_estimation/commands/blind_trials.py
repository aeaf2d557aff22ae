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

"""Evaluate `diagnose` on randomised worlds with known ground truth."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from .command_line import command, new_file, Parser
from .progress import Progress
from ..blind_trials.calibration import plot_reliability
from ..blind_trials.family_report import family_dict, family_text
from ..blind_trials.report import as_dict, as_text, plot_confusion
from ..blind_trials.study import plan_study, run_study, Scores
from ..exceptions import ParameterRangeError

_KINDS = ('count', 'clean', 'unknown', 'foreign')


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
    parser.add_argument('--count', type=int, required=True, help='trials with an effect')
    parser.add_argument('--clean', type=int, default=0, help='trials without an effect (0)')
    parser.add_argument('--unknown', type=int, default=0,
                        help='trials on a rig with a law that no effect describes (0)')
    parser.add_argument('--foreign', type=int, default=0,
                        help='trials on a rig with a law of the literature that is not the '
                        "library's; every ninth has none (0)")
    parser.add_argument('--only-write', action='store_true',
                        help='write recordings, nominal models and truths; diagnose nothing')
    parser.add_argument('--seed', type=int, default=0, help='seed of all random draws (0)')
    parser.add_argument('--jobs', type=int, default=1, help='number of parallel processes (1)')
    parser.add_argument('--output', metavar='DIR', default='blind_trials_output',
                        help='folder of recordings, reports, truths, table.txt and confusion.png '
                        '(blind_trials_output)')
    parser.add_argument('--json', metavar='FILE', help='write the scores as JSON')
    return parser


def run(options: Any) -> int:
    """
    Run, score and print a study.

    Parameters
    ----------
    options : argparse.Namespace
        Options of `make_parser`.

    Returns
    -------
    code : int
        0.

    """
    for name, least in (*((kind, 0) for kind in (*_KINDS, 'seed')), ('jobs', 1)):
        if getattr(options, name) < least:
            raise ParameterRangeError(f'--{name} must be >= {least}, got {getattr(options, name)}')
    if not any(getattr(options, kind) for kind in _KINDS):
        raise ParameterRangeError(
            '--count, --clean, --unknown and --foreign are all 0; request at least one trial')
    target = new_file(options.json) if options.json else None
    folder = Path(options.output)
    folder.mkdir(parents=True, exist_ok=True)
    progress = Progress('blind_trials')
    trials = plan_study(options.count, options.clean, options.seed, options.unknown,
                        options.foreign)
    scores = run_study(folder, trials, options.jobs, progress.show, options.only_write)
    progress.done()
    if options.only_write:
        print(f'wrote {len(trials)} trials to {folder / "handed_over"}, truths to '
              f'{folder / "sealed"}')
        return 0
    text = '\n\n'.join(_texts(scores, str(folder / 'handed_over')))
    print(text)
    (folder / 'table.txt').write_text(text + '\n')
    if target is not None:
        content = {**as_dict(scores.exact, options.seed), 'rigs': family_dict(scores.on_rigs)}
        target.write_text(json.dumps(content, indent=1) + '\n')
    if scores.exact:
        print(f'wrote {plot_confusion(scores.exact, folder / "confusion.png")}')
    if scores.on_rigs:
        print(f'wrote {plot_reliability(scores.on_rigs, folder / "reliability.png")}')
    return 0


def _texts(scores: Scores, folder: str) -> list[str]:
    texts = [as_text(scores.exact, folder)] if scores.exact else []
    return texts + ([family_text(scores.on_rigs, folder)] if scores.on_rigs else [])


main = command(make_parser, run)


if __name__ == '__main__':
    raise SystemExit(main())
