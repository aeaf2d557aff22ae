# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The quintic against its linear system and finite differences."""

from __future__ import annotations

from contact_estimation.reference.quintic import quintic
import numpy as np
import pytest

BEGIN, END, DURATION = -0.1, 0.0204, 2.2


def test_quintic_solves_the_six_end_conditions() -> None:
    rows = []
    for t in (0.0, DURATION):
        powers = np.polynomial.Polynomial.basis
        rows += [[powers(k).deriv(d)(t) if d else powers(k)(t) for k in range(6)]
                 for d in range(3)]
    expected = np.polynomial.Polynomial(np.linalg.solve(rows, [BEGIN, 0, 0, END, 0, 0]))
    for t in np.linspace(0.0, DURATION, 23).tolist():
        values = (expected(t), expected.deriv()(t), expected.deriv(2)(t))
        np.testing.assert_allclose(quintic(BEGIN, END, DURATION, t), values, atol=1e-12)


@pytest.mark.parametrize('order', [1, 2])
def test_derivatives_are_those_of_finite_differences(order: int) -> None:
    h = 1e-5
    for t in np.linspace(0.1, DURATION - 0.1, 20).tolist():
        before, after = (quintic(BEGIN, END, DURATION, t + s * h) for s in (-1, 1))
        difference = (after[order - 1] - before[order - 1]) / (2.0 * h)
        assert quintic(BEGIN, END, DURATION, t)[order] == pytest.approx(difference, abs=1e-8)
