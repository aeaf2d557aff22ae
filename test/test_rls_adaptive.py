# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Forgetting that adapts, next to the fixed one on the same samples."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

from contact_estimation.estimators.contact_model import kelvin_voigt_force
from contact_estimation.estimators.parameters import EnvironmentParameters
from contact_estimation.estimators.rls_adaptive import (
    AdaptiveLeastSquares, AdaptiveLeastSquaresParameters)
from contact_estimation.signals.contact_sample import ContactSample
from core_runs import contact_samples, estimates_of, pipeline_with
from core_steps import known, learn
import numpy as np
from numpy.typing import NDArray
import pytest

STIFFNESS, DAMPING, TIMES, FORCE_STD = 4800.0, 200.0, 0.002, 0.58
EXCITED_S, STILL_S = 7 * 2.0 * np.pi / 20.0, 8.0  # whole periods, so that the motion is smooth
CHANGED = (6000.0, 300.0)


def estimator(**tuning: Any) -> AdaptiveLeastSquares:
    """Make an estimator with the default first guess."""
    return AdaptiveLeastSquares(
        AdaptiveLeastSquaresParameters(**tuning), EnvironmentParameters(), TIMES
    )


def rows_of(count: int, seed: int = 10) -> NDArray[np.float64]:
    """Rows (y, d, v, 1, a) of a sine contact."""
    t = TIMES * np.arange(count)
    d, v = 0.01 + 0.002 * np.sin(20.0 * t), 0.04 * np.cos(20.0 * t)
    y = STIFFNESS * d + DAMPING * v + 0.5 * np.random.default_rng(seed).standard_normal(count)
    return np.column_stack([y, d, v, np.ones(count), -400.0 * (d - 0.01)])


@lru_cache(maxsize=None)
def story(seed: int) -> tuple[tuple[ContactSample, ...], int, int]:
    """Excited, then still for long, then excited on a wall that has changed meanwhile."""
    excited = contact_samples(EXCITED_S, STIFFNESS, DAMPING)
    first, period = len(excited), 2_000_000
    moving = excited[-round(EXCITED_S / TIMES):]
    rest = [excited[0]._replace(position=0.008, velocity=0.0, force=-STIFFNESS * 0.008)]
    changed = [
        s._replace(force=float(kelvin_voigt_force(s.position, s.velocity, *CHANGED)))
        for s in moving
    ]
    samples = [*excited, *rest * round(STILL_S / TIMES), *changed]
    noise = FORCE_STD * np.random.default_rng(seed).standard_normal(len(samples))
    told = tuple(
        s._replace(stamp_ns=k * period, force=s.force + float(error))
        for k, (s, error) in enumerate(zip(samples, noise))
    )
    return told, first, len(samples) - len(changed)


@lru_cache(maxsize=None)
def figures(name: str) -> dict[str, float]:
    """RMS damping error [%] while excited and while still; time to follow the change [s]."""
    excited, still, recovery = [], [], []
    for seed in range(3):
        samples, first, change = story(seed)
        made = estimates_of(list(samples), pipeline_with(estimator=name))
        pairs = np.array([[e.stiffness, e.damping] for e in made])
        errors = 100.0 * (pairs[:, 1] / DAMPING - 1.0)
        excited.append(np.sqrt(np.mean(errors[first - 500:first] ** 2)))
        still.append(np.sqrt(np.mean(errors[change - 1000:change] ** 2)))
        off = np.abs(pairs[change:] / CHANGED - 1.0) > [0.05, 0.1]
        recovery.append(TIMES * (np.flatnonzero(off.any(axis=1))[-1] + 1))
    return {'excited': np.mean(excited), 'still': np.mean(still), 'recovery': np.mean(recovery)}


@pytest.mark.slow
def test_damping_is_at_least_twice_as_quiet_as_with_fixed_forgetting() -> None:
    assert figures('rls_adaptive')['excited'] < 0.5 * figures('rls')['excited']


def test_without_forgetting_it_is_batch_least_squares_with_the_prior() -> None:
    rows, prior = rows_of(400), np.array([2000.0, 100.0])  # which stays clear of all limits
    of = estimator(
        smallest_forgetting_factor=1.0, inertia_std=0.0,
        stiffness_std=2000.0, damping_std=100.0,
    )
    for row in rows.tolist():
        learn(of, TIMES, row, 0.25)
    phi = np.vstack([rows[:, 1:3] / 0.5, np.diag(1.0 / prior)])
    y = np.concatenate([rows[:, 0] / 0.5, [3000.0, 50.0] / prior])
    theta = np.linalg.lstsq(phi, y, rcond=None)[0]
    np.testing.assert_allclose([of.stiffness, of.damping], theta, rtol=1e-9)
    spread = np.sqrt(np.diag(np.linalg.inv(phi.T @ phi)))
    np.testing.assert_allclose(known(of)[2:4], spread, rtol=1e-9)
