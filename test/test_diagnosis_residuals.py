# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Residuals of correct and wrong models in the channels of a recording."""

from __future__ import annotations

from dataclasses import replace

from concealed_worlds import (
    ATTACHED,
    attached,
    FORCE_NOISE,
    MODEL,
    nominal,
    physics,
    prepared_from,
    recorded,
)
from contact_estimation.diagnosis.fit.model_uncertainty import discounted
from contact_estimation.diagnosis.observe.channel import Discount
from contact_estimation.diagnosis.observe.model import Model
from contact_estimation.diagnosis.observe.observed import Observed
from contact_estimation.diagnosis.observe.prepared_recording import PreparedRecording
from contact_estimation.diagnosis.observe.residuals import (
    force_residual,
    huber,
    motion_residual,
    residuals,
    response_to,
    ROBUST,
)
from contact_estimation.diagnosis.observe.signals import Signals
from contact_estimation.diagnosis.observe.touch_down import at_touch_down
from contact_estimation.diagnosis.observe.usable_samples import default_block, force_drops, usable
from contact_estimation.physics.numeric import discretise
import numpy as np
from numpy.typing import NDArray
import pytest

Array = NDArray[np.float64]

EFFECTS_BY_CHANNEL = [
    ('coulomb_friction', (2.0,), True, True),
    ('cubic_stiffness', (3e6,), True, True),
    ('force_bias', (2.0,), True, False),
    ('force_delay', (0.006,), True, False),
    ('robot_friction', (3.0,), False, True),
    ('reflected_inertia', (1.5,), False, True),
]


def mean_squares(recording: PreparedRecording, model: Model) -> tuple[float, float]:
    """Return the mean square residual of a model in both channels, in that of the noise."""
    recording = discounted(recording, model)
    parts = np.split(residuals(recording, model, robust=False), 2)
    force, motion = (float(np.mean(part[part != 0.0] ** 2)) for part in parts)
    return force, motion


@pytest.mark.slow
@pytest.mark.parametrize('seed', [1, 2, 3])
def test_true_model_leaves_noise_of_variance_one(seed: int) -> None:
    recording, model = prepared_from(recorded(seed=seed))
    force, motion = mean_squares(recording, model)
    assert force == pytest.approx(1.0, abs=0.2)
    assert motion == pytest.approx(1.0, abs=0.3)


def test_force_residual_of_the_true_model_is_the_sensor_s_noise() -> None:
    recording, model = prepared_from(recorded())
    residual = force_residual(recording, model)[recording.use]
    assert np.std(residual) == pytest.approx(FORCE_NOISE, rel=0.05)
    assert abs(np.mean(residual)) < 4.0 * FORCE_NOISE / np.sqrt(len(residual))


@pytest.mark.slow
@pytest.mark.parametrize('name, values, in_force, in_motion', EFFECTS_BY_CHANNEL)
def test_effect_shows_in_the_channels_it_acts_on(
    name: str, values: tuple[float, ...], in_force: bool, in_motion: bool
) -> None:
    recording, model = prepared_from(recorded(**physics(name, *values)))
    for left, shows in zip(mean_squares(recording, model), (in_force, in_motion)):
        assert left > 8.0 if shows else left < 2.0


@pytest.mark.slow
@pytest.mark.parametrize('name, values', [case[:2] for case in EFFECTS_BY_CHANNEL])
def test_true_effect_explains_what_it_did(name: str, values: tuple[float, ...]) -> None:
    recording, model = prepared_from(recorded(**physics(name, *values)))
    before, after = (sum(mean_squares(recording, m))
                     for m in (model, model.with_effect(name, values)))
    assert after < 0.15 * before


def test_impulse_of_touch_down_is_kept() -> None:
    pressing, step = -40.0, 0.3  # a damper's force is there at once, within the step
    d = np.array([-1.3, -0.7 * 1.0, 0.3, 1.3])
    force = np.where(d > 0.0, pressing, 0.0)
    changed = at_touch_down(force, d)
    area = np.sum(0.5 * (changed[1:] + changed[:-1]))
    # Straight lines between samples a second apart; the force acts for 0.3 s of the second one.
    assert area == pytest.approx(pressing * (step + 1.0))
    np.testing.assert_array_equal(changed != force, [False, True, False, False])


@pytest.mark.parametrize('d', [[-2.0, -1.0, -0.5], [0.5, 0.7, 0.9], [0.5, -0.5, -1.0]])
def test_without_touch_down_no_force_is_changed(d: list[float]) -> None:
    depth = np.array(d)
    force = np.where(depth > 0.0, -5.0, 0.0)
    np.testing.assert_array_equal(at_touch_down(force, depth), force)


def test_discount_removes_model_uncertainty_and_not_physics() -> None:
    recording, model = prepared_from(recorded())
    stiffer = model.with_effect('impedance_mismatch', (1.0, 1.0, 1.02))
    rubbing = model.with_effect('coulomb_friction', (1.0,))
    before = [cost(recording, m) - cost(recording, model) for m in (stiffer, rubbing)]
    recording = discounted(recording, model)
    after = [cost(recording, m) - cost(recording, model) for m in (stiffer, rubbing)]
    uncertain, kept = (now / then for now, then in zip(after, before))
    assert uncertain < 0.2
    assert kept > 0.5


def cost(recording: PreparedRecording, model: Model) -> float:
    """Sum the squared residuals of a model."""
    return float(np.sum(residuals(recording, model, robust=False) ** 2))


def test_discount_makes_no_residual_larger() -> None:
    recording, model = prepared_from(recorded(**physics('coulomb_friction', 2.0)))
    before = cost(recording, model)
    recording = discounted(recording, model)
    assert cost(recording, model) <= before


def test_dropped_wrenches_do_not_count() -> None:
    signals = recorded()
    kept = np.ones(len(signals.force), bool)
    kept[600:620] = kept[1000::37] = False
    kept[-1] = True
    wrong = np.where(kept, signals.force, 1e3)
    lossy = signals._replace(wrench_t=signals.wrench_t[kept], force=wrong[kept])
    recording, model = prepared_from(lossy)
    assert len(recording.observed.t) == len(signals.force)
    np.testing.assert_array_equal(recording.observed.measured, kept)
    force, motion = mean_squares(recording, model)
    assert force == pytest.approx(1.0, abs=0.2)
    assert motion == pytest.approx(1.0, abs=0.3)


def test_blocks_average_to_variance_one() -> None:
    recording, _ = prepared_from(recorded())
    noise = 0.7 * np.random.default_rng(1).standard_normal(len(recording.observed.t))
    averaged = replace(recording, force_noise=0.7).force.average(noise)
    assert len(averaged) == len(noise) // recording.block
    assert np.var(averaged[averaged != 0.0]) == pytest.approx(1.0, abs=0.15)


def test_count_is_that_of_the_residuals_that_are_not_empty() -> None:
    recording, model = prepared_from(recorded())
    assert recording.residual_count == np.count_nonzero(residuals(recording, model))


def test_touch_downs_and_ends_are_not_used() -> None:
    recording, model = prepared_from(recorded())
    o = recording.observed
    inside = o.x > 0.0
    first = np.flatnonzero(inside[1:] & ~inside[:-1]) + 1
    use = usable(model, o)
    assert len(first) >= 3
    assert not use[first].any()
    assert not use[:5].any() and not use[-5:].any()
    assert np.mean(use) > 0.95


def test_start_of_an_attached_wall_is_not_used() -> None:
    recording, model = prepared_from(attached(), nominal(**ATTACHED))
    use = usable(model, recording.observed)
    assert not use[recording.observed.t < 0.49].any()
    assert use[(recording.observed.t > 0.51) & (recording.observed.t < 7.9)].all()


@pytest.mark.parametrize('cycles, rest, unused', [
    (20.0, 0.0, (9.9, 10.1)),  # begins loaded: its memory may be as long as a stroke
    (20.0, 0.01, (0.49, 0.51)),  # begins unloaded
    (2.0, 0.0, (0.49, 0.51)),  # a stroke is a quarter of the recording
])
def test_first_strokes_of_a_recording_that_begins_loaded_are_not_used(
    cycles: float, rest: float, unused: tuple[float, float]
) -> None:
    t = np.arange(10001) / 100.0
    x = 0.01 * np.cos(0.02 * np.pi * cycles * t)
    signals = Signals(t, -1000.0 * (x - rest), t, x, np.empty(0), np.empty((4, 0)))
    recording, model = prepared_from(signals, nominal(**{**ATTACHED, 'environment__inertia': 0.0}))
    use = usable(model, recording.observed)
    assert not use[t < unused[0]].any()
    assert use[(t > unused[1]) & (t < 99.9)].all()


def test_response_to_a_missing_force_is_the_motion_residual() -> None:
    true, model = prepared_from(recorded(**physics('robot_friction', 3.0)))
    residual = motion_residual(true, model)
    drag = -3.0 * np.tanh(true.observed.v / 4e-4)
    answer = response_to(true, drag, model)
    assert answer is not None and residual is not None
    assert np.corrcoef(answer[true.use], residual[true.use])[0, 1] > 0.95


def test_without_a_robot_there_is_no_motion_channel() -> None:
    signals = recorded()._replace(reference_t=np.empty(0), reference=np.empty((4, 0)))
    recording, model = prepared_from(signals)
    assert recording.observed.reference is None
    assert motion_residual(recording, model) is None
    assert response_to(recording, np.zeros(len(recording.observed.t)), model) is None
    assert recording.residual_count == np.count_nonzero(residuals(recording, model))


def test_attached_wall_has_a_motion_channel_alone() -> None:
    recording, model = prepared_from(attached(), nominal(**ATTACHED))
    left = residuals(recording, model)
    assert len(left) == len(recording.observed.t) // default_block(recording.observed)
    assert np.mean(left**2) == pytest.approx(1.0, abs=0.3)


def test_bent_residuals_have_the_squares_of_huber_s_loss() -> None:
    r = np.linspace(-40.0, 40.0, 801)
    loss = np.where(np.abs(r) <= ROBUST, r**2, 2.0 * ROBUST * np.abs(r) - ROBUST**2)
    np.testing.assert_allclose(huber(r) ** 2, loss)
    np.testing.assert_array_equal(np.sign(huber(r)), np.sign(r))


def observed_force(force: Array) -> Observed:
    """Make an observation of which the force alone counts."""
    t, nothing = np.linspace(0.0, 0.004 * (len(force) - 1), len(force)), np.zeros(len(force))
    return Observed(t, 0.004, force, np.ones(len(force), bool), nothing, nothing, nothing,
                    nothing, None, 1e-6, 20.0)


def pressed(drops: int, samples: int) -> Array:
    """Press for four seconds, and vanish for some samples every now and then."""
    force = np.zeros(1200)
    force[100:1100] = -50.0
    for k in range(drops):
        force[200 + 150 * k:200 + 150 * k + samples] = 0.0
    return force + 0.1 * np.random.default_rng(1).standard_normal(1200)


EVERYWHERE = np.ones(1200, bool)


def test_a_tool_that_bounces_off_the_surface_has_no_drops() -> None:
    outside = EVERYWHERE.copy()
    outside[650:670] = False  # of one of the four
    observed = observed_force(pressed(4, 20))
    dropped = force_drops(observed, 0.1, outside)
    assert dropped is not None and dropped[500:520].all() and not dropped[650:670].any()
    outside[500:520] = False  # three are needed
    assert force_drops(observed, 0.1, outside) is None


def test_force_drops_during_contact_are_found() -> None:
    found = force_drops(observed_force(pressed(4, 20)), 0.1, EVERYWHERE)
    assert found is not None
    expected = pressed(4, 20) > -25.0
    expected[:100] = expected[1100:] = False
    np.testing.assert_array_equal(found, expected)


def test_drops_with_a_sample_on_the_way_count_beside_sharp_ones_alone() -> None:
    force = pressed(4, 20)
    force[650] = -2.0  # between none and pressing
    dropped = force_drops(observed_force(force), 0.1, EVERYWHERE)
    assert dropped is not None and dropped[651:670].all() and not dropped[650]
    for begin in (200, 350, 500, 650):  # bounces: the force rises and falls over samples
        force[begin] = force[begin + 20] = -2.0
    assert force_drops(observed_force(force), 0.1, EVERYWHERE) is None


def test_drops_of_a_few_samples_between_stamps_that_jitter_are_found() -> None:
    force = pressed(4, 2)
    begins = [200, 350, 500, 650]
    force[begins] = -4.0  # forty times the noise
    dropped = force_drops(observed_force(force), 0.1, EVERYWHERE)
    expected = [k for begin in begins for k in (begin, begin + 1)]
    assert dropped is not None and np.flatnonzero(dropped).tolist() == expected


@pytest.mark.parametrize('drops, samples', [(0, 0), (2, 20), (4, 140)])
def test_few_or_long_gaps_are_no_drops(drops: int, samples: int) -> None:
    assert force_drops(observed_force(pressed(drops, samples)), 0.1, EVERYWHERE) is None


def test_model_that_cannot_release_is_charged_for_drops() -> None:
    recording, model = prepared_from(recorded())
    dropped = np.zeros(len(recording.observed.t), bool)
    dropped[800:805] = dropped[900:905] = True
    with_drops = replace(recording, dropped=dropped)
    plain = cost(with_drops, model)
    playing = cost(with_drops, model.with_effect('backlash', (0.0,)))
    assert plain - playing == pytest.approx(25.0 * 10.0, rel=0.01)


def test_reference_reaches_a_late_robot_later() -> None:
    recording, _ = prepared_from(recorded())
    o = recording.observed
    assert o.reference is not None
    late = o.reference_at(3.0 * o.h)
    np.testing.assert_allclose(late[:, 3:], o.reference[:, :-3], atol=1e-9)
    np.testing.assert_array_equal(o.reference_at(0.0), o.reference)


def test_stamps_of_joint_and_wrench_may_differ() -> None:
    signals: Signals = recorded()
    shifted = signals._replace(joint_t=signals.joint_t[3:], position=signals.position[3:])
    recording, model = prepared_from(shifted)
    assert mean_squares(recording, model)[0] == pytest.approx(1.0, abs=0.2)


def diagnosed_later(recording: PreparedRecording, model: Model) -> float:
    """Return the cost of the nominal model after residuals of another one were computed."""
    heavier = model.with_effect('reflected_inertia', (3.0,))
    residuals(recording, heavier)
    motion_residual(recording, heavier)
    return cost(recording, model)


def test_residuals_do_not_depend_on_the_order_of_calls() -> None:
    signals = recorded(**physics('robot_friction', 3.0))
    recording, model = prepared_from(signals)
    untouched, _ = prepared_from(signals)
    assert diagnosed_later(recording, model) == cost(untouched, model)


def test_all_models_are_whitened_by_the_nominal_robot() -> None:
    recording, model = prepared_from(recorded())
    robot = MODEL['robot.mass'], MODEL['robot.damping'], MODEL['robot.stiffness']
    expected = discretise(*robot, recording.observed.h)
    assert recording.observer is not None
    np.testing.assert_array_equal(recording.observer.denominator, expected.denominator)


def test_replaced_fields_keep_discount_and_observer() -> None:
    recording, model = prepared_from(recorded(**physics('robot_friction', 3.0)))
    plain, recording = cost(recording, model), discounted(recording, model)
    copied = replace(recording, name='copy', picard_rounds=8)
    assert cost(copied, model) == cost(recording, model) < 0.99 * plain
    assert copied.observer is recording.observer


def test_other_samples_need_another_discount() -> None:
    recording, model = prepared_from(recorded())
    recording = discounted(recording, model)
    assert recording.discount is not None
    assert recording.whole(model).discount is None


def test_discount_whitens_with_the_covariance_of_noise_and_columns() -> None:
    columns = np.random.default_rng(1).standard_normal((30, 4))
    covariance = np.eye(30) + columns @ columns.T
    r = np.random.default_rng(2).standard_normal(30)
    whitened = Discount.of(columns).apply(r)
    assert whitened @ whitened == pytest.approx(r @ np.linalg.solve(covariance, r))


def test_recordings_are_compared_by_identity() -> None:
    first, second = (prepared_from(recorded())[0] for _ in range(2))
    assert first == first and first != second
