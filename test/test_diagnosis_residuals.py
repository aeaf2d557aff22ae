# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Residuals of correct and wrong models in the channels of a recording."""

from __future__ import annotations


from concealed_worlds import FORCE_NOISE, prepared_from, recorded
from contact_estimation.diagnosis.fit.model_uncertainty import discounted
from contact_estimation.diagnosis.observe.model import Model
from contact_estimation.diagnosis.observe.observed import Observed
from contact_estimation.diagnosis.observe.prepared_recording import PreparedRecording
from contact_estimation.diagnosis.observe.residuals import force_residual, residuals
from contact_estimation.diagnosis.observe.usable_samples import force_drops
import numpy as np
from numpy.typing import NDArray
import pytest

Array = NDArray[np.float64]


def mean_squares(recording: PreparedRecording, model: Model) -> tuple[float, float]:
    """Return the mean square residual of a model in both channels, in that of the noise."""
    recording = discounted(recording, model)
    parts = np.split(residuals(recording, model, robust=False), 2)
    force, motion = (float(np.mean(part[part != 0.0] ** 2)) for part in parts)
    return force, motion


def test_force_residual_of_the_true_model_is_the_sensor_s_noise() -> None:
    recording, model = prepared_from(recorded())
    residual = force_residual(recording, model)[recording.use]
    assert np.std(residual) == pytest.approx(FORCE_NOISE, rel=0.05)
    assert abs(np.mean(residual)) < 4.0 * FORCE_NOISE / np.sqrt(len(residual))


def test_dropped_wrenches_do_not_count() -> None:
    signals = recorded()
    kept = np.ones(len(signals.force), bool)
    kept[600:620] = kept[1000::37] = False
    kept[-1] = True
    wrong = np.where(kept, signals.force, 1e3)
    lossy = signals._replace(wrench_t=signals.wrench_t[kept], force=wrong[kept])
    recording, model = prepared_from(lossy)
    assert len(recording.observed.t) == len(signals.force)
    np.testing.assert_array_equal(recording.observed.measured, kept)
    force, motion = mean_squares(recording, model)
    assert force == pytest.approx(1.0, abs=0.2)
    assert motion == pytest.approx(1.0, abs=0.3)


def observed_force(force: Array) -> Observed:
    """Make an observation of which the force alone counts."""
    t, nothing = np.linspace(0.0, 0.004 * (len(force) - 1), len(force)), np.zeros(len(force))
    return Observed(t, 0.004, force, np.ones(len(force), bool), nothing, nothing, nothing,
                    nothing, None, 1e-6, 20.0)


def pressed(drops: int, samples: int) -> Array:
    """Press for four seconds, and vanish for some samples every now and then."""
    force = np.zeros(1200)
    force[100:1100] = -50.0
    for k in range(drops):
        force[200 + 150 * k:200 + 150 * k + samples] = 0.0
    return force + 0.1 * np.random.default_rng(1).standard_normal(1200)


EVERYWHERE = np.ones(1200, bool)


def test_force_drops_during_contact_are_found() -> None:
    found = force_drops(observed_force(pressed(4, 20)), 0.1, EVERYWHERE)
    assert found is not None
    expected = pressed(4, 20) > -25.0
    expected[:100] = expected[1100:] = False
    np.testing.assert_array_equal(found, expected)


def test_reference_reaches_a_late_robot_later() -> None:
    recording, _ = prepared_from(recorded())
    o = recording.observed
    assert o.reference is not None
    late = o.reference_at(3.0 * o.h)
    np.testing.assert_allclose(late[:, 3:], o.reference[:, :-3], atol=1e-9)
    np.testing.assert_array_equal(o.reference_at(0.0), o.reference)
