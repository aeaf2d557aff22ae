# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Reproduce the paper's table and figures, off-line."""

from concurrent.futures import ProcessPoolExecutor
from math import isfinite
import os
from pathlib import Path
from typing import Any, Callable

import numpy as np

from .paper_cases import ALL_CASES, Case, Errors, PAPER
from .paper_figures import plot_figures
from ..commands.command_line import (
    as_json, check_outputs, command, Parser, require_at_least, write_results)
from ..commands.progress import Progress
from ..texts import markdown_table

_NAMES = 'stiffness', 'damping'


def make_table(seeds: int, jobs: int, progress: Callable[[float], None]) -> list[dict[str, Any]]:
    """Run all cases with all seeds."""
    tasks = [(index, seed) for index, case in enumerate(ALL_CASES)
             for seed in range(min(seeds, case.max_runs))]
    errors: list[list[Errors]] = [[] for _ in ALL_CASES]
    with ProcessPoolExecutor(jobs) as pool:
        results = pool.map(_run, tasks, chunksize=max(1, seeds // 4))
        for count, ((index, _), result) in enumerate(zip(tasks, results), 1):
            errors[index].append(result)
            progress(count / len(tasks))
    return [row_of(case, runs) for case, runs in zip(ALL_CASES, errors)]


def _run(task: tuple[int, int]) -> Errors:
    index, seed = task
    return ALL_CASES[index].run(seed)


def row_of(case: Case, errors: list[Errors]) -> dict[str, Any]:
    """Summarise the runs of a case."""
    values = np.array(errors)
    median = np.median(np.abs(values), axis=0)
    kinds = {
        'error': median[:2].tolist(), 'rms': np.sqrt(np.mean(values[:, :2]**2, axis=0)).tolist(),
        'average': np.mean(values[:, :2], axis=0).tolist(),  # as in the paper, over its ten runs
        'bound': [value if isfinite(value) else None for value in median[2:].tolist()]}
    paper = PAPER.get((case.case, case.estimator), (None, None))
    return {
        'case': case.case, 'estimator': case.estimator + case.variant, 'law': case.law,
        'seeds': len(errors),
        **{f'{name}_{kind}_percent': value for kind, pair in kinds.items()
           for name, value in zip(_NAMES, pair)},
        **{f'paper_{name}_error_percent': value for name, value in zip(_NAMES, paper)}}


def as_text(rows: list[dict[str, Any]]) -> str:
    """Format the table: K_e / B_e [%]."""
    kinds = 'error_percent', 'rms_percent', 'average_percent', 'bound_percent'
    return markdown_table(
        ('case', 'estimator', 'law', 'median abs. error [%]', 'RMS error', 'error of average',
         'bound', 'paper'),
        ([row['case'], row['estimator'], row['law'],
          *(_pair(*(row[f'{name}_{kind}'] for name in _NAMES)) for kind in kinds),
          _pair(row['paper_stiffness_error_percent'], row['paper_damping_error_percent'], 1)]
         for row in rows))


def _pair(stiffness: float | None, damping: float | None, digits: int = 3) -> str:
    if stiffness is None or damping is None:
        return '-'
    return f'{stiffness:.{digits}f} / {damping:.{digits}f}'


def make_parser() -> Parser:
    """Build the command line of `reproduce`."""
    parser = Parser(
        prog='reproduce',
        description="Run the paper's cases, in simulation and on a virtual testbed, and print the "
        'errors at the last instant of contact with the Cramer-Rao bounds and the errors printed '
        'in the paper.')
    parser.add_argument(
        '--seeds', type=int, default=20,
        help='runs of each case (default: %(default)s); at most 10 on the testbed, as in the '
        'paper')
    parser.add_argument('--json', metavar='FILE', help='write the table as JSON')
    parser.add_argument('--output', metavar='DIR', help='plot the figures as PNG into this folder')
    parser.add_argument('--jobs', type=int, default=os.cpu_count() or 1,
                        help='number of parallel processes (default: one for each processor)')
    return parser


def run(options: Any) -> int:
    """Compute table and figures."""
    require_at_least(options, seeds=1, jobs=1)
    check_outputs([options.json], {})
    progress = Progress('reproduce')
    rows = make_table(options.seeds, options.jobs, progress.show)
    progress.done()
    print(as_text(rows))
    write_results(options, {'json': lambda: as_json({'cases': rows})})
    if options.output:
        for path in plot_figures(Path(options.output)):
            print(f'wrote {path}')
    return 0


main = command(make_parser, run)
