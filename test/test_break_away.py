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

"""What one way, or one speed, tells of friction: it sticks before it slides, and no more."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

from concealed_worlds import nominal, prepared_from
from contact_estimation.diagnosis.conclude.diagnose import diagnose
from contact_estimation.diagnosis.conclude.result import Diagnosis
from contact_estimation.diagnosis.fit.applicable import (
    candidates_in,
    tells_time_from_path,
    told_by_a_return,
)
from contact_estimation.diagnosis.observe.signals import Recording, Signals
from contact_estimation.physics import EFFECTS
from contact_estimation.plant.plant_parameters import PlantParameters
import numpy as np
from numpy.typing import NDArray
import pytest

Array = NDArray[np.float64]

F_C, SIGMA, K_E, B_E = 12.0, 30000.0, 60.0, 20.0
T = np.arange(0.0, 30.0, 0.02)


def joint(stiffness: float = K_E) -> PlantParameters:
    """Describe a joint that is attached for good."""
    return nominal(environment__unilateral=False, environment__stiffness=stiffness,
                   environment__damping=B_E)


def signals(t: Array, x: Array, force: Array, noise: float = 0.05) -> Signals:
    """Measure a motion and the force of what is moved."""
    force = force + np.random.default_rng(5).normal(0.0, noise, len(t))
    return Signals(t, force, t, x, t[:0], np.empty((4, 0)))


def breaking_away() -> tuple[Array, Array]:
    """Push a joint that sticks, creeps and then slides, all one way, at several speeds."""
    x = np.asarray(np.interp(T, [0.0, 6.0, 12.0, 20.0, 26.0, 30.0],
                             [0.0, 4e-4, 1.2e-3, 0.03, 0.045, 0.1]))
    friction = F_C * (1.0 - np.exp(-SIGMA * x / F_C))
    return x, -K_E * x - B_E * np.gradient(x, T) - friction


@lru_cache(maxsize=None)
def diagnosed(kind: str) -> Diagnosis:
    """Diagnose a joint that breaks away, or one whose sensor has a bias alone."""
    x, force = breaking_away()
    if kind == 'biased':
        x = np.asarray(0.1 * T / 30.0 + 0.002 * np.sin(T))
        force = -K_E * x - B_E * np.gradient(x, T) - F_C
    return diagnose(Recording(f'{kind}.mcap', signals(T, x, force)), joint())


def test_friction_is_named_where_the_joint_sticks_before_it_slides() -> None:
    found = diagnosed('sticking').effects
    assert [effect.name for effect in found] == ['presliding_friction']
    assert found[0].parameters['F_c'].value == pytest.approx(F_C, rel=0.1)


def test_one_way_tells_no_friction_from_a_bias() -> None:
    first = diagnosed('biased').effects[0]
    assert first.name == 'force_bias'
    assert 'coulomb_friction' in first.indistinguishable_from


@pytest.mark.parametrize('late, found', [(0.0, True), (0.5, False)])
def test_presliding_is_sought_one_way_only_if_half_the_force_is_there_before_the_motion(
    late: float, found: bool
) -> None:
    x, force = breaking_away()
    softer = late * 40.0 * F_C * x / np.max(x)  # most of the force comes with the motion
    recording, model = prepared_from(signals(T, x, force - softer), joint())
    assert ('presliding_friction' in candidates_in([recording], model)) is found
    assert 'coulomb_friction' not in candidates_in([recording], model)
    assert 'coulomb_friction' in told_by_a_return([recording], model)


def test_nothing_is_left_to_a_return_where_the_motion_returns() -> None:
    x = np.asarray(0.05 * np.sin(T))
    recording, model = prepared_from(signals(T, x, -K_E * x), joint())
    assert told_by_a_return([recording], model) == []


@pytest.mark.parametrize('kind, tells', [
    ('triangle', False), ('sine', True), ('two speeds', True), ('rests', True)])
def test_one_speed_without_a_rest_tells_no_memory_of_time_from_one_of_the_path(
    kind: str, tells: bool
) -> None:
    x = {
        'triangle': np.abs((T / 5.0) % 2.0 - 1.0),
        'sine': np.sin(T),
        'two speeds': np.interp(T, [0.0, 5.0, 15.0, 20.0, 30.0], [0.0, 1.0, 0.0, 1.0, 0.0]),
        'rests': np.clip(2.0 * np.abs((T / 5.0) % 2.0 - 1.0), 0.5, 1.5),
    }[kind]
    recording, _ = prepared_from(signals(T, 0.05 * np.asarray(x), -K_E * x), joint())
    assert tells_time_from_path([recording]) is tells


@pytest.mark.parametrize('inexact, repeats, tells', [
    (True, True, False), (True, False, True), (False, True, True)])
def test_a_cycle_that_repeats_tells_no_memory_of_time_where_no_law_is_exact(
    inexact: bool, repeats: bool, tells: bool
) -> None:
    x = 0.05 * np.sin(T) * (1.0 if repeats else T / 30.0)
    recording, _ = prepared_from(signals(T, x, -K_E * x), joint())
    if inexact:
        recording = replace(recording, force_discrepancy=1.0)
    assert tells_time_from_path([recording]) is tells


@pytest.mark.parametrize('speeds, open_question', [((1.0, 1.0), True), ((1.0, 2.0), False)])
def test_a_damper_at_one_speed_may_be_dry_friction(
    speeds: tuple[float, float], open_question: bool
) -> None:
    first, second = (0.01 * speed * np.abs((np.arange(0.0, 15.0, 0.02) / 3.0) % 2.0 - 1.0)
                     for speed in speeds)
    x = np.concatenate((first, second))
    recorded = signals(T, x, -900.0 * np.gradient(x, T))
    found = diagnose(Recording('damper.mcap', recorded), nominal(
        environment__unilateral=False, environment__stiffness=0.0, environment__damping=800.0))
    assert found.effects == [] and found.verdict == 'recalibrate'
    assert ('dry friction' in found.next_experiment) is open_question


def test_a_memory_at_one_speed_lists_that_of_the_other_kind() -> None:
    x = 0.05 * np.abs((T / 5.0) % 2.0 - 1.0)
    tau, K_1 = 1.5, 400.0
    state, s = np.zeros(len(T)), 0.0
    for k, v in enumerate(np.gradient(x, T)):  # s' = K_1 v - s / tau
        s += 0.02 * (K_1 * v - s / tau)
        state[k] = s
    recorded = signals(T, x, -200.0 * x - state, noise=0.02)
    found = diagnose(Recording('ramps.mcap', recorded), joint(200.0)).effects
    families = {EFFECTS[name].family
                for name in (found[0].name, *found[0].indistinguishable_from)}
    assert 'relaxation' in families and families & {'friction', 'hysteresis'}
