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

"""The search for effects: what may be taken, and what is worth taking."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from typing import Any, Callable

from concealed_worlds import ATTACHED, attached, nominal, physics, prepared_from, recorded
from contact_estimation.diagnosis.fit import (
    ranking as ranking_module,
    search as search_module,
    selection as selection_module,
)
from contact_estimation.diagnosis.fit.candidate import Candidate
from contact_estimation.diagnosis.fit.criteria import (
    enough,
    leaves_noise,
    noise_scale,
    penalty,
    PRICE,
    SHARE,
    THRESHOLD,
)
from contact_estimation.diagnosis.fit.discrepancy import has_discrepancy
from contact_estimation.diagnosis.fit.exact_laws import prune, Rivals, simplest_first
from contact_estimation.diagnosis.fit.fitting import Fit, fit
from contact_estimation.diagnosis.fit.model_uncertainty import discounted
from contact_estimation.diagnosis.fit.same_effects import with_effects_kept
from contact_estimation.diagnosis.fit.scales import measure_scales
from contact_estimation.diagnosis.fit.search import is_credible, nearest, search
from contact_estimation.diagnosis.fit.selection import select, Selection, weigh
from contact_estimation.diagnosis.observe.model import Model, names_of
from contact_estimation.diagnosis.observe.prepared_recording import PreparedRecording, Recordings
from contact_estimation.diagnosis.observe.residuals import residuals
from contact_estimation.diagnosis.observe.signals import Signals
import numpy as np
from numpy.typing import NDArray
import pytest

MODEL = Model.of(nominal())
DRIVE = nominal(environment__stiffness=0.0, environment__damping=60.0,
                environment__unilateral=False)
COUNT = 1000


@lru_cache(maxsize=None)
def prepared(*changes: tuple[str, Any]) -> tuple[PreparedRecording, Fit]:
    """Recalibrate the nominal model on a world's recording."""
    recording, model = prepared_from(recorded(**dict(changes)))
    recording = discounted(recording, fit([recording], model).model)
    return recording, fit([recording], model)


def with_cost(cost: float, *effects: str) -> Fit:
    """Make a fit of a given cost."""
    model = MODEL
    for name in effects:
        model = model.with_effect(name, (1.0,) * len(names_of(name)))
    return Fit(model, cost, np.zeros(COUNT), COUNT)


def moved(force: Callable[[NDArray[np.float64]], NDArray[np.float64]]) -> PreparedRecording:
    """Record a drive that moves to and fro, with noise in the force."""
    t = np.arange(3000) / 250.0
    v = 0.5 * np.cos(1.7 * t) + 0.3 * np.cos(4.1 * t)
    x = 0.5 / 1.7 * np.sin(1.7 * t) + 0.3 / 4.1 * np.sin(4.1 * t)
    measured = -force(v) + np.random.default_rng(4).normal(0.0, 0.4, len(t))
    return prepared_from(Signals(t, measured, t, x, np.empty(0), np.empty((4, 0))), DRIVE)[0]


def test_a_force_held_most_of_the_time_to_and_fro_is_no_saturating_sensor() -> None:
    steep = Model.of(DRIVE).at((0.0, 1000.0)).with_effect('force_saturation', (8.0,))
    assert not is_credible([moved(lambda v: 8.0 * np.tanh(v / 0.01))], steep)
    gentle = Model.of(DRIVE).with_effect('force_saturation', (35.0,))
    assert is_credible([moved(lambda v: np.clip(60.0 * v, -35.0, 35.0))], gentle)


def test_a_force_that_is_level_since_the_depth_is_held_is_no_saturating_sensor() -> None:
    t = np.arange(3000) / 250.0
    x = 0.01 * np.clip(np.interp(t, [0.0, 1.0, 2.0, 6.0, 7.0, 12.0], [0, 0, 1, 1, 0.4, 0.4]), 0, 1)
    force = -1000.0 * x + np.random.default_rng(4).normal(0.0, 0.05, len(t))
    spring = nominal(environment__stiffness=1000.0, environment__damping=1.0,
                     environment__unilateral=False)
    held, start = prepared_from(Signals(t, force, t, x, np.empty(0), np.empty((4, 0))), spring)
    assert not is_credible([held], start.with_effect('force_saturation', (9.98,)))


@pytest.mark.parametrize(('missing', 'effects', 'alike', 'kept'), [
    ('cubic_stiffness', ('cubic_stiffness',), False, True),
    ('cubic_stiffness', ('cubic_stiffness', 'force_bias'), True, False),
    ('coulomb_friction', ('presliding_friction',), True, True),
    ('coulomb_friction', ('presliding_friction',), False, False),
    ('coulomb_friction', (), True, False),
])
def test_effects_stay_where_each_is_needed_and_no_search_would_find_more(
    missing: str, effects: tuple[str, ...], alike: bool, kept: bool
) -> None:
    sizes = {'cubic_stiffness': (3e6,), 'presliding_friction': (1.0, 1e5)}
    recording, base = prepared(*physics(missing, sizes.get(missing, (3.0,))[0]).items())
    best = base
    for name in effects:
        best = fit([recording], best.model.with_effect(name, sizes.get(name, (0.1,))))
    after = with_effects_kept(
        [recording], base, Selection([recording], base, best, Rivals(), {}), alike)
    assert (after is not None) is kept
    if after is not None:
        assert after.best.model.effects == effects
        assert has_discrepancy(after.recordings) is (missing not in effects)


@pytest.mark.slow
@pytest.mark.parametrize(('bias', 'sought'), [(0.15, False), (0.3, True)])
def test_beside_a_large_effect_none_is_sought_in_what_is_nearly_noise(
    bias: float, sought: bool
) -> None:
    recording, base = prepared(
        *physics('cubic_stiffness', 2e7).items(), *physics('force_bias', bias).items())
    alone = fit([recording], base.model.with_effect('cubic_stiffness', (2e7,)))
    assert leaves_noise(alone) is not sought
    assert alone.cost > 1.2 * alone.residual_count
    expected = {'cubic_stiffness', 'force_bias'} if sought else {'cubic_stiffness'}
    assert set(select([recording], base).best.model.effects) == expected


@pytest.mark.parametrize(('cost', 'first'), [
    (940.0, 'presliding_friction'), (960.0, 'bouc_wen_hysteresis'),
    (1010.0, 'bouc_wen_hysteresis')])
def test_simplest_law_that_leaves_noise_is_first_unless_it_is_worse_beyond_doubt(
    cost: float, first: str
) -> None:
    fits = [with_cost(900.0, 'bouc_wen_hysteresis'), with_cost(cost, 'presliding_friction')]
    assert simplest_first(fits, 5000.0)[0].model.effects == (first,)


def test_simplest_law_that_leaves_little_more_than_one_near_the_noise_is_first() -> None:
    for cost, first in ((1600.0, 'presliding_friction'), (2000.0, 'bouc_wen_hysteresis')):
        fits = [with_cost(1500.0, 'bouc_wen_hysteresis'), with_cost(cost, 'presliding_friction')]
        assert simplest_first(fits, 5000.0)[0].model.effects == (first,)


def test_parameters_of_effects_are_priced() -> None:
    assert penalty(MODEL) == 0.0
    assert penalty(with_cost(0.0, 'coulomb_friction').model) == PRICE
    assert penalty(with_cost(0.0, 'stribeck_friction').model) == 3.0 * PRICE


def test_law_that_replaces_a_parameter_is_priced_less() -> None:
    assert penalty(with_cost(0.0, 'hunt_crossley_damping').model) == 0.0
    assert penalty(with_cost(0.0, 'power_law_stiffness').model) == PRICE


def test_scale_is_that_of_the_residuals_and_never_below_the_noise() -> None:
    assert noise_scale(with_cost(2.5 * COUNT)) == 2.5
    assert noise_scale(with_cost(0.5 * COUNT)) == 1.0


@pytest.mark.parametrize('gain, expected', [(0.5, False), (0.99, False), (1.01, True)])
def test_least_gain_is_a_share_of_the_residuals_and_the_price(
    gain: float, expected: bool
) -> None:
    least = THRESHOLD * COUNT + PRICE
    before, after = with_cost(COUNT), with_cost(COUNT - gain * least, 'coulomb_friction')
    assert enough(before, after) is expected


@pytest.mark.parametrize('share, expected', [(0.9 * SHARE, False), (1.1 * SHARE, True)])
def test_effect_must_explain_a_fair_share_of_the_misfit(share: float, expected: bool) -> None:
    excess = 4.0 * COUNT
    before = with_cost(COUNT + excess)
    after = with_cost(COUNT + (1.0 - share) * excess, 'coulomb_friction')
    assert enough(before, after) is expected


def test_search_ranks_the_true_effect_first() -> None:
    recording, base = prepared(*physics('quadratic_damping', 600.0).items())
    told: list[str] = []
    names = ['cubic_stiffness', 'quadratic_damping', 'force_bias', 'force_lag']
    found = search([recording], base, told.append, names)
    assert told == names
    assert found[0].model.effects == ('quadratic_damping',)
    assert found[0].model.values[-1] == pytest.approx(600.0, rel=0.05)


@pytest.mark.slow
@pytest.mark.parametrize('K_2, depth', [(300.0, 0.011), (5000.0, 0.009)])
def test_search_finds_the_depth_of_a_second_spring(K_2: float, depth: float) -> None:
    recording, base = prepared(*physics('bilinear_stiffness', K_2, depth).items())
    (found,) = search([recording], base, lambda name: None, ['bilinear_stiffness'])
    assert found.model.values[2:] == pytest.approx((K_2, depth), rel=0.05)


@pytest.mark.parametrize('names, curve_ends', [
    (['stiffness_drift'], True), (['stiffness_drift', 'coulomb_friction'], False)])
def test_curves_are_fitted_to_the_end_where_no_law_leads_them(
    monkeypatch: pytest.MonkeyPatch, names: list[str], curve_ends: bool
) -> None:
    recording, model = prepared_from(recorded(**physics('coulomb_friction', 2.0)))
    base, ended = fit([recording], model), list[str]()

    def to_end(recordings: Recordings, found: Fit) -> Fit:
        ended.append(found.model.effects[-1])
        return found

    monkeypatch.setattr(search_module, 'fit_to_end', to_end)
    search([recording], base, lambda name: None, names)
    assert ('stiffness_drift' in ended) is curve_ends


def test_implausible_values_are_not_found(monkeypatch: pytest.MonkeyPatch) -> None:
    recording, base = prepared(*physics('coulomb_friction', 2.0).items())
    assert not search([recording], base, lambda name: None, ['stribeck_friction'])
    monkeypatch.setattr(Model, 'plausible', lambda self: True)
    assert search([recording], base, lambda name: None, ['stribeck_friction'])


@pytest.mark.slow
def test_selection_of_an_effect_has_rivals_and_evidence() -> None:
    recording, base = prepared(*physics('force_delay', 0.006).items())
    selection = select([recording], base)
    assert selection.best.model.effects == ('force_delay',)
    assert selection.rivals['force_delay'][0].model.effects == ('force_lag',)
    assert max(selection.evidence, key=lambda name: selection.evidence[name]) == 'force_delay'
    assert selection.evidence['force_delay'] > 0.9


@pytest.mark.slow
def test_motion_quieter_than_its_noise_does_not_hide_what_the_force_lacks() -> None:
    recording, base = prepared(*physics('force_delay', 0.0009).items())
    recording = replace(recording, motion_noise=3.0 * recording.motion_noise)
    base = fit([recording], base.model)
    assert base.cost < base.residual_count
    assert select([recording], base).best.model.effects[0] in ('force_delay', 'force_lag')


@pytest.mark.slow
def test_a_law_is_selected_by_prediction_alone_too() -> None:
    recording, base = prepared(*physics('coulomb_friction', 2.0).items())
    assert select([recording], base, by_likelihood=False).best.model.effects == (
        'coulomb_friction',)


def test_superfluous_effect_is_pruned() -> None:
    recording, base = prepared(*physics('coulomb_friction', 2.0).items())
    both = base.model.with_effect('coulomb_friction', (2.0,)).with_effect('force_bias', (0.0,))
    rivals: Rivals = {'coulomb_friction': [], 'force_bias': []}
    best, rivals = prune([recording], fit([recording], both), rivals)
    assert best.model.effects == ('coulomb_friction',)
    assert set(rivals) == {'coulomb_friction'}


@pytest.mark.slow
def test_scales_are_those_of_the_recording() -> None:
    recording, base = prepared(*physics('moving_environment', 0.0003, 1.7, 0.7).items())
    scales, o = measure_scales([recording], base), recording.observed
    assert scales.depth == pytest.approx(float(np.max(o.x)), rel=1e-6)
    assert scales.force == pytest.approx(float(np.max(np.abs(o.force))))
    assert scales.duration == pytest.approx(7.296)
    assert scales.mass == 12.0
    assert min(abs(frequency - 1.7) for frequency, _ in scales.peaks()) < 0.1


def test_attached_wall_has_scales_too() -> None:
    recording, model = prepared_from(attached(), nominal(**ATTACHED))
    scales = measure_scales([recording], fit([recording], model))
    assert scales.spectrum == ()
    assert scales.depth == pytest.approx(float(np.max(np.abs(recording.observed.x))), rel=1e-6)


def test_a_stop_that_no_force_shows_does_not_hold_the_prediction_at_the_measurement() -> None:
    recording, model = prepared_from(attached(), nominal(**ATTACHED))
    depth = 0.7 * float(np.max(recording.observed.x))
    costs = [float(np.sum(residuals(
        recording, model.with_effect('bilinear_stiffness', (K_2, depth))) ** 2))
        for K_2 in (1e8, 1e10)]
    assert costs[1] > 1e3 * costs[0]


@pytest.mark.parametrize('discrepancy', [True, False])
def test_best_candidate_of_the_motion_is_fitted_whatever_the_force_lacks(
    monkeypatch: pytest.MonkeyPatch, discrepancy: bool
) -> None:
    near = [with_cost(1000.0 + k, 'robot_friction') for k in range(30)]
    of_motion = near[-1]  # the worst of all, but for the motion
    of_family = near[25] = with_cost(1025.0, 'viscoelastic_relaxation')
    near[24] = with_cost(1024.0, 'viscous_flow')  # a curve

    def by_channel(recordings: object, found: Fit) -> np.ndarray:
        motion = 1.0 if found is of_motion else 0.1 * found.cost
        return np.array([found.cost - motion, motion])

    monkeypatch.setattr(search_module, 'costs_by_channel', by_channel)
    monkeypatch.setattr(search_module, 'has_discrepancy', lambda recordings: discrepancy)
    monkeypatch.setattr(
        search_module, 'is_flexible', lambda recordings, model, name: name == 'viscous_flow')
    kept = nearest([], near)
    assert kept[0] is near[0] and len(kept) < 20
    assert any(one is of_family for one in kept) and near[24] not in kept
    assert any(one is of_motion for one in kept) is discrepancy


@pytest.mark.parametrize('beside, left, named_beside', [
    (300.0, 0.9, True), (300.0, 0.0, False), (600.0, 0.9, False)])
def test_laws_beside_zeros_are_taken_where_a_law_alone_leaves_what_is_predictable(
    monkeypatch: pytest.MonkeyPatch, beside: float, left: float, named_beside: bool
) -> None:
    """The noise may be estimated too large; then nothing that a law leaves exceeds it."""
    alone = [with_cost(1000.0, 'viscoelastic_relaxation')]
    together = [with_cost(beside, 'force_bias', 'coulomb_friction')]
    level = with_cost(2000.0, 'force_bias')
    monkeypatch.setattr(selection_module, 'predictable_share', lambda one, model: left)
    monkeypatch.setattr(selection_module, 'fit', lambda recordings, model: level)
    monkeypatch.setattr(selection_module, 'search', lambda recordings, found, progress: together)
    monkeypatch.setattr(selection_module, 'exact_laws', lambda r, cost, found, strictly: found)
    recording, _ = prepared_from(recorded())
    laws = selection_module._beside_zeros([recording], with_cost(5000.0), alone, lambda name: None)
    assert laws is (together if named_beside else alone)


def test_a_curve_has_curves_as_rivals_and_a_law_has_laws() -> None:
    def candidate(name: str, total: float, flexible: bool) -> Candidate:
        left = np.array([[total, 0.0]])
        return Candidate(with_cost(1.0, name), left, left, None, flexible)

    law, curve = candidate('force_bias', 5.0, False), candidate('force_gain', 5.1, True)
    other = candidate('impedance_mismatch', 5.2, True)
    assert ranking_module._others([law, curve, other], curve, 100.0) == [law, other]
    assert ranking_module._others([law, curve, other], law, 100.0) == []


@pytest.mark.parametrize('in_force, in_motion, channel', [(90.0, 10.0, None), (10.0, 90.0, 1)])
def test_a_robot_is_judged_by_the_force_too_where_the_wall_was_fitted_to_its_motion(
    monkeypatch: pytest.MonkeyPatch, in_force: float, in_motion: float, channel: int | None
) -> None:
    present, found = with_cost(500.0), with_cost(400.0, 'impedance_mismatch')
    costs = {id(present): np.array([300.0, 200.0]),
             id(found): np.array([300.0 - in_force, 200.0 - in_motion])}
    monkeypatch.setattr(ranking_module, 'costs_by_channel', lambda r, one: costs[id(one)])
    assert ranking_module._channel([], present, found) == channel


@pytest.mark.parametrize('gain, noise', [(0.545, 0.02), (1.7, 0.2)])
def test_search_finds_a_gain_far_from_one_however_precise_the_force(
    gain: float, noise: float
) -> None:
    recording, base = prepared(*physics('force_gain', gain).items(),
                               ('sensors__force_noise', noise))
    carried, present = weigh([recording], base)
    found = search(carried, present, lambda name: None)
    assert found[0].model.effects == ('force_gain',)
    assert found[0].model.values[-1] == pytest.approx(gain, rel=0.01)


def test_coordinates_beside_a_gain_are_those_that_the_force_tells() -> None:
    model = MODEL.with_effect('force_gain', (0.5,))
    K_e, B_e, gain = model.coordinates
    assert (K_e, B_e) == pytest.approx((0.5 * model.stiffness, 0.5 * model.damping))
    moved = model.with_free(np.array([K_e, B_e, 2.0 * gain]))
    assert moved.stiffness == pytest.approx(0.5 * model.stiffness)
    assert moved.with_free(moved.coordinates).values == pytest.approx(moved.values)
