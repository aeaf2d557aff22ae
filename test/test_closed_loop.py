# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The paper's benchmark in the closed loop."""

from __future__ import annotations

from contact_estimation.pipeline.parameters import EstimationParameters
from contact_estimation.pipeline.session import ContactSession
from contact_estimation.plant.closed_loop import extrapolate, run_closed_loop
from contact_estimation.plant.plant_parameters import PlantParameters
from contact_estimation.reference.experiments import experiment_named
from contact_estimation.reference.setpoints import Reference
from core_runs import closed_loop, PAPER_SENSORS, Run
import numpy as np
import pytest


@pytest.fixture(scope='module')
def paper_run() -> Run:
    return closed_loop({'estimator': 'indirect_adaptive'}, PAPER_SENSORS)


def test_contact_lasts_as_long_as_the_paper_says(paper_run: Run) -> None:
    touching = [truth.t for truth in paper_run.truths if truth.force < 0.0]
    assert (touching[0], touching[-1]) == pytest.approx((5.93, 9.17), abs=0.03)


def test_indirect_adaptive_meets_the_paper_s_stiffness_error(paper_run: Run) -> None:
    assert paper_run.last.stiffness == pytest.approx(4800.0, rel=0.005)


def test_indirect_adaptive_meets_the_paper_s_damping_error(paper_run: Run) -> None:
    assert paper_run.last.damping == pytest.approx(200.0, rel=0.01)


@pytest.mark.slow
def test_rls_meets_the_paper_s_errors() -> None:
    last = closed_loop({'estimator': 'rls'}, PAPER_SENSORS).last
    assert last.stiffness == pytest.approx(4800.0, rel=0.013)
    assert last.damping == pytest.approx(200.0, rel=0.03)


def test_estimates_do_not_move_before_contact(paper_run: Run) -> None:
    free = [r.estimate for t, r in zip(paper_run.truths, paper_run.results) if t.t < 5.9]
    assert {(e.stiffness, e.damping) for e in free} == {(3000.0, 50.0)}


def test_estimates_do_not_move_after_contact(paper_run: Run) -> None:
    free = [r.estimate for t, r in zip(paper_run.truths, paper_run.results) if t.t > 9.25]
    assert len({(e.stiffness, e.damping) for e in free}) == 1


def test_withdrawal_does_not_spoil_the_estimate(paper_run: Run) -> None:
    final = paper_run.results[-1].estimate
    np.testing.assert_allclose([final.stiffness, final.damping], [4800.0, 200.0], rtol=0.01)


def test_true_force_is_never_positive(paper_run: Run) -> None:
    assert max(truth.force for truth in paper_run.truths) <= 0.0


def test_equal_seeds_give_equal_runs(paper_run: Run) -> None:
    _, _, again = closed_loop({'estimator': 'indirect_adaptive'}, PAPER_SENSORS, duration=6.5)
    assert repr(again) == repr(paper_run.results[:len(again)])


def test_reference_is_followed_along_its_parabola() -> None:
    follow = extrapolate(2.0, Reference(0.1, 0.2, 0.3, 50.0))
    assert follow(2.5) == pytest.approx((0.1 + 0.1 + 0.0375, 0.2 + 0.15, 0.3, 50.0))


def test_last_contact_is_none_where_the_wall_is_out_of_reach() -> None:
    run = run_closed_loop(
        PlantParameters(), ContactSession(EstimationParameters()), experiment_named('none'), 0.1
    )
    assert run.last_contact is None


@pytest.mark.slow
def test_last_contact_is_the_last_sample_with_force() -> None:
    run = run_closed_loop(
        PlantParameters(), ContactSession(EstimationParameters()), experiment_named('none'), 6.5
    )
    assert run.last_contact == len(run.truths) - 1


def test_rls_is_honest_at_the_first_touch() -> None:
    run = closed_loop({'estimator': 'rls'}, PAPER_SENSORS)
    learned = [e for e in (r.estimate for r in run.results) if e.status == 'estimating']
    for name, true in (('stiffness', 4800.0), ('damping', 200.0)):
        errors = np.array([getattr(e, name) - true for e in learned])
        claimed = np.array([getattr(e, f'{name}_std') for e in learned])
        assert np.max(np.abs(errors) / claimed) < 5.0
