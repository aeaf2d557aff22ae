# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Corrections of three states in scalars against the same in matrices."""

from __future__ import annotations

from itertools import product

from contact_estimation.estimators.three_states import correct, Covariance, grow
import numpy as np
from numpy.typing import NDArray
import pytest

UPPER = np.triu_indices(3)
X, H, R = (1.0, -2.0, 0.5), (0.3, 1.1, -0.7), 0.4


def random_covariance(seed: int) -> tuple[NDArray[np.float64], Covariance]:
    """Draw a positive definite matrix."""
    root = np.random.default_rng(seed).standard_normal((3, 3))
    P = root @ root.T
    return P, tuple(P[UPPER].tolist())


@pytest.mark.parametrize('free', list(product([True, False], repeat=3)))
def test_correction_equals_the_schmidt_kalman_filter(free: tuple[bool, bool, bool]) -> None:
    P, triangle = random_covariance(1)
    mask, h = np.array(free), np.array(H)
    gain = P @ h / (h @ P @ h + R) * mask
    # Joseph's form holds for any gain, so also for one that is 0 at consider states.
    left = np.eye(3) - np.outer(gain, h)
    expected = left @ P @ left.T + R * np.outer(gain, gain)
    x, got, spread = correct(X, triangle, H, 0.9, R, free)
    np.testing.assert_allclose(x, np.array(X) + gain * 0.9, rtol=1e-12)
    np.testing.assert_allclose(got, expected[UPPER], rtol=1e-12, atol=1e-12)
    assert spread == pytest.approx(h @ P @ h + R)


@pytest.mark.parametrize('alone', [0, 1])
def test_state_forgotten_alone_forgets_its_variance_given_the_others(alone: int) -> None:
    P, triangle = random_covariance(5)
    growth = (1.1, 1.0, 1.0) if alone == 0 else (1.0, 1.1, 1.0)
    expected = P.copy()
    expected[alone, alone] += 0.21 / np.linalg.inv(P)[alone, alone]
    np.testing.assert_allclose(np.array(grow(triangle, growth)), expected[UPPER], rtol=1e-9)
