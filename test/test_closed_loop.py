# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The paper's benchmark in the closed loop."""

from __future__ import annotations

from core_runs import closed_loop, PAPER_SENSORS, Run
import numpy as np
import pytest


@pytest.fixture(scope='module')
def paper_run() -> Run:
    return closed_loop({'estimator': 'indirect_adaptive'}, PAPER_SENSORS)


def test_indirect_adaptive_meets_the_paper_s_stiffness_error(paper_run: Run) -> None:
    assert paper_run.last.stiffness == pytest.approx(4800.0, rel=0.005)


def test_indirect_adaptive_meets_the_paper_s_damping_error(paper_run: Run) -> None:
    assert paper_run.last.damping == pytest.approx(200.0, rel=0.01)


@pytest.mark.slow
def test_rls_meets_the_paper_s_errors() -> None:
    last = closed_loop({'estimator': 'rls'}, PAPER_SENSORS).last
    assert last.stiffness == pytest.approx(4800.0, rel=0.013)
    assert last.damping == pytest.approx(200.0, rel=0.03)


def test_equal_seeds_give_equal_runs(paper_run: Run) -> None:
    _, _, again = closed_loop({'estimator': 'indirect_adaptive'}, PAPER_SENSORS, duration=6.5)
    assert repr(again) == repr(paper_run.results[:len(again)])


def test_rls_is_honest_at_the_first_touch() -> None:
    run = closed_loop({'estimator': 'rls'}, PAPER_SENSORS)
    learned = [e for e in (r.estimate for r in run.results) if e.status == 'estimating']
    for name, true in (('stiffness', 4800.0), ('damping', 200.0)):
        errors = np.array([getattr(e, name) - true for e in learned])
        claimed = np.array([getattr(e, f'{name}_std') for e in learned])
        assert np.max(np.abs(errors) / claimed) < 5.0
