# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Outliers of the force: replaced before the filter, and believed where they last."""

from __future__ import annotations

from contact_estimation.estimators import ESTIMATORS
from contact_estimation.signals.contact_sample import ContactSample
from contact_estimation.signals.outlier_gate import OutlierGate
from core_runs import contact_samples, estimates_of, pipeline_with
import numpy as np
from numpy.typing import NDArray
import pytest

EACH = pytest.mark.parametrize('estimator', ESTIMATORS)
NOISE, K = 0.3, 5000.0
DEPTHS = 0.01 + 0.002 * np.sin(0.04 * np.arange(500))


def forces(seed: int = 0) -> NDArray[np.float64]:
    """Press on a spring."""
    noise: NDArray[np.float64] = NOISE * np.random.default_rng(seed).standard_normal(500)
    return K * DEPTHS + noise


def replaced(given: NDArray[np.float64], gate: OutlierGate) -> NDArray[np.float64]:
    """Pass forces through a gate."""
    return np.array([gate.replace(d, y, NOISE) for d, y in zip(DEPTHS.tolist(), given.tolist())])


def hit(samples: list[ContactSample], at: list[int], force: float) -> list[ContactSample]:
    """Add a pressing force to single samples."""
    return [
        s._replace(force=s.force - force) if k in at else s for k, s in enumerate(samples)
    ]


@pytest.mark.parametrize('spike', [500.0, 100.0, -40.0])
def test_spike_becomes_the_force_of_the_line(spike: float) -> None:
    gate, given = OutlierGate(6.0, 5), forces()
    given[200] += spike
    got = replaced(given, gate)
    assert gate.count == 1
    assert got[200] == pytest.approx(K * DEPTHS[200], abs=4.0 * NOISE)
    np.testing.assert_array_equal(np.delete(got, 200), np.delete(given, 200))


@EACH
def test_spikes_in_1_percent_of_the_samples_move_the_stiffness_by_less_than_2_percent(
    estimator: str
) -> None:
    samples = contact_samples(2.0, force_noise=NOISE)
    at = np.flatnonzero(np.random.default_rng(1).uniform(size=len(samples)) < 0.01)
    spoilt = hit(samples, [k for k in at.tolist() if k > 260], 100.0)
    last = estimates_of(spoilt, pipeline_with(estimator=estimator))[-1]
    assert last.stiffness == pytest.approx(4800.0, rel=0.02)
