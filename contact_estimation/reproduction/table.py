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

"""The table: median errors over seeds beside the bound and the paper's figures."""

from __future__ import annotations

from concurrent.futures import ProcessPoolExecutor
from math import isfinite
from typing import Any, Callable

import numpy as np

from .cases import CASES, OnlineCase, StepCase
from .paper_results import PAPER
from .runs import Errors, run_case


def make_table(seeds: int, jobs: int, progress: Callable[[float], None]) -> list[dict[str, Any]]:
    """
    Run all cases with all seeds.

    Parameters
    ----------
    seeds : int
        Runs of each case, with the seeds 0, 1, ...
    jobs : int
        Processes.
    progress : callable
        Gets the fraction done.

    Returns
    -------
    rows : list of dict
        As in the contract.

    """
    tasks = [(case, seed) for case in CASES for seed in range(seeds)]
    done: dict[int, list[Errors]] = {}
    with ProcessPoolExecutor(jobs) as pool:
        results = pool.map(_run, tasks, chunksize=max(1, seeds // 4))
        for count, ((case, _), errors) in enumerate(zip(tasks, results), 1):
            done.setdefault(CASES.index(case), []).append(errors)
            progress(count / len(tasks))
    return [row_of(CASES[index], errors) for index, errors in sorted(done.items())]


def _run(task: tuple[OnlineCase | StepCase, int]) -> Errors:
    return run_case(*task)


def row_of(case: OnlineCase | StepCase, errors: list[Errors]) -> dict[str, Any]:
    """
    Sum up the runs of one case.

    Parameters
    ----------
    case : OnlineCase or StepCase
        It.
    errors : list of Errors
        One a seed.

    Returns
    -------
    row : dict
        As in the contract, and the root mean squares.

    """
    values = np.array(errors)
    median = np.median(np.abs(values), axis=0)
    rms = np.sqrt(np.mean(values**2, axis=0))
    paper = PAPER.get((case.case, case.estimator))
    return {
        'case': case.case,
        'estimator': case.estimator + getattr(case, 'variant', ''),
        'law': case.law,
        'seeds': len(errors),
        'stiffness_error_percent': float(median[0]),
        'damping_error_percent': float(median[1]),
        'stiffness_rms_percent': float(rms[0]),
        'damping_rms_percent': float(rms[1]),
        'stiffness_bound_percent': _or_none(median[2]),
        'damping_bound_percent': _or_none(median[3]),
        'paper_stiffness_error_percent': paper.stiffness if paper else None,
        'paper_damping_error_percent': paper.damping if paper else None,
    }


def _or_none(value: float) -> float | None:
    return float(value) if isfinite(value) else None


def as_text(rows: list[dict[str, Any]]) -> str:
    """
    Write the table for people.

    Parameters
    ----------
    rows : list of dict
        Of `make_table`.

    Returns
    -------
    text : str
        One line a row; K / B in percent.

    """
    lines = [
        f'{"case":<16} {"estimator":<26} {"law":<13} {"median |error|":>15} '
        f'{"rms":>15} {"bound":>15} {"paper":>13}   K / B in %'
    ]
    for row in rows:
        pairs = [
            _pair(row[f'stiffness_{kind}_percent'], row[f'damping_{kind}_percent'])
            for kind in ('error', 'rms', 'bound')
        ]
        paper = _pair(
            row['paper_stiffness_error_percent'], row['paper_damping_error_percent'], 1
        )
        lines.append(
            f'{row["case"]:<16} {row["estimator"]:<26} {row["law"]:<13} '
            + ' '.join(f'{pair:>15}' for pair in pairs) + f' {paper:>13}'
        )
    return '\n'.join(lines)


def _pair(stiffness: float | None, damping: float | None, digits: int = 3) -> str:
    if stiffness is None or damping is None:
        return '-'
    return f'{stiffness:.{digits}f} / {damping:.{digits}f}'
