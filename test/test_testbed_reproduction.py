# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The errors on the testbed, within wide bounds."""

from __future__ import annotations

from contact_estimation.studies.reproduction.case import BEST, Case, Errors, PAPER
from contact_estimation.studies.reproduction.table import row_of
from contact_estimation.studies.reproduction.testbed_cases import TESTBED_CASES
import pytest


def case(name: str, estimator: str) -> Case:
    """Find a case."""
    return next(c for c in TESTBED_CASES if (c.case, c.estimator) == (name, estimator))


def within_a_factor_of_two(error: float, paper: float) -> bool:
    """Compare sizes."""
    return 0.5 * paper <= abs(error) <= 2.0 * paper


@pytest.mark.slow
@pytest.mark.parametrize('name, estimator', [
    ('testbed_sine', 'indirect_adaptive'), ('testbed_none', 'rls'),
])
def test_plain_algorithm_errs_as_in_the_paper(name: str, estimator: str) -> None:
    errors = case(name, estimator).run(0)
    assert within_a_factor_of_two(errors.stiffness, PAPER[name, estimator].stiffness)
    assert within_a_factor_of_two(errors.damping, PAPER[name, estimator].damping)


@pytest.mark.slow
def test_plain_gradient_at_rest_errs_as_in_the_paper_in_stiffness_and_less_in_damping() -> None:
    errors, paper = (of for of in (case('testbed_none', 'indirect_adaptive').run(0),
                                   PAPER['testbed_none', 'indirect_adaptive']))
    assert within_a_factor_of_two(errors.stiffness, paper.stiffness)
    # The contact is seen some samples sooner: more of the touch-down, all that excites, is used.
    assert 0.2 * paper.damping < abs(errors.damping) < paper.damping


def test_plain_rls_under_excitation_errs_as_in_the_paper_in_damping_only() -> None:
    errors = case('testbed_sine', 'rls').run(0)
    assert within_a_factor_of_two(errors.damping, PAPER['testbed_sine', 'rls'].damping)
    # The known exception: its K_e is worse than the paper's 3.5 %.
    assert abs(errors.stiffness) > 2.0 * PAPER['testbed_sine', 'rls'].stiffness


@pytest.mark.slow
@pytest.mark.parametrize('name, stiffness, damping', [
    ('testbed_sine', 1.0, 5.0), ('testbed_none', 2.0, 10.0), ('testbed_prbs', 1.0, 5.0),
])
def test_best_estimator_is_accurate_on_the_testbed(
    name: str, stiffness: float, damping: float
) -> None:
    errors = case(name, BEST).run(12)
    assert abs(errors.stiffness) < stiffness
    assert abs(errors.damping) < damping


@pytest.mark.slow
def test_identified_arm_makes_signal_processing_usable() -> None:
    plain = case('testbed_none', 'signal_processing').run(3)
    refined = case('testbed_none', 'signal_processing_refined').run(3)
    assert abs(plain.stiffness) > 25.0
    assert abs(refined.stiffness) < 5.0
    assert abs(refined.damping) < 15.0


@pytest.mark.slow
def test_same_seed_gives_the_same_errors_and_another_does_not() -> None:
    step = case('testbed_none', 'signal_processing_refined')
    assert step.run(5) == step.run(5) != step.run(6)


def test_row_holds_the_error_of_the_average_estimate() -> None:
    errors = [Errors(-1.0, 2.0, 0.1, 0.2), Errors(3.0, -4.0, 0.1, 0.2)]
    row = row_of(TESTBED_CASES[0], errors)
    assert (row['stiffness_average_percent'], row['damping_average_percent']) == (1.0, -1.0)
    assert row['seeds'] == 2
