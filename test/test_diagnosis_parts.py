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

"""Parts of recordings with few contacts, and what is decided from them."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from types import SimpleNamespace
from typing import Any

from concealed_worlds import diagnosed, named, nominal, prepared_from, recorded, touches
from contact_estimation.diagnosis.conclude import conclusion, decision as decision_module, trifles
from contact_estimation.diagnosis.conclude.alternatives import beside_zeros, in_family
from contact_estimation.diagnosis.conclude.conclusion import (
    _free_runs,
    _is_contradicted,
    _promises_more,
    _worse,
)
from contact_estimation.diagnosis.conclude.decision import decide, Decision
from contact_estimation.diagnosis.conclude.held_out import Part
from contact_estimation.diagnosis.conclude.result import Errors
from contact_estimation.diagnosis.conclude.shares import Shares, shares_of
from contact_estimation.diagnosis.fit import ranking as ranking_module
from contact_estimation.diagnosis.fit.criteria import SHARE
from contact_estimation.diagnosis.fit.fitting import Fit, fit
from contact_estimation.diagnosis.fit.parts import counts_of, evened, Part as FitPart, parts_of
from contact_estimation.diagnosis.fit.ranking import _is_little, _promising
from contact_estimation.diagnosis.fit.revision import _of_family, as_shown
from contact_estimation.diagnosis.fit.search import may_show
from contact_estimation.diagnosis.fit.selection import Selection, weigh
from contact_estimation.diagnosis.observe.model import Model
from contact_estimation.diagnosis.observe.prepared_recording import PreparedRecording
from contact_estimation.diagnosis.observe.signals import Signals
from contact_estimation.physics import EFFECTS
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


def test_parts_of_a_single_event_are_pieces_of_all_contacts() -> None:
    recording, base = prepared()
    first = parts_of([recording], base)[0]
    event = np.zeros_like(base.residuals)
    event[np.flatnonzero(first.there)[::2]] = 10.0  # in the first half of the first touch alone
    parts = parts_of([recording], base._replace(residuals=base.residuals + event))
    assert len(parts) == 4 and all(part.name.endswith('1 piece in 2') for part in parts)
    of_event = [float(np.sum(event[part.there] ** 2)) for part in parts]
    assert min(of_event[:2]) > 0.3 * sum(of_event) and sum(of_event[2:]) == 0.0


@pytest.mark.parametrize('attached', [True, False])
def test_parts_of_one_stroke_are_pieces_of_the_whole_stroke(attached: bool) -> None:
    # A spring that is stiffer from a depth on: no part before it tells of that.
    t = np.arange(2000) / 100.0
    noise = np.random.default_rng(4).normal(0.0, 1e-3, len(t))
    model = SPRING if attached else nominal(
        environment__stiffness=1000.0, environment__damping=0.0)
    for x, count in ((0.0005 * t, 5), (0.005 * (1.0 - np.cos(2.0 * t)), 1)):
        force = 1000.0 * x + 300.0 * np.maximum(x - 0.002, 0.0)
        signals = Signals(t, noise - force, t, x, np.empty(0), np.empty((4, 0)))
        recording, start = prepared_from(signals, model)
        parts = parts_of([recording], fit([recording], start))
        stretches = [np.count_nonzero(np.diff(part.there.astype(int)) == 1) for part in parts[1:]]
        assert len(parts) >= 4 and set(stretches) == {count}


def test_a_single_event_does_not_hide_a_law_that_holds_everywhere_else() -> None:
    recording, model = prepared_from(spring(2e6, 0.1), SPRING)
    base = fit([recording], model)
    carried, base = weigh([recording], base)
    law = fit(carried, base.model.with_effect('cubic_stiffness', (1e5,)))
    event = np.zeros_like(base.residuals)
    event[20:60] = 4.0 * np.abs(base.residuals).max()
    hit = [one._replace(residuals=one.residuals + event) for one in (base, law)]
    parts = parts_of(carried, hit[0])
    of_part = np.array([[part.squares(hit[0].residuals).sum(), 0.0] for part in parts])
    evenly = counts_of(evened(parts, of_part)[0], len(event))
    alike = np.ones(len(event))
    assert _promising(carried, base, [law], alike, None, SHARE) == [law]
    assert _promising(carried, hit[0], hit[1:], alike, None, SHARE) == []
    assert _promising(carried, hit[0], hit[1:], evenly, None, SHARE) == hit[1:]


@pytest.mark.parametrize('lacking, kept', [
    ((1e9, 120.0, 60.0, 50.0), (1.8e-7, 1.0, 1.0, 1.0)),  # which the rest does not determine
    ((1e9, 0.5, 0.4, 0.6), (0.005, 1.0, 1.0, 1.0))])  # an event beside trifles
def test_an_undetermined_part_does_not_make_what_others_lack_a_trifle(
    lacking: tuple[float, ...], kept: tuple[float, ...]
) -> None:
    count = 100
    parts = [FitPart(str(k), np.arange(4 * count) // count == k, np.zeros(count, dtype=int),
                     np.ones(count), np.array([0.01, 0.0])) for k in range(4)]
    found, squares = evened(parts, np.column_stack((lacking, np.zeros(4))))
    assert [part.counts for part in found] == pytest.approx(kept, rel=0.02)
    assert squares[:, 0] == pytest.approx([part.counts * one for part, one in zip(found, lacking)])


def spring(cubic: float, stray: float, noise_std: float = 1e-3) -> Signals:
    """Record an attached spring with a curvature; its force also strays by so much [N]."""
    t = np.arange(2000) / 100.0
    x = 0.01 * np.sin(2.0 * t) + 0.005 * np.sin(5.3 * t)
    v = 0.02 * np.cos(2.0 * t) + 0.0265 * np.cos(5.3 * t)
    force = 1000.0 * x + 5.0 * v + cubic * x**3 + stray * np.sin(0.7 * t) * np.sin(3.1 * t)
    noise = np.random.default_rng(4).normal(0.0, noise_std, len(t))
    return Signals(t, noise - force, t, x, np.empty(0), np.empty((4, 0)))


@pytest.mark.parametrize('constant, names', [(True, ['cubic_stiffness']), (False, [])])
def test_an_effect_smaller_than_the_noise_is_named_if_it_is_the_same_on_all_parts(
    constant: bool, names: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    if not constant:
        monkeypatch.setattr(Shares, 'is_constant', lambda self, name: False)
    assert named(diagnosed(spring(3e4, 0.0, 0.03), SPRING)) == names


def test_a_magnitude_is_constant_where_the_parts_that_tell_it_agree() -> None:
    recording, model = prepared_from(spring(2e6, 0.0), SPRING)
    law = fit([recording], model.with_effect('cubic_stiffness', (1e5,)))
    shares = shares_of([recording], fit([recording], model).model, law.model)
    assert shares.is_constant('cubic_stiffness')
    values, place = law.model.values, law.model.place('cubic_stiffness').start
    none = (*values[:place], 0.0)
    told = np.ones((len(shares.parts), len(values)))
    told[2:] = 0.01  # the others reach no limit, say, and tell nothing of it
    known = vars(shares)
    known['_alone'], known['_information'] = [values, values] + [none] * (len(told) - 2), told
    assert len(told) > 3 and shares.is_constant('cubic_stiffness')
    known['_information'] = np.ones_like(told)
    assert not shares.is_constant('cubic_stiffness')
    told[1] = 0.01
    known['_information'] = told  # one alone does not agree with itself
    assert not shares.is_constant('cubic_stiffness')


@pytest.mark.parametrize('cubic, stray, verdict, names', [
    (6e5, 0.1, 'physics_missing', ['cubic_stiffness']),
    (1.5e4, 0.0, 'physics_missing', ['cubic_stiffness']),
    (1.5e4, 0.02, 'recalibrate', []),
])
def test_an_inexact_law_is_named_only_if_it_is_no_trifle_beside_the_force(
    cubic: float, stray: float, verdict: str, names: list[str]
) -> None:
    diagnosis = diagnosed(spring(cubic, stray), SPRING)
    assert (diagnosis.verdict, named(diagnosis)) == (verdict, names)


@pytest.mark.parametrize('friction, stray, names', [
    (0.12, 0.06, ['friction']), (0.12, 0.08, []), (0.02, 0.06, []), (0.05, 0.02, [])])
def test_little_of_a_single_channel_is_named_if_one_law_explains_nearly_all_of_it(
    friction: float, stray: float, names: list[str]
) -> None:
    signals = spring(0.0, stray)
    rubbed = friction * np.sign(np.gradient(signals.position, signals.joint_t))
    assert friction < 0.01 * float(np.ptp(signals.force))
    diagnosis = diagnosed(signals._replace(force=signals.force - rubbed), SPRING)
    assert [effect.family for effect in diagnosis.effects] == names


@pytest.mark.parametrize('channel, size, little', [
    (0, 0.9, True), (0, 1.1, False), (None, 1.1, False), (1, 1.2, True), (1, 1.3, False)])
def test_more_must_show_in_the_motion_alone(
    channel: int | None, size: float, little: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(ranking_module, 'material', lambda recordings, model, share=1.0: (
        {channel or 0} if size >= share else set()))
    recording, base = prepared()
    bare = replace(recording, observed=replace(recording.observed, reference=None))
    assert _is_little([bare], base, channel) is little


def specimen_of_two_laws() -> tuple[list[PreparedRecording], Fit, Fit]:
    """Fit an attached spring that bends and rubs, with neither and with both laws."""
    signals = spring(2e6, 0.1)
    rubbed = 1.0 * np.tanh(np.gradient(signals.position, signals.joint_t) / 1e-3)
    recording, model = prepared_from(signals._replace(force=signals.force - rubbed), SPRING)
    base = fit([recording], model)
    bent = base.model.with_effect('cubic_stiffness', (2e6,))
    both = fit([recording], bent.with_effect('coulomb_friction', (1.0,)))
    carried, best = weigh([recording], both)
    return list(carried), fit(carried, base.model), best


@pytest.mark.parametrize('sure_together', [True, False])
def test_an_elastic_law_and_a_loss_that_are_sure_only_together_are_judged_together(
    monkeypatch: pytest.MonkeyPatch, sure_together: bool
) -> None:
    def unsure_alone(*arguments: Any) -> Shares:
        shares = shares_of(*arguments)
        if sure_together and arguments[-1]:
            return shares
        doubtful = {name: share._replace(interval=(-1.0, 1.0))
                    for name, share in shares.of_channel.items()}
        return replace(shares, of_channel=doubtful, beside=doubtful)

    monkeypatch.setattr(decision_module, 'shares_of', unsure_alone)
    recordings, base, best = specimen_of_two_laws()
    selection = Selection(recordings, base, best, {}, {})
    found = decide(selection, recordings, lambda name: None, again=False)
    assert found.best.model.effects == (best.model.effects if sure_together else ())


def test_a_zero_that_was_dropped_comes_back_where_the_law_fails_without_it() -> None:
    recordings, base, best = specimen_of_two_laws()
    zeroed = fit(recordings, best.model.with_effect('force_bias', (0.0,)))
    decision = Decision(Selection(recordings, base, best, {}, {}), best, False, 0.0, None)
    found = beside_zeros(Selection(recordings, base, zeroed, {}, {}), decision)
    assert found is not None and found.shares is not None
    assert found.best.model.effects == zeroed.model.effects and found.shares.explained > 0.9
    assert beside_zeros(decision.selection, decision) is None


def test_another_of_its_family_takes_the_place_of_a_law_the_best_fit_first() -> None:
    recordings, base, _ = specimen_of_two_laws()
    lawful = fit(recordings, base.model.with_effect('cubic_stiffness', (2e6,)))
    decision = Decision(Selection(recordings, base, lawful, {}, {}), lawful, False, 0.0, None)
    others = list(in_family(decision.selection, decision, lambda name: None))
    names = [one.best.model.effects[-1] for one in others]
    assert 'polynomial_stiffness' in names and 'cubic_stiffness' not in names
    assert {EFFECTS[name].family for name in names} == {'elastic_law'}
    assert not any(one.unexplained for one in others)
    costs = [one.best.cost for one in others]
    assert costs == sorted(costs)


@pytest.mark.parametrize('name, explained, sure, trifle', [
    ('robot_drag', 1.0, 0.3, True), ('robot_drag', 1.0, 0.9, False),
    ('force_lag', 0.7, 0.3, True), ('force_lag', 0.7, 0.65, False),
    ('force_lag', 1.0, 0.3, False)])  # the lesser of two exact laws
def test_little_is_named_only_if_it_surely_explains_most(
    monkeypatch: pytest.MonkeyPatch, name: str, explained: float, sure: float, trifle: bool
) -> None:
    # A controller that works in steps looks like a drag of 0.1 % of the force; every sensor has
    # a filter.
    best = Fit(Model.of(SPRING).with_effect(name, (1.0,)), 100.0, np.zeros(1), 100)
    monkeypatch.setattr(trifles, 'fit_without', lambda recordings, model, names: best)
    monkeypatch.setattr(trifles, 'weighed', lambda recordings, model: [])
    shares: Any = SimpleNamespace(
        best=best, explained=explained, sure=lambda of: sure, is_constant=lambda of: True)
    assert trifles.is_trifle([], shares, name) is trifle


@pytest.mark.parametrize('delay, much, trifle', [
    (0.0009, set(), True), (0.0009, {1}, False), (0.0015, set(), False)])
def test_a_little_delay_of_less_than_half_a_sample_is_that_of_steps(
    monkeypatch: pytest.MonkeyPatch, delay: float, much: set[int], trifle: bool
) -> None:
    best = Fit(Model.of(SPRING).with_effect('command_delay', (delay,)), 100.0, np.zeros(1), 100)
    monkeypatch.setattr(trifles, 'fit_without', lambda recordings, model, names: best)
    monkeypatch.setattr(trifles, 'weighed', lambda recordings, model: [])
    monkeypatch.setattr(trifles, 'material', lambda carried, model, least: much)
    shares: Any = SimpleNamespace(
        best=best, explained=0.9, sure=lambda of: 0.98, is_constant=lambda of: True)
    recording: Any = SimpleNamespace(observed=SimpleNamespace(h=0.0025))
    assert trifles.is_trifle([recording], shares, 'command_delay') is trifle


@pytest.mark.parametrize('corrected, exact, worse', [
    (1.015, True, False), (1.015, False, True), (1.03, True, True), (0.9, False, False)])
def test_names_down_to_the_noise_need_not_show_in_the_held_out_part(
    corrected: float, exact: bool, worse: bool
) -> None:
    squares = np.array([[9.0, 9.0], [1.0, 1.0], [corrected**2, corrected**2]])
    part = Part('held out', squares, np.full(2, 100.0), 1e-12 * squares, np.full(2, 100.0))
    assert _worse([part], Model.of(SPRING).with_effect('cubic_stiffness', (2e6,)), exact) is worse


@pytest.mark.parametrize('explained, corrected, noise, contradicted', [
    (1.0, 0.9, 0.3, True), (0.7, 0.9, 0.3, False), (1.0, 0.7, 0.3, False),
    (1.0, 0.98, 0.9, False)])  # where the noise hides the misfit, it hides the gain, too
def test_held_out_data_contradict_names_that_show_little_of_what_they_explain(
    explained: float, corrected: float, noise: float, contradicted: bool
) -> None:
    squares = 100.0 * np.array([[9.0], [1.0], [corrected**2]])
    part = Part('held out', squares, np.array([100.0]), 1e-12 * squares, np.array([100.0]))
    assert _promises_more(explained, [part], noise) is contradicted


@pytest.mark.parametrize('force, motion, drifts, worse', [
    (0.7, 7.0, False, True), (0.4, 1.8, False, False), (1.04, 0.7, False, False),
    (1.2, 0.7, False, True), (0.7, 7.0, True, False), (1.01, 0.2, True, True)])
def test_a_better_force_does_not_make_up_for_a_much_worse_motion_unless_that_drifts(
    force: float, motion: float, drifts: bool, worse: bool
) -> None:
    squares = np.array([[9.0, 9.0], [1.0, 1.0], [force**2, force**2]])
    moved = 1e-12 * np.array([[9.0, 9.0], [1.0, 1.0], [motion**2, motion**2]])
    part = Part('held out', squares, np.full(2, 100.0), moved, np.full(2, 100.0))
    best = Model.of(SPRING).with_effect('cubic_stiffness', (2e6,))
    assert _worse([part], best, False, drifts) is worse


@pytest.mark.parametrize('stiffness, away, told', [
    (0.0, 2.0, False), (0.0, 0.5, True), (1000.0, 2.0, True), (-1000.0, 2.0, False)])
def test_a_free_run_that_drifts_away_tells_nothing(
    monkeypatch: pytest.MonkeyPatch, stiffness: float, away: float, told: bool
) -> None:
    x = 1e-3 * np.sin(np.arange(100.0))  # moved by 1 N
    recording: Any = SimpleNamespace(observed=SimpleNamespace(
        x=x, force=1e3 * x, has_dynamics=lambda nominal: True,
        driven_by_force=lambda nominal: True))
    model = Model.of(SPRING).at((stiffness, 0.0))
    monkeypatch.setattr(conclusion, 'free_run', lambda model, observed: SimpleNamespace(
        position=x + away * 2e-3))
    assert (_free_runs(recording, [model, model, model]) is not None) is told


@pytest.mark.parametrize('nominal, recalibrated, contradicted', [
    (0.1, 0.3, True), (0.3, 0.1, False), (0.25, 0.3, False), (0.01, 0.03, False)])
def test_values_that_are_far_worse_for_the_force_are_not_recommended(
    nominal: float, recalibrated: float, contradicted: bool
) -> None:
    # A motion of one frequency tells neither mass nor spring, but their difference.
    range_of_10: Any = SimpleNamespace(observed=SimpleNamespace(force_range=10.0))
    force = Errors(nominal, recalibrated, recalibrated)
    assert _is_contradicted(force, [range_of_10]) is contradicted


def test_a_law_whose_size_differs_between_parts_makes_room_for_the_next(
    monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Shares, 'agrees', lambda self, name: name != 'cubic_stiffness')
    effect, = diagnosed(spring(6e5, 0.1), SPRING).effects
    assert effect.family == 'elastic_law' and effect.name != 'cubic_stiffness'


def test_a_law_bent_out_of_sight_makes_room_for_one_of_its_family() -> None:
    recording, model = prepared_from(spring(0.0, 0.0), SPRING)
    t, x = recording.observed.t, recording.observed.x
    soft = Signals(t, recording.observed.force - 3000.0 * x * np.abs(x), t,
                   recording.observed.raw_position, np.empty(0), np.empty((4, 0)))
    recording, model = prepared_from(soft, SPRING)
    base = fit([recording], model)
    parabola = fit([recording], base.model.with_effect('exponential_stiffness', (600.0, 0.4)))
    assert not may_show([recording], parabola.model, 'exponential_stiffness')
    shown = as_shown([recording], parabola, lambda name: None)
    (name,) = shown.model.effects
    assert EFFECTS[name].family == 'elastic_law' and name != 'exponential_stiffness'


def test_of_a_family_the_law_that_predicts_best_takes_that_place() -> None:
    recordings, base, best = specimen_of_two_laws()
    cubic = fit(recordings, best.model.without('coulomb_friction'))
    curve = fit(recordings, base.model.with_effect('polynomial_stiffness', (0.0, 2e6)))
    wild = curve._replace(cost=0.0, model=curve.model.at(
        [*curve.model.base_values, 40.0 * curve.model.values[-2] + 4e5, -1e9]))
    assert _of_family(recordings, best, [wild, cubic]) is cubic
    assert _of_family(recordings, best, []) is best
