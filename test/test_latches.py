# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
Nothing that happens to the data is remembered for good.

Faults are drawn by hypothesis, always the same, and last 2 s each while the tool goes on pressing.
"""

from __future__ import annotations

from functools import lru_cache
from math import inf, nan

from contact_estimation.estimators.estimate import Estimate, EstimateStatus
from contact_estimation.pipeline.parameters import EstimationParameters
from contact_estimation.pipeline.session import ContactSession
from hypothesis import given, Phase, settings, strategies as st
import numpy as np
from numpy.typing import NDArray
import pytest
from wall_worlds import Array, contact, spring_damper

K, B = 5000.0, 100.0
FAULT_S, CLEAN_S, FIRST_S = 2.0, 7.0, 2.5
PERIOD_S = 1.75  # of the presses
EPOCH_NS = 10**18
Stamps = NDArray[np.int64]

FAULTS = ('noise_burst', 'flipped_sign', 'frozen_force', 'frozen_position', 'wild_values',
          'silence', 'clock_back', 'zero_step')


def spoil(
    fault: str, stamps: Stamps, force: Array, x: Array, part: slice, draw: np.random.Generator
) -> None:
    """Let a fault happen to a part of a recording; silence is a stamp of -1."""
    if fault == 'noise_burst':
        force[part] += 5.0 * draw.standard_normal(len(force[part]))
    elif fault == 'flipped_sign':
        force[part] *= -1.0
    elif fault == 'frozen_force':
        force[part] = force[part.start]
    elif fault == 'frozen_position':
        x[part] = x[part.start]
    elif fault == 'wild_values':
        for values in (force, x):
            some = draw.uniform(size=len(force)) < 0.5
            some[:part.start] = some[part.stop:] = False
            values[some] = draw.choice([nan, inf, -inf, 1e300, 1e6, -500.0, 0.0], int(some.sum()))
    elif fault == 'silence':
        stamps[part] = -1
    elif fault == 'clock_back':
        stamps[part.start:] -= np.where(stamps[part.start:] < 0, 0, 20 * 10**9)
    else:
        force[part] -= 4.0


@lru_cache(maxsize=4)
def clean(seconds: float, seed: int) -> tuple[Stamps, Array, Array]:
    """Return stamps, F_e and x of one press after the other."""
    count = int(seconds / PERIOD_S) + 1
    presses = tuple((PERIOD_S * k + 0.3, PERIOD_S * k + 1.6) for k in range(count))
    t, force, x, _ = contact(spring_damper(K, B), seconds, presses=presses, seed=seed)
    return EPOCH_NS + np.round(1e9 * t).astype(np.int64), -force, x


def estimates_after(faults: list[str], seed: int) -> list[Estimate]:
    """Return the estimates of a session that has met faults, one after the other."""
    end_s = FIRST_S + FAULT_S * len(faults)
    stamps, force, x = clean(end_s + CLEAN_S, seed)
    stamps, force, x = stamps.copy(), force.copy(), x.copy()
    draw = np.random.default_rng(seed)
    for k, name in enumerate(faults):
        part = slice(*(round(500.0 * (FIRST_S + FAULT_S * j)) for j in (k, k + 1)))
        spoil(name, stamps, force, x, part, draw)
    session = ContactSession(EstimationParameters())
    estimates = []
    for stamp, f, position in zip(stamps.tolist(), force.tolist(), x.tolist()):
        if stamp >= 0:
            session.add_motion(stamp, position, nan)
            estimates += [one.estimate for one in session.add_wrench(stamp, f)]
    return estimates


def recovers(faults: list[str], seed: int = 0) -> None:
    """Require a right estimate and a contact at the end of the clean presses."""
    recent = estimates_after(faults, seed)[-round(500.0 * PERIOD_S):]
    last = recent[-1]
    assert any(one.status is EstimateStatus.ESTIMATING for one in recent), (faults, last)
    assert abs(last.stiffness - K) <= max(0.02 * K, 2.0 * last.stiffness_std), (faults, last)


@pytest.mark.slow
@pytest.mark.parametrize('fault', FAULTS)
def test_recovers_from_a_fault(fault: str) -> None:
    recovers([fault])


@pytest.mark.slow
@given(st.lists(st.sampled_from(FAULTS), min_size=2, max_size=3), st.integers(0, 3))
@settings(derandomize=True, deadline=None, max_examples=5, database=None,
          phases=(Phase.explicit, Phase.generate))
def test_recovers_from_faults_in_any_order(faults: list[str], seed: int) -> None:
    recovers(faults, seed)
