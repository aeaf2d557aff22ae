# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Parts of recordings with few contacts, and what is decided from them."""

from __future__ import annotations

from functools import lru_cache

from concealed_worlds import diagnosed, nominal, prepared_from, recorded, touches
from contact_estimation.diagnosis.conclude.result import Errors
from contact_estimation.diagnosis.fit.fitting import Fit, fit
from contact_estimation.diagnosis.fit.parts import parts_of
from contact_estimation.diagnosis.observe.prepared_recording import PreparedRecording
from contact_estimation.diagnosis.observe.signals import Signals
import numpy as np
import pytest

SPRING = nominal(environment__stiffness=1000.0, environment__damping=5.0,
                 environment__unilateral=False)


@lru_cache(maxsize=None)
def prepared() -> tuple[PreparedRecording, Fit]:
    """Record two touches and fit the right model."""
    recording, model = prepared_from(recorded(touches((0.03, 1.0), (0.024, 0.8))))
    return recording, fit([recording], model)


def test_parts_of_few_contacts_hold_every_sample_once_with_the_free_flight() -> None:
    recording, base = prepared()
    parts = parts_of([recording], base)
    assert len(parts) == 4
    counted = np.sum([part.there for part in parts], axis=0)
    filled = np.concatenate([one.filled for one in recording.channels(base.model)])
    fitted = np.tile(recording.blocks(recording.use.astype(float)) > 0.0, 2)
    assert (counted[filled & fitted] == 1).all() and counted.max() == 1


def spring(cubic: float, stray: float, noise_std: float = 1e-3) -> Signals:
    """Record an attached spring with a curvature; its force also strays by so much [N]."""
    t = np.arange(2000) / 100.0
    x = 0.01 * np.sin(2.0 * t) + 0.005 * np.sin(5.3 * t)
    v = 0.02 * np.cos(2.0 * t) + 0.0265 * np.cos(5.3 * t)
    force = 1000.0 * x + 5.0 * v + cubic * x**3 + stray * np.sin(0.7 * t) * np.sin(3.1 * t)
    noise = np.random.default_rng(4).normal(0.0, noise_std, len(t))
    return Signals(t, noise - force, t, x, np.empty(0), np.empty((4, 0)))


def test_a_spring_that_bends_and_rubs_lacks_both_laws() -> None:
    signals = spring(2e6, 0.1)
    rubbed = 1.0 * np.tanh(np.gradient(signals.position, signals.joint_t) / 1e-3)
    found = diagnosed(signals._replace(force=signals.force - rubbed), SPRING)
    assert {effect.family for effect in found.effects} == {'elastic_law', 'friction'}
    assert found.verdict == 'physics_missing'


def test_a_single_event_does_not_hide_a_law_that_holds_everywhere_else() -> None:
    signals = spring(2e6, 0.0)
    hit = signals.force + np.where(abs(signals.wrench_t - 4.3) < 0.2, 3.0, 0.0)
    found = diagnosed(signals._replace(force=hit), SPRING)
    assert [effect.family for effect in found.effects] == ['elastic_law']


@pytest.mark.parametrize('recalibrated, corrected, noise, share', [
    (1.0, 0.5, 0.0, 0.75), (1.0, 0.3, 0.3, 1.0), (1.0, 1.2, 0.3, -0.4835),
    (0.34, 0.31, 0.3, None), (None, None, 0.3, None)])
def test_held_out_data_tell_the_share_that_names_explain_beyond_noise(
    recalibrated: float | None, corrected: float | None, noise: float, share: float | None
) -> None:
    told = Errors(3.0, recalibrated, corrected).explained(noise, 0.2)
    assert told == (None if share is None else pytest.approx(share, abs=1e-3))
