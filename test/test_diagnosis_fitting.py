# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Models as vectors of values, and their fits to recordings."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from concealed_worlds import FREE, MODEL, nominal, physics, prepared_from, recorded
from contact_estimation.diagnosis.fit import output_error
from contact_estimation.diagnosis.fit.fitting import fit, residual_function
from contact_estimation.diagnosis.fit.free_run import free_run, Run
from contact_estimation.diagnosis.fit.model_uncertainty import discounted
from contact_estimation.diagnosis.fit.uncertainty import standard_deviations
from contact_estimation.diagnosis.observe.model import Model, names_of
from contact_estimation.diagnosis.observe.observed import Observed
from contact_estimation.diagnosis.observe.residuals import residuals
from contact_estimation.diagnosis.observe.signals import Signals
from contact_estimation.physics import EFFECTS
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


def test_cost_of_a_fit_is_that_of_its_residuals() -> None:
    recording, model = prepared_from(recorded(**STIFFER))
    found = fit([recording], model)
    assert found.cost == pytest.approx(float(np.sum(residuals(recording, found.model) ** 2)))
    assert found.cost == pytest.approx(float(np.sum(found.residuals**2)))


@pytest.mark.parametrize(('name', 'values'), [
    ('coulomb_friction', (2.0,)), ('force_lag', (0.003,)), ('tool_inertia', (0.4,)),
    ('robot_friction', (2.0,)), ('command_delay', (0.004,)),
    ('joint_flexibility', (2e-5, 0.3, 0.1)),
])
def test_residuals_do_not_depend_on_those_computed_before(
    name: str, values: tuple[float, ...]
) -> None:
    signals = recorded()
    used, model = prepared_from(signals)
    asked = model.with_effect(name, values)
    changed = [model, asked, asked.at([1.02 * value for value in asked.values]),
               model.at((1.1 * K_e, B_e)), asked]
    for one in changed:
        fresh, _ = prepared_from(signals)
        np.testing.assert_array_equal(residuals(used, one), residuals(fresh, one))


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


def test_what_is_no_number_is_beyond_all_cost() -> None:
    recording, model = prepared_from(recorded())
    wild = model.with_effect('cubic_stiffness', (0.0,))
    left = residual_function([recording], wild)(np.array([np.nan, B_e, 0.0]))
    assert np.all(np.isfinite(left))
    assert np.max(left) == 1e6


@pytest.mark.filterwarnings('error')
@pytest.mark.parametrize('logarithm', [-1e6, 1e3, 1e300])
def test_value_searched_by_its_logarithm_stays_finite(logarithm: float) -> None:
    recording, model = prepared_from(recorded())
    bent = model.with_effect('power_law_stiffness', (1.5, 1e6))
    coordinates = np.array([B_e, 1.5, logarithm])
    assert np.isfinite(bent.with_free(coordinates).values).all()
    assert np.isfinite(residual_function([recording], bent)(coordinates)).all()


@pytest.mark.parametrize(('error', 'taken'), [(0.02, True), (0.3, False)])
def test_a_free_run_gives_no_values_that_residuals_refute(
    monkeypatch: pytest.MonkeyPatch, error: float, taken: bool
) -> None:
    # A free run that starts from a wrong command is least wrong at wrong values.
    def wrong(model: Model, observed: Observed) -> Run:
        return free_run(model.at((*model.values[:2], model.values[2] - error)), observed)

    recording, model = prepared_from(recorded(
        **physics('environment_inertia', 0.5), sensors__position_noise=3e-5))
    found = fit([recording], model.with_effect('environment_inertia', (0.1,)))
    monkeypatch.setattr(output_error, 'free_run', wrong)
    _, refined = output_error.refine([recording], found)
    expected = found.model.values[2] + (error if taken else 0.0)
    assert refined.model.values[2] == pytest.approx(expected, abs=0.02)
    assert (refined.model is found.model) == (not taken)


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


def test_standard_deviations_beside_a_gain_are_those_of_the_values() -> None:
    recording, model = prepared_from(recorded(**physics('force_gain', 0.545)))
    model = fit([recording], model.with_effect('force_gain', (0.6,))).model
    here, values = residuals(recording, model), np.array(model.values)
    jacobian = np.column_stack([
        (residuals(recording, model.at(values + change)) - here) / change.sum()
        for change in np.diag(1e-6 * values)])
    white = np.sqrt(np.diag(np.linalg.inv(jacobian.T @ jacobian)))
    std = standard_deviations([recording], fit([recording], model))
    np.testing.assert_allclose(std[[0, 2]], white[[0, 2]], rtol=0.3)
    assert std[0] / values[0] < 0.3 * std[2] / values[2]


def test_coordinates_beside_a_gain_are_those_that_the_force_tells() -> None:
    model = Model.of(nominal()).with_effect('force_gain', (0.5,))
    K_e, B_e, gain = model.coordinates
    assert (K_e, B_e) == pytest.approx((0.5 * model.stiffness, 0.5 * model.damping))
    moved = model.with_free(np.array([K_e, B_e, 2.0 * gain]))
    assert moved.stiffness == pytest.approx(0.5 * model.stiffness)
    assert moved.with_free(moved.coordinates).values == pytest.approx(moved.values)


def test_slow_residuals_make_standard_deviations_larger() -> None:
    recording, model = prepared_from(recorded())
    o = recording.observed
    slow = replace(recording, observed=replace(
        o, force=o.force + 2.0 * recording.force_noise * np.sin(4.0 * o.t)))
    white, correlated = (standard_deviations([one], fit([one], model))
                         for one in (recording, slow))
    assert (correlated > 1.5 * white).all()


@pytest.mark.slow
def test_standard_deviations_of_what_is_not_fitted_are_not_numbers() -> None:
    recording, model = prepared_from(recorded(**physics('hunt_crossley_damping', 12000.0)))
    found = fit([recording], model.with_effect('hunt_crossley_damping', (10000.0,)))
    std = standard_deviations([recording], found)
    np.testing.assert_array_equal(np.isnan(std), [False, True, False])


def test_model_places_values_in_order() -> None:
    model = Model.of(nominal()).with_effect('moving_environment', (1e-4, 2.0, 0.3))
    model = model.with_effect('force_bias', (1.5,))
    assert model.place('moving_environment') == slice(2, 5)
    assert model.place('force_bias') == slice(5, 6)
    assert model.without('moving_environment').values == (K_e, B_e, 1.5)
    assert model.without('moving_environment').effects == ('force_bias',)
    assert model.without('force_bias', 'moving_environment') == Model.of(nominal())


@pytest.mark.parametrize('name', ['force_bias', 'no_such_effect'])
def test_effect_that_a_model_has_not_has_no_place(name: str) -> None:
    model = Model.of(nominal()).with_effect('coulomb_friction', (1.0,))
    with pytest.raises(KeyError, match=name):
        model.place(name)
    with pytest.raises(KeyError, match=name):
        model.without(name)


def test_effect_that_does_not_exist_cannot_be_added() -> None:
    with pytest.raises(KeyError, match='no_such_effect'):
        Model.of(nominal()).with_effect('no_such_effect', (1.0,))


def test_inertia_is_fitted_where_the_wall_has_one() -> None:
    model = Model.of(nominal(environment__inertia=2.0, environment__unilateral=False))
    assert model.values == (K_e, B_e, 2.0)
    assert model.laws().contact.inertia == 2.0
    assert model.with_effect('force_bias', (1.0,)).place('force_bias') == slice(3, 4)


@pytest.mark.parametrize('name', EFFECTS)
def test_bounds_have_a_place_for_every_value(name: str) -> None:
    count = len(names_of(name))
    model = Model.of(nominal()).with_effect(name, (0.5,) * count)
    low, high = model.bounds
    assert len(low) == len(high) == len(model.values) == len(model.free) == 2 + count
    assert np.all(low < high)


def test_effects_act_in_the_order_of_the_registry() -> None:
    model = Model.of(nominal()).with_effect('force_saturation', (50.0,))
    model = model.with_effect('tool_inertia', (1.0,))
    chain = [type(effect).name for effect in model.laws().chain]
    assert chain == ['tool_inertia', 'force_saturation']


def test_creep_beyond_the_force_itself_is_implausible() -> None:
    model = Model.of(nominal())
    assert model.with_effect('force_creep', (0.2, 3.0)).plausible()
    assert not model.with_effect('force_creep', (80.0, 8.0)).plausible()
    assert not model.with_effect('force_creep', (0.2, 0.001)).plausible()


def test_creep_of_a_few_percent_fits_almost_anything() -> None:
    model = prepared_from(recorded())[1]
    for share, flexible in ((0.02, True), (0.04, False)):
        crept = model.with_effect('force_creep', (share, 0.5))
        assert crept.is_flexible('force_creep', 60.0) is flexible


def test_a_joint_that_does_not_ring_is_implausible() -> None:
    model = Model.of(nominal())
    assert model.with_effect('joint_flexibility', (1e-4, 0.3, 0.2)).plausible()
    assert not model.with_effect('joint_flexibility', (1e-4, 0.3, 0.9)).plausible()
    assert not model.with_effect('joint_flexibility', (1e-4, 0.94, 0.2)).plausible()


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


def test_friction_that_rises_is_implausible() -> None:
    model = Model.of(nominal())
    assert model.with_effect('stribeck_friction', (1.0, 2.0, 0.01)).plausible()
    assert not model.with_effect('stribeck_friction', (2.0, 1.0, 0.01)).plausible()
    assert not model.with_effect('stribeck_friction', (1.0, 2.0, 1e-5)).plausible()


@pytest.mark.parametrize('name, values', [
    ('viscoelastic_relaxation', (2.6, 10.0)), ('fractional_relaxation', (2.6, 0.4))])
def test_what_relaxes_beside_a_spring_that_repels_is_implausible(
    name: str, values: tuple[float, ...]
) -> None:
    drive = Model.of(nominal(environment__unilateral=False, environment__stiffness=0.0))
    assert drive.with_effect(name, values).at([-0.1, 1.0, *values]).plausible()
    assert not drive.with_effect(name, values).at([-2.1, 1.0, *values]).plausible()


def test_values_out_of_range_are_brought_back() -> None:
    model = Model.of(nominal()).with_effect('environment_resonance', (0.5, 0.0075, 1.5))
    assert model.values[model.base_count:] == (0.5, 0.01, 0.99)


def test_world_of_these_tests_begins_in_free_flight() -> None:
    assert recorded().position[0] == pytest.approx(FREE, abs=1e-5)
