# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Gains that starve on stiff walls."""

from __future__ import annotations

from contact_estimation.estimators.gradient_speed import stiffest_wall
from core_runs import pipeline_with
import numpy as np
import pytest


def test_the_stiffest_wall_is_adapted_to_within_two_seconds_under_50_n() -> None:
    gain, T = 5e4, 1e-4
    K, d, estimate = stiffest_wall(gain), 50.0 / stiffest_wall(gain), 0.0
    for _ in range(round(2.0 / T)):
        estimate -= T * gain * d * (estimate * d - K * d)  # eq. (25)
    assert estimate / K == pytest.approx(1.0 - np.exp(-1.0), rel=1e-3)


def test_normalised_gains_never_starve() -> None:
    tuning = {'tuning__indirect_adaptive__normalised': True}
    pipeline = pipeline_with(estimator='indirect_adaptive', **tuning)
    assert pipeline.limitation == ''


def test_the_paper_s_gains_state_their_limit_and_the_default_has_none() -> None:
    limited = pipeline_with(estimator='indirect_adaptive').limitation
    assert '1.58e+04 N/m' in limited and 'normalised' in limited
    assert pipeline_with().limitation == ''
