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
from .testbed_cases import TESTBED_CASES, TESTBED_RUNS, TestbedCase, TestbedStepCase
from .testbed_runs import run_testbed_case

Case = OnlineCase | StepCase | TestbedCase | TestbedStepCase

ALL_CASES: list[Case] = [*CASES, *TESTBED_CASES]


def make_table(seeds: int, jobs: int, progress: Callable[[float], None]) -> list[dict[str, Any]]:
    """
    Run all cases with all seeds.

    Parameters
    ----------
    seeds : int
        Runs of each case, with the seeds 0, 1, ...; of a testbed case TESTBED_RUNS at most.
    jobs : int
        Processes.
    progress : callable
        Gets the fraction done.

    Returns
    -------
    rows : list of dict
        As in the contract.

    """
    tasks = [
        (case, seed) for case in ALL_CASES
        for seed in range(min(seeds, TESTBED_RUNS) if is_testbed(case) else seeds)
    ]
    done: dict[int, list[Errors]] = {}
    with ProcessPoolExecutor(jobs) as pool:
        results = pool.map(_run, tasks, chunksize=max(1, seeds // 4))
        for count, ((case, _), errors) in enumerate(zip(tasks, results), 1):
            done.setdefault(ALL_CASES.index(case), []).append(errors)
            progress(count / len(tasks))
    return [row_of(ALL_CASES[index], errors) for index, errors in sorted(done.items())]


def is_testbed(case: Case) -> bool:
    """
    Tell the cases of the testbed from the simulated ones.

    Parameters
    ----------
    case : one of the classes of cases
        It.

    Returns
    -------
    is_testbed : bool
        Whether it runs on the testbed.

    """
    return isinstance(case, (TestbedCase, TestbedStepCase))


def _run(task: tuple[Case, int]) -> Errors:
    case, seed = task
    if isinstance(case, (TestbedCase, TestbedStepCase)):
        return run_testbed_case(case, seed)
    return run_case(case, seed)


def row_of(case: Case, errors: list[Errors]) -> dict[str, Any]:
    """
    Sum up the runs of one case.

    Parameters
    ----------
    case : one of the classes of cases
        It.
    errors : list of Errors
        One a seed.

    Returns
    -------
    row : dict
        As in the contract, and the root mean squares and the errors of the average estimate.

    """
    values = np.array(errors)
    median = np.median(np.abs(values), axis=0)
    rms = np.sqrt(np.mean(values**2, axis=0))
    average = np.mean(values, axis=0)  # what the paper gives of its ten experiments
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
        'stiffness_average_percent': float(average[0]),
        'damping_average_percent': float(average[1]),
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
        f'{"case":<17} {"estimator":<26} {"law":<13} {"median |error|":>16} '
        f'{"rms":>16} {"of the average":>16} {"bound":>16} {"paper":>13}   K / B in %'
    ]
    for row in rows:
        pairs = [
            _pair(row[f'stiffness_{kind}_percent'], row[f'damping_{kind}_percent'])
            for kind in ('error', 'rms', 'average', 'bound')
        ]
        paper = _pair(
            row['paper_stiffness_error_percent'], row['paper_damping_error_percent'], 1
        )
        lines.append(
            f'{row["case"]:<17} {row["estimator"]:<26} {row["law"]:<13} '
            + ' '.join(f'{pair:>16}' for pair in pairs) + f' {paper:>13}'
        )
    return '\n'.join(lines)


def _pair(stiffness: float | None, damping: float | None, digits: int = 3) -> str:
    if stiffness is None or damping is None:
        return '-'
    return f'{stiffness:.{digits}f} / {damping:.{digits}f}'
