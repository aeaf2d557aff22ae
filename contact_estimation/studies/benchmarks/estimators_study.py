# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
Compare all estimators, and peers of other packages, in worlds for which none of them was tuned.

Walls of 300 to 1e5 N/m, force sensors with one or two poles at 100 to 300 Hz, stamps off by
0.1 ms, quantised positions, dropped samples. The study measures errors, whether the published
deviations hold, and the time to converge on a wall that is new or changes. What the deviations
take from a prior is drawn from it: the lag of the force, and x_e where it is not said to be exact.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, Callable, Mapping, Sequence

from .study_report import (
    as_markdown, candidates, convergence_figure, coverage_figure, error_figure, Results, scores)
from .study_worlds import make_world, PEERS, SCENARIOS, STEADY, Trace, World
from ...commands.command_line import command, new_file, Parser
from ...commands.progress import Progress
from ...exceptions import ParameterRangeError
from ...figures import as_png, require_matplotlib
from ...pipeline.parameters import EstimationParameters

_UNKNOWN_PLACE = 'excited, x_e within 2 mm', 'unexcited, x_e within 2 mm'
_COUNTS = {'excited': 24, 'unexcited': 12, _UNKNOWN_PLACE[0]: 24, _UNKNOWN_PLACE[1]: 12}
_OTHERS = 4
_QUICK = {'excited': 4, 'unexcited': 2, _UNKNOWN_PLACE[0]: 2, _UNKNOWN_PLACE[1]: 2,
          '300 to 30000 N/m': 2, '30000 to 300 N/m': 2}
_QUICK_OTHERS = 1


def make_parser() -> Parser:
    """Build the command line of the study."""
    parser = Parser(
        prog='studies estimators',
        description='Compare all estimators with their defaults, and filterpy and padasip where '
        'installed, in simulated worlds with sensors as real ones are: walls of 300 to 1e5 N/m, '
        'force low-pass 100 to 300 Hz, stamps off by 0.1 ms, quantised positions, 0.2 % of the '
        'samples dropped. Prints Markdown tables: errors, how often the truth is within 2 '
        'standard deviations, time to converge after a change.',
    )
    parser.add_argument('--quick', action='store_true', help='fewer worlds: under a minute')
    parser.add_argument('--seed', type=int, default=0, help='of all worlds (0)')
    parser.add_argument('--only', nargs='+', metavar='NAME', help='candidates (all)')
    every = ', '.join(SCENARIOS).replace('%', '%%')  # argparse formats the text
    parser.add_argument('--scenario', nargs='+', metavar='NAME', choices=tuple(SCENARIOS),
                        help=f'any of {every} (all)')
    parser.add_argument('--output', metavar='FOLDER',
                        help='write estimators_study.md and three pictures')
    return parser


def run(options: Any) -> int:
    """Run the study and report it."""
    chosen = _chosen(options.only)
    if options.seed < 0:
        raise ParameterRangeError(f'--seed must be >= 0, got {options.seed}')
    files = _files(Path(options.output)) if options.output else None
    counts = _counts(options.scenario or list(SCENARIOS), options.quick)
    results = study(chosen, counts, options.seed)
    text = as_markdown(results)
    print(text)
    if files:
        files['estimators_study.md'].write_text(text + '\n')
        for name, figure in _figures(results).items():
            files[name].write_bytes(as_png(figure))
    return 0


def _chosen(names: Sequence[str] | None) -> dict[str, Callable[[World], Trace]]:
    every = candidates()
    for name in names or ():
        if name not in every:
            raise ParameterRangeError(
                f'--only must name candidates ({", ".join(every)}), got {name!r}')
    return {name: every[name] for name in names or every}


def _files(folder: Path) -> dict[str, Path]:
    require_matplotlib()  # refused before the study, not after it
    folder.mkdir(parents=True, exist_ok=True)
    names = ('estimators_study.md', 'study_errors.png', 'study_coverage.png',
             'study_convergence.png')
    return {name: new_file(str(folder / name)) for name in names}


def _counts(scenarios: Sequence[str], quick: bool) -> dict[str, int]:
    counts, others = (_QUICK, _QUICK_OTHERS) if quick else (_COUNTS, _OTHERS)
    return {name: counts.get(name, others) for name in scenarios}


def study(
    chosen: Mapping[str, Callable[[World], Trace]], counts: Mapping[str, int], seed: int
) -> Results:
    """Score candidates in all scenarios."""
    progress = Progress('benchmarks.estimators_study')
    steps, done = len(counts) * len(chosen), 0
    found: dict[str, dict[str, Any]] = {name: {} for name in chosen}
    for scenario, count in counts.items():
        worlds = [make_world(SCENARIOS[scenario], k, count, seed) for k in range(count)]
        for name, candidate in chosen.items():
            found[name][scenario] = scores(candidate, worlds)
            done += 1
            progress.show(done / steps, f'{scenario}: {name}')
    progress.done()
    return {name: by_scenario for name, by_scenario in found.items()
            if name not in PEERS or any(by_scenario.values())}


def _figures(results: Results) -> dict[str, Any]:
    scenarios = list(next(iter(results.values())))
    steady = [name for name in scenarios if name in STEADY]
    abrupt = [name for name in scenarios if SCENARIOS[name].abrupt]
    figures = {'study_coverage.png': coverage_figure(results, scenarios)}
    if steady:
        default = EstimationParameters().estimator
        figures['study_errors.png'] = error_figure(results, steady[0], default)
    if abrupt:
        figures['study_convergence.png'] = convergence_figure(results, abrupt)
    return figures


main = command(make_parser, run)
