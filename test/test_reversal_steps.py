# Copyright 2026 contact_estimation authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""Friction of a joint that is named by the reversals of its motion, though others push it more."""

from __future__ import annotations

from functools import lru_cache

from concealed_worlds import diagnosed, named, nominal, prepared_from
from contact_estimation.diagnosis.fit.reversal_steps import reversal_steps, ReversalSteps
from contact_estimation.diagnosis.observe.signals import Signals
from contact_estimation.diagnosis.report.text_report import as_text
from contact_estimation.plant.plant_parameters import PlantParameters
import numpy as np
import pytest

FRICTION, MASS, DRAG = 0.5, 0.05, 0.8
NO_REFERENCE = (np.empty(0), np.empty((4, 0)))
RAD_S = 2.0 * np.pi * np.array([0.11, 0.23, 0.31])
PUSHING = 2.0 * np.pi * np.array([0.05, 0.13, 0.19])  # the other joints


def model() -> PlantParameters:
    """Give the model of the joint without friction."""
    return nominal(environment__stiffness=0.0, environment__damping=DRAG,
                   environment__inertia=MASS, environment__unilateral=False)


@lru_cache(maxsize=None)
def joint(friction: float, pushed: float) -> Signals:
    """Record the torque of a joint that moves as the others do; the motion is exact."""
    t = np.arange(0.0, 30.0, 0.008)
    wave, push = np.exp(1j * np.outer(RAD_S, t)), np.exp(1j * np.outer(PUSHING, t))
    x, v, a = (0.3 * np.sum((1j * RAD_S[:, None])**n * wave, axis=0).real for n in range(3))
    torque = MASS * a + DRAG * v + friction * np.sign(v) + pushed * push.sum(axis=0).imag
    noise = np.random.default_rng(4).normal(size=(2, len(t)))
    return Signals(t, -torque + 0.02 * noise[0], t, x + 2e-5 * noise[1], *NO_REFERENCE)


def steps_of(friction: float, pushed: float) -> ReversalSteps:
    """Measure the steps beside the true model."""
    recording, start = prepared_from(joint(friction, pushed), model())
    return reversal_steps([recording], start)


def test_each_reversal_tells_the_friction() -> None:
    steps = steps_of(FRICTION, 1.0)
    assert len(steps.sizes) >= 10
    assert float(np.mean(steps.sizes)) == pytest.approx(FRICTION, rel=0.1)
    assert steps.misfit > 2.0 * FRICTION
    assert steps.are_friction


@pytest.mark.parametrize('friction', [0.0, -FRICTION, 0.03])
def test_no_step_none_along_the_motion_and_no_small_one_is_friction(friction: float) -> None:
    assert not steps_of(friction, 1.0).are_friction


def test_friction_is_named_beside_what_is_larger() -> None:
    found = diagnosed(joint(FRICTION, 1.0), model())
    assert (found.verdict, named(found)) == ('unexplained', ['coulomb_friction'])
    assert found.effects[0].mark is not None
    assert 'reversals. A larger effect is unexplained' in as_text(found).replace('\n', ' ')


def test_nothing_is_named_where_the_others_push_alone() -> None:
    assert named(diagnosed(joint(0.0, 1.0), model())) == []
