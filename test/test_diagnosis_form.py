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

"""Laws whose size differs from part to part: they are named by their form, and say so."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from math import pi
from typing import Any, Sequence

from concealed_worlds import diagnosed, nominal, prepared_from
from contact_estimation.diagnosis.conclude import decision
from contact_estimation.diagnosis.conclude.result import Diagnosis
from contact_estimation.diagnosis.conclude.shares import Shares, shares_of
from contact_estimation.diagnosis.fit import form
from contact_estimation.diagnosis.fit.candidate import Candidate
from contact_estimation.diagnosis.fit.fitting import Fit, fit, residual_function
from contact_estimation.diagnosis.fit.form import holds_in_form, law_in_form
from contact_estimation.diagnosis.fit.invariance import errors_with_own_size
from contact_estimation.diagnosis.fit.parts import Part, parts_of
from contact_estimation.diagnosis.fit.share import Share
from contact_estimation.diagnosis.observe.model import Model, names_of
from contact_estimation.diagnosis.observe.signals import Signals
from contact_estimation.diagnosis.report.text_report import as_text
import numpy as np
import pytest
from scipy.optimize import least_squares

K_E, B_E = 5000.0, 30.0
MODEL = nominal(environment__stiffness=K_E, environment__damping=B_E)
DAMPING = (6e3, 8e3, 3e4, 3e4, 1e4, 2e4)  # chi of each touch [N s/m^2]


@lru_cache(maxsize=None)
def touches(*damping: float) -> Signals:
    """Touch a wall whose damping grows with depth, by a factor of its own in each touch."""
    t = np.arange(2500) / 250.0
    x = 0.003 * np.sin(1.2 * pi * t) + 0.001 * np.sin(6.2 * pi * t)
    v = 0.0036 * pi * np.cos(1.2 * pi * t) + 0.0062 * pi * np.cos(6.2 * pi * t)
    chi = np.array(damping)[np.minimum((0.6 * t).astype(int), 5)]
    force = np.where(x > 0.0, -(K_E * x + B_E * v + chi * x * v), 0.0)
    noise = np.random.default_rng(3).normal(0.0, 0.02, len(t))
    return Signals(t, np.minimum(force, 0.0) + noise, t, x, np.empty(0), np.empty((4, 0)))


@lru_cache(maxsize=None)
def diagnosis() -> Diagnosis:
    return diagnosed(touches(*DAMPING), MODEL)


def test_size_on_a_part_is_fitted_there_and_all_else_on_the_rest() -> None:
    recording, model = prepared_from(touches(*6 * [1e4]), MODEL)
    base = fit([recording], model)
    found = fit([recording], base.model.with_effect('hunt_crossley_damping', (1e3,)))
    function, parts = residual_function([recording], found.model), parts_of([recording], base)
    errors = errors_with_own_size([recording], found, parts)
    for part, error in zip(parts, errors):
        rest = least_squares(lambda values: function(values)[~part.there],
                             found.model.coordinates, x_scale=found.model.steps).x
        sizes = rest[-1] + found.model.steps[-1] * np.linspace(-0.1, 0.1, 401)
        least = min(part.squares(function(np.array([*rest[:-1], size]))).sum() for size in sizes)
        assert error.sum() == pytest.approx(least, rel=0.01)


@pytest.mark.slow
def test_damping_of_another_size_in_each_touch_is_named_by_its_form() -> None:
    effect, = diagnosis().effects
    assert effect.family == 'damping_law'
    assert effect.share_in_form is not None and effect.share_in_form > 0.9
    assert effect.share < 0.3 and diagnosis().verdict == 'unexplained'


@pytest.mark.slow
def test_a_law_that_no_longer_holds_in_form_is_not_named(monkeypatch: pytest.MonkeyPatch) -> None:
    def failing(*arguments: Any) -> Shares:
        shares = shares_of(*arguments)
        harm = {name: share._replace(share=-0.6) for name, share in shares.in_form.items()}
        return replace(shares, in_form=harm)

    monkeypatch.setattr(decision, 'shares_of', failing)
    found = diagnosed(touches(*DAMPING), MODEL)
    assert 'hunt_crossley_damping' not in [effect.name for effect in found.effects]


def test_report_says_that_the_size_differs() -> None:
    effect, = diagnosis().effects
    assert effect.share_in_form is not None
    explained = f'{100.0 * effect.share_in_form:.0f} %'
    assert f'but {explained} if its magnitude may differ between parts' in as_text(diagnosis())


@pytest.mark.parametrize('interval, parts, holds', [
    ((0.6, 0.9), (0.8, 0.7, 0.4), True),
    ((0.4, 0.9), (0.8, 0.7, 0.4), False),
    ((0.6, 0.9), (0.9, 0.9, 0.2), False),
])
def test_law_holds_in_form_if_it_explains_most_and_some_of_every_part(
    interval: tuple[float, float], parts: Sequence[float], holds: bool
) -> None:
    assert holds_in_form(Share(0.8, interval, np.array(parts))) is holds


PARTS = [Part(f'part {k}', np.ones(1, bool), np.zeros(1, int), np.ones(1), np.zeros(2))
         for k in range(4)]
BEFORE = np.tile((100.0, 0.0), (4, 1))


def candidate(name: str, share: float, flexible: bool = False) -> Candidate:
    """Make a candidate that predicts a share of every part with one size for all."""
    model = Model.of(MODEL).with_effect(name, (1.0,) * len(names_of(name)))
    left = (1.0 - share) * BEFORE
    return Candidate(Fit(model, 1.0, np.zeros(1), 1), left, left, None, flexible)


@pytest.mark.parametrize('shares, named', [
    ({'hunt_crossley_damping': 0.8}, 'hunt_crossley_damping'),
    ({'power_law_damping': 0.85, 'hunt_crossley_damping': 0.8}, 'hunt_crossley_damping'),
    ({'power_law_damping': 0.95, 'hunt_crossley_damping': 0.7}, 'power_law_damping'),
    ({'hunt_crossley_damping': 0.8, 'cubic_stiffness': 0.7}, None),  # no clear lead
    ({'hunt_crossley_damping': 0.45}, None),
    ({'force_bias': 0.9}, None),  # zeros have a size of their own in each part by nature
    ({}, None),
])
def test_law_is_named_by_its_form_if_it_leads_all_other_families(
    monkeypatch: pytest.MonkeyPatch, shares: dict[str, float], named: str | None
) -> None:
    monkeypatch.setattr(
        form, 'errors_with_own_size',
        lambda _, found, parts: (1.0 - shares[found.model.effects[-1]]) * BEFORE)
    law = law_in_form([], [candidate(name, 0.2) for name in shares], PARTS, BEFORE)
    assert (law.name if law else None) == named


def test_curve_is_not_named_by_its_form(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(form, 'errors_with_own_size', lambda *_: 0.1 * BEFORE)
    law = candidate('hunt_crossley_damping', 0.2, flexible=True)
    assert law_in_form([], [law], PARTS, BEFORE) is None


@pytest.mark.parametrize('own, rival, named', [(0.8, 0.4, True), (0.7, 0.2, False),
                                               (0.8, 0.6, False)])
def test_law_that_predicts_nothing_must_explain_three_quarters_of_every_part_and_lead_by_far(
    monkeypatch: pytest.MonkeyPatch, own: float, rival: float, named: bool
) -> None:
    shares = {'hunt_crossley_damping': own, 'coulomb_friction': rival}
    monkeypatch.setattr(
        form, 'errors_with_own_size',
        lambda _, found, parts: (1.0 - shares[found.model.effects[-1]]) * BEFORE)
    law = law_in_form([], [candidate(name, -1.0) for name in shares], PARTS, BEFORE)
    assert (law is not None) is named
