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

"""Soft materials: an elastic law and a loss of which neither predicts parts left out alone."""

from __future__ import annotations

from functools import lru_cache

from concealed_worlds import diagnosed, nominal, physics, prepared_from, recorded
from contact_estimation.diagnosis.conclude.result import Diagnosis
from contact_estimation.diagnosis.conclude.shares import Shares, shares_of
from contact_estimation.diagnosis.fit import pairs
from contact_estimation.diagnosis.fit.discrepancy import weighed
from contact_estimation.diagnosis.fit.exact_laws import exact_laws, exact_pair
from contact_estimation.diagnosis.fit.fitting import Fit, fit
from contact_estimation.diagnosis.fit.invariance import left_out_errors
from contact_estimation.diagnosis.fit.pairs import is_pair, pairs_that_predict
from contact_estimation.diagnosis.fit.parts import above_noise, evened, parts_of
from contact_estimation.diagnosis.fit.search import search
from contact_estimation.diagnosis.observe.prepared_recording import PreparedRecording
from contact_estimation.diagnosis.observe.signals import Signals
import numpy as np
import pytest
from scipy.signal import lfilter

MODEL = nominal(environment__stiffness=15.0, environment__damping=50.0,
                environment__unilateral=False)
RATE_HZ, DEPTH, TAU_S = 20.0, 0.04, 10.0
PAIR = ('power_law_stiffness', 'viscoelastic_relaxation')


@lru_cache(maxsize=None)
def pulled(elastic: bool, loss: bool, back_s: float = 30.0, stray: float = 0.004) -> Signals:
    """Stretch a strip once in 45 s and let it back; its force also strays, by 1 % of its range."""
    t = np.arange(round((45.0 + back_s) * RATE_HZ)) / RATE_HZ
    x = DEPTH * np.interp(t, (0.0, 45.0, 45.0 + back_s), (0.0, 1.0, 0.0))
    branch = lfilter([1.0, -1.0], [1.0, -np.exp(-1.0 / (RATE_HZ * TAU_S))], x)
    force = 2.2 * x**0.5 if elastic else 15.0 * x
    force = force + (20.0 * branch if loss else 0.0)
    random = np.random.default_rng(2)
    force += stray * np.sin(0.4 * t) * np.sin(1.1 * t) + random.normal(0.0, 5e-4, len(t))
    return Signals(t, -force, t, x, np.empty(0), np.empty((4, 0)))


@lru_cache(maxsize=None)
def prepared(elastic: bool, loss: bool) -> tuple[PreparedRecording, Fit]:
    """Prepare it with what the recalibrated model leaves as a discrepancy."""
    recording, model = prepared_from(pulled(elastic, loss), MODEL)
    carried, = weighed([recording], fit([recording], model).model)
    return carried, fit([carried], model)


@lru_cache(maxsize=None)
def diagnosis(back_s: float = 30.0, stray: float = 0.004) -> Diagnosis:
    return diagnosed(pulled(True, True, back_s, stray), MODEL)


def chosen(elastic: bool, loss: bool) -> tuple[str, ...]:
    """Return the pair that is taken."""
    recording, base = prepared(elastic, loss)
    parts = parts_of([recording], base)
    parts, before = evened(parts, left_out_errors([recording], base, parts))
    found = search([recording], base, lambda name: None)
    taken = pairs_that_predict([recording], base, found, parts, before, None)
    return taken[0].found.model.effects if taken else ()


def test_both_laws_are_named() -> None:
    assert {effect.family for effect in diagnosis().effects} == {'elastic_law', 'relaxation'}
    assert diagnosis().verdict == 'physics_missing'


def test_a_pair_that_leaves_a_quarter_of_the_misfit_is_not_named() -> None:
    found = diagnosis(stray=0.08)
    assert (found.effects, found.verdict) == ([], 'unexplained')


def test_memory_of_time_and_of_path_are_the_same_at_one_speed() -> None:
    loss, = (one for one in diagnosis(back_s=45.0).effects if one.family != 'elastic_law')
    assert {loss.name, *loss.indistinguishable_from} == {
        'presliding_friction', 'viscoelastic_relaxation'}


def test_no_pair_is_taken_where_one_law_alone_fits_as_well(
    monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(pairs, 'fitted_errors', lambda found, parts: np.zeros(1))
    assert chosen(True, True) == ()


@pytest.mark.parametrize('elastic, loss', [(True, False), (False, True)])
def test_no_pair_is_taken_where_one_law_is_missing(elastic: bool, loss: bool) -> None:
    assert chosen(elastic, loss) == ()


@pytest.mark.parametrize('names, pair', [
    (('cubic_stiffness', 'coulomb_friction'), True),
    (('force_bias', 'viscoelastic_relaxation', 'cubic_stiffness'), True),
    (('cubic_stiffness',), False), (('coulomb_friction', 'quadratic_damping'), False),
    (('cubic_stiffness', 'bilinear_stiffness'), False),
    (('cubic_stiffness', 'coulomb_friction', 'quadratic_damping'), False)])
def test_a_pair_is_one_elastic_law_and_one_loss(names: tuple[str, ...], pair: bool) -> None:
    assert is_pair(names) is pair


def of_pair() -> Shares:
    """Compute the shares of the right pair."""
    recording, base = prepared(True, True)
    model = base.model.with_effect(PAIR[0], (0.5, 2.0)).with_effect(PAIR[1], (20.0, TAU_S))
    return shares_of([recording], base.model, fit([recording], model).model, pair=PAIR)


def test_shares_of_a_pair_do_not_depend_on_the_order_and_add_up() -> None:
    shares = of_pair()
    first, second = (shares.of[name].share for name in PAIR)
    recording, base = shares.recordings, shares.base
    misfit = above_noise(base, shares.parts).sum()

    def left(*names: str) -> float:
        model = shares.best.model.without(*(set(PAIR) - set(names)))
        errors = left_out_errors(recording, fit(recording, model), shares.parts, base)
        return float(np.minimum(errors, base).sum()) / misfit

    none, both = float(base.sum()) / misfit, left(*PAIR)
    assert first == pytest.approx(
        0.5 * (none - left(PAIR[0]) + left(PAIR[1]) - both), abs=0.02)
    assert first + second == pytest.approx(shares.explained, abs=0.02)
    assert shares.sure(PAIR[0]) == shares.sure(PAIR[1]) > 0.5


def test_an_effect_that_harms_without_the_next_shares_with_it() -> None:
    recording, base = prepared(True, True)
    pair = of_pair()
    alone = shares_of([recording], base.model, pair.best.model.without(PAIR[1]))
    assert alone.of[PAIR[0]].share < 0.0
    both = shares_of([recording], base.model, pair.best.model)
    assert [both.of[name].share for name in PAIR] == pytest.approx(
        [pair.of[name].share for name in PAIR], abs=0.02)


@pytest.mark.slow
def test_of_two_exact_laws_neither_need_be_exact_alone() -> None:
    two = {**physics('tool_inertia', 1.0), **physics('moving_environment', 1e-4, 5.3, 0.5)}
    recording, model = prepared_from(recorded(**two, sensors__force_noise=0.1))
    base = fit([recording], model)
    found = search([recording], base, lambda name: None)
    assert not exact_laws([recording], base.cost, found, False)
    pair = exact_pair([recording], base, found, lambda name: None)[0]
    assert set(pair.model.effects) == {'tool_inertia', 'moving_environment'}
    place = pair.model.place('tool_inertia').start
    assert pair.model.values[place] == pytest.approx(1.0, rel=0.02)
    assert pair.cost < 1.5 * pair.residual_count


def test_no_pair_is_sought_in_what_is_little_more_than_noise() -> None:
    recording, model = prepared_from(recorded())
    base = fit([recording], model)
    assert exact_pair([recording], base, [base], lambda name: None) == []
