# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The errors on the testbed, within wide bounds."""

from __future__ import annotations

from contact_estimation.studies.paper_cases import ALL_CASES, BEST, Case, PAPER
import pytest


def case(name: str, estimator: str) -> Case:
    """Find a case."""
    return next(c for c in ALL_CASES if (c.case, c.estimator) == (name, estimator))


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
@pytest.mark.parametrize('name, stiffness, damping', [
    ('testbed_sine', 1.0, 5.0), ('testbed_none', 2.0, 10.0), ('testbed_prbs', 1.0, 5.0),
])
def test_best_estimator_is_accurate_on_the_testbed(
    name: str, stiffness: float, damping: float
) -> None:
    errors = case(name, BEST).run(12)
    assert abs(errors.stiffness) < stiffness
    assert abs(errors.damping) < damping
