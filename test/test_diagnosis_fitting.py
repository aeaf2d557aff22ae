# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Models as vectors of values, and their fits to recordings."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from concealed_worlds import MODEL, nominal, prepared_from, recorded
from contact_estimation.diagnosis.fit.fitting import fit
from contact_estimation.diagnosis.fit.model_uncertainty import discounted
from contact_estimation.diagnosis.fit.uncertainty import standard_deviations
from contact_estimation.diagnosis.observe.model import Model
from contact_estimation.diagnosis.observe.signals import Signals
import numpy as np
import pytest

K_e, B_e = MODEL['environment.stiffness'], MODEL['environment.damping']
STIFFER: dict[str, Any] = {'environment__stiffness': 5600.0, 'environment__damping': 90.0}


def test_fit_recovers_stiffness_and_damping() -> None:
    recording, model = prepared_from(recorded(**STIFFER))
    found = fit([recording], model)
    assert found.model.values == pytest.approx((5600.0, 90.0), rel=0.01)
    assert found.residual_count == recording.residual_count


@pytest.mark.parametrize(('known', 'expected'), [(0.0, -3.0), (30.0, 0.0)])
def test_what_a_drive_moves_may_be_repelled_but_no_specimen(known: float, expected: float) -> None:
    t = np.arange(2000) / 250.0
    x, v = np.sin(1.7 * t) + 0.4 * np.sin(4.1 * t), 1.7 * np.cos(1.7 * t) + 1.64 * np.cos(4.1 * t)
    force = 3.0 * x - 40.0 * v + np.random.default_rng(4).normal(0.0, 0.2, len(t))
    signals = Signals(t, force, t, x, np.empty(0), np.empty((4, 0)))
    recording, model = prepared_from(signals, nominal(
        environment__stiffness=known, environment__damping=60.0, environment__unilateral=False))
    found = fit([recording], model).model
    assert found.stiffness == pytest.approx(expected, abs=0.1)
    assert found.damping == pytest.approx(40.0, rel=0.01)


@pytest.mark.slow
@pytest.mark.parametrize('start', [(500.0, 5.0), (50000.0, 1000.0)])
def test_fit_finds_its_way_from_far_off(start: tuple[float, float]) -> None:
    recording, model = prepared_from(recorded())
    assert fit([recording], model.at(start)).model.values == pytest.approx((K_e, B_e), rel=0.01)


def test_fit_stays_within_the_ranges_of_the_parameters() -> None:
    recording, model = prepared_from(recorded())
    found = fit([recording], model.with_effect('coulomb_friction', (1.0,)))
    low, high = found.model.bounds
    assert np.all(low <= found.model.values) and np.all(found.model.values <= high)
    assert found.model.values[-1] < 0.05


@pytest.mark.slow
def test_standard_deviations_cover_the_errors() -> None:
    errors = []
    for seed in (1, 2, 3):
        recording, model = prepared_from(recorded(seed=seed))
        recording = discounted(recording, model)
        found = fit([recording], model)
        errors += list((np.array(found.model.values) - (K_e, B_e))
                       / standard_deviations([recording], found))
    assert np.sqrt(np.mean(np.square(errors))) < 3.0


def test_slow_residuals_make_standard_deviations_larger() -> None:
    recording, model = prepared_from(recorded())
    o = recording.observed
    slow = replace(recording, observed=replace(
        o, force=o.force + 2.0 * recording.force_noise * np.sin(4.0 * o.t)))
    white, correlated = (standard_deviations([one], fit([one], model))
                         for one in (recording, slow))
    assert (correlated > 1.5 * white).all()


def test_inertia_is_fitted_where_the_wall_has_one() -> None:
    model = Model.of(nominal(environment__inertia=2.0, environment__unilateral=False))
    assert model.values == (K_e, B_e, 2.0)
    assert model.laws().contact.inertia == 2.0
    assert model.with_effect('force_bias', (1.0,)).place('force_bias') == slice(3, 4)


@pytest.mark.parametrize('attached, stiffness, plausible', [
    (True, 0.0, False), (True, 500.0, True), (False, 0.0, True)])
def test_what_no_spring_presses_on_moves_unseen(
    attached: bool, stiffness: float, plausible: bool
) -> None:
    wall = nominal(environment__unilateral=not attached)
    moved = Model.of(wall).with_effect('moving_environment', (1e-3, 1.0, 0.0))
    assert moved.at([stiffness, *moved.values[1:]]).plausible() is plausible
    replaced = moved.with_effect('power_law_stiffness', (1.5, 1e4))
    assert replaced.at([stiffness, *replaced.values[1:]]).is_plausible('moving_environment')
