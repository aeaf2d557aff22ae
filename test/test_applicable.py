# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Which effects may be added to a model on a rig."""

from __future__ import annotations

from typing import Any

from concealed_worlds import ATTACHED, nominal, prepared_from
from contact_estimation.diagnosis.fit.applicable import candidates_in, untried
from contact_estimation.diagnosis.observe.model import Model
from contact_estimation.diagnosis.observe.prepared_recording import PreparedRecording
from contact_estimation.diagnosis.observe.signals import Signals
from contact_estimation.physics import EFFECTS
from contact_estimation.plant.plant_parameters import PlantParameters
import numpy as np

TO_AND_FRO = 0.01 * np.sin(3.0 * np.arange(2000) / 250.0)


def without_robot(
    x: np.ndarray, model: PlantParameters | None = None
) -> tuple[PreparedRecording, Model]:
    """Prepare a motion without a reference, and the force of a spring."""
    t = np.arange(len(x)) / 250.0
    force = -5000.0 * x + np.random.default_rng(4).normal(0.0, 0.05, len(t))
    return prepared_from(Signals(t, force, t, x, t[:0], np.empty((4, 0))), model)


def candidates(x: np.ndarray, **changes: Any) -> set[str]:
    """List the effects that may be added to a permanently attached wall."""
    recording, model = without_robot(x, nominal(**{**ATTACHED, **changes}))
    return set(candidates_in([recording], model))


def test_attached_wall_has_no_effects_of_touching_and_one_inertia() -> None:
    names = candidates(TO_AND_FRO)
    assert names - candidates(TO_AND_FRO, environment__stiffness=0.0) == {
        'beating_environment', 'bouc_wen_hysteresis', 'fractional_relaxation', 'free_play',
        'moving_environment', 'stiffness_drift', 'viscoelastic_relaxation'}
    assert 'environment_inertia' not in names
    assert not any(EFFECTS[name].needs_touch for name in names)
    assert {'cubic_stiffness', 'force_bias'} <= names


def test_families_that_are_not_tried_are_told_with_the_reason() -> None:
    x = 0.01 * np.interp(np.arange(2000), [0, 1200, 2000], [0.0, 1.0, 1.0])
    recording, model = without_robot(x, nominal(**ATTACHED))
    told = dict(untried([recording], model))
    assert told['friction'] == 'needs a motion that returns'
    assert told['adhesion'] == 'needs a contact that begins and ends'
    assert told['robot'] == 'needs the reference trajectory of a robot'
    tried = {EFFECTS[name].family for name in candidates_in([recording], model)}
    assert not tried & set(told)
    assert tried | set(told) == {cls.family for cls in EFFECTS.values()}
