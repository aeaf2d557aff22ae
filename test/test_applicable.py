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

"""Which effects recordings may show."""

from __future__ import annotations

from concealed_worlds import ATTACHED, nominal, prepared_from, recorded
from contact_estimation.diagnosis.conclude.diagnose import diagnose
from contact_estimation.diagnosis.fit.applicable import (
    candidates_for,
    candidates_in,
    is_single_stroke,
)
from contact_estimation.diagnosis.observe.model import Model
from contact_estimation.diagnosis.observe.signals import Recording, Signals
from contact_estimation.physics import EFFECTS
import numpy as np
import pytest

MODEL = Model.of(nominal())
OF_TOUCH = [name for name, cls in EFFECTS.items() if not cls.needs_attachment]


def test_every_effect_of_a_wall_may_be_added_where_there_is_a_robot() -> None:
    assert candidates_for(MODEL, True) == OF_TOUCH


def test_what_shows_in_the_motion_alone_needs_a_robot() -> None:
    left_out = set(OF_TOUCH) - set(candidates_for(MODEL, False))
    of_robot = {name for name, cls in EFFECTS.items() if cls.port == 'robot'}
    assert left_out == {*of_robot, 'force_gain', 'force_nonlinearity', 'tool_weight'}


def test_a_play_needs_more_than_one_reversal() -> None:
    left_out = set(OF_TOUCH) - set(candidates_for(MODEL, True, plays=False))
    assert left_out == {'backlash'}
    signals = recorded()  # of which one contact, out of three
    once = signals.wrench_t < 1.9
    force, held = signals.force[once], np.repeat(signals.position[once][-1], 200)
    t = signals.wrench_t[:len(force) + len(held)]
    x = np.concatenate((np.maximum.accumulate(signals.position[once]), held))
    signals = Signals(t, np.concatenate((force, 0.1 * held)), t, x, t[:0], np.empty((4, 0)))
    recording, model = prepared_from(signals)
    assert 'backlash' not in candidates_in([recording], model)
    assert 'backlash' in candidates_in([prepared_from(recorded())[0]], model)


@pytest.mark.parametrize('mass, found', [(0.0, True), (2.0, False)])
def test_a_gear_may_have_play_unless_the_force_moves_a_mass(mass: float, found: bool) -> None:
    gear = nominal(**{**ATTACHED, 'environment__inertia': mass})
    assert ('backlash' in candidates_for(Model.of(gear), False)) is found


def test_effect_is_not_added_twice() -> None:
    rubbing = MODEL.with_effect('coulomb_friction', (1.0,))
    assert 'coulomb_friction' not in candidates_for(rubbing, True)


def test_attached_wall_has_no_effects_of_touching_and_one_inertia() -> None:
    names = set(candidates_for(Model.of(nominal(**ATTACHED)), False))
    drive = Model.of(nominal(**{**ATTACHED, 'environment__stiffness': 0.0}))
    assert names - set(candidates_for(drive, False)) == {
        'beating_environment', 'bouc_wen_hysteresis', 'contact_offset', 'fractional_relaxation',
        'free_play', 'moving_environment', 'stiffness_drift', 'viscoelastic_relaxation'}
    assert 'environment_inertia' not in names
    assert not any(EFFECTS[name].needs_touch for name in names)
    assert {'cubic_stiffness', 'force_bias'} <= names


def test_pressed_wall_alone_has_laws_of_a_side_on_which_it_loads() -> None:
    wall = Model.of(nominal(**ATTACHED))
    pulled, pressed = (set(candidates_for(wall, False, pressed)) for pressed in (False, True))
    assert pressed - pulled == {
        'hunt_crossley_damping', 'plastic_set', 'power_law_stiffness', 'unloading_hysteresis'}


@pytest.mark.parametrize('back, lost, returns', [
    (0.2, 1.0, True),  # what yields is unloaded by little motion
    (0.2, 0.2, False), (0.02, 1.0, False),
    (0.6, 0.2, True)])
def test_hysteresis_needs_a_motion_or_a_force_that_returns(
    back: float, lost: float, returns: bool
) -> None:
    t = np.arange(0.0, 20.005, 0.01)
    x, force = (10.0 * np.interp(t, [0.0, 2.0, 14.0, 20.0], [0.0, first, 1.0, 1.0 - part])
                for first, part in ((0.2, back), (0.9, lost)))
    noise = np.random.default_rng(4).normal(0.0, 0.01, len(t))
    signals = Signals(t, noise - force, t, 1e-3 * x, t[:0], np.empty((4, 0)))
    recording, model = prepared_from(signals, nominal(**ATTACHED))
    assert ('bouc_wen_hysteresis' in candidates_in([recording], model)) is returns
    assert is_single_stroke([recording]) is not returns


@pytest.mark.parametrize('stiffness, found', [(0.0, True), (50.0, True), (2000.0, False)])
def test_one_cycle_shows_an_asymmetric_damper_but_no_asymmetry_of_a_spring(
    stiffness: float, found: bool
) -> None:
    t = np.arange(0.0, 12.0, 0.01)
    x, v = 0.05 * np.sin(6.0 * t), 0.3 * np.cos(6.0 * t)
    noise = np.random.default_rng(8).normal(0.0, 0.5, len(t))
    force = noise - stiffness * x - 200.0 * v - 80.0 * np.abs(v)
    signals = Signals(t, force, t, x, t[:0], np.empty((4, 0)))
    damper = nominal(environment__unilateral=False, environment__stiffness=stiffness,
                     environment__damping=220.0)
    recording, model = prepared_from(signals, damper)
    assert ('asymmetric_damping' in candidates_in([recording], model)) is found
    if found:
        names = [one.name for one in diagnose(Recording('dyno.mcap', signals), damper).effects]
        assert names == ['asymmetric_damping']
