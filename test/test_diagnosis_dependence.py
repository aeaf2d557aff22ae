# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Dependence of residuals on time, motion, frequency and their own past."""

from __future__ import annotations

from functools import lru_cache

from concealed_worlds import physics, prepared_from, recorded
from contact_estimation.diagnosis.conclude.dependence import Dependence, dependences
from contact_estimation.diagnosis.fit.fitting import fit
from contact_estimation.diagnosis.fit.model_uncertainty import discounted
from contact_estimation.diagnosis.observe.model import Model
from contact_estimation.diagnosis.observe.prepared_recording import PreparedRecording
from contact_estimation.diagnosis.observe.residuals import residuals
import numpy as np
import pytest

EFFECTS = {
    'coulomb_friction': (2.0,), 'cubic_stiffness': (3e6,), 'force_drift': (0.6,),
    'tool_inertia': (1.0,), 'robot_friction': (3.0,),
}


@lru_cache(maxsize=None)
def recalibrated(name: str = '') -> tuple[PreparedRecording, Model]:
    """Fit stiffness and damping alone in the world of an effect, '' for none."""
    recording, model = prepared_from(recorded(**physics(name, *EFFECTS[name]) if name else {}))
    recording = discounted(recording, model)
    return recording, fit([recording], model).model


def found_in(name: str, channel: str) -> dict[str, Dependence]:
    """Test the residual of one channel."""
    every = dependences(*recalibrated(name), np.random.default_rng(0))
    return {one.on: one for one in every if one.channel == channel}


@pytest.mark.slow
@pytest.mark.parametrize('name, channel, on', [
    ('coulomb_friction', 'force', 'velocity'), ('cubic_stiffness', 'force', 'depth'),
    ('force_drift', 'force', 'time'), ('tool_inertia', 'force', 'acceleration'),
    ('robot_friction', 'motion', 'its own past'),
])
def test_residual_depends_on_the_quantity_of_the_missing_law(
    name: str, channel: str, on: str
) -> None:
    found = found_in(name, channel)
    assert found[on].is_real
    others = [one.share for key, one in found.items() if key not in ('its own past', 'frequency')]
    assert found[on].share >= max(others)


def test_share_is_the_explained_part_of_the_mean_square() -> None:
    recording, model = recalibrated('coulomb_friction')
    found = found_in('coulomb_friction', 'force')['direction']
    force = recording.split(residuals(recording, model, robust=False))[0][recording.force.filled]
    span = round(0.5 / (recording.observed.h * recording.block))
    force = force[:len(force) // span * span]
    o, law = recording.observed, model.laws().contact
    errors: dict[str, list[float]] = {name: [] for name in found.names}
    inside = recording.blocks(law.contact(o.t, o.x, o.v).astype(float))[recording.force.filled]
    rate = recording.blocks(o.v)[recording.force.filled]
    for error, touching, v in zip(force, inside, rate):
        direction = 'loading' if v > 0.0 else 'unloading'
        errors[direction if touching > 0.5 else 'free'].append(error)
    means = [np.mean(errors[name]) for name in found.names]
    np.testing.assert_allclose(found.mean, means)
    explained = sum(len(errors[name]) * mean**2 for name, mean in zip(found.names, means))
    assert found.share == pytest.approx(explained / float(force @ force))
    assert means[0] * means[1] < 0.0  # friction changes its sign
