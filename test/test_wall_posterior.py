# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from math import nan

from contact_estimation.estimators.multiple_model import (
    CONTACT, FREE, lag_prior, WallPosterior)
from contact_estimation.estimators.multiple_model.contact import ContactFilter
from contact_estimation.estimators.multiple_model.evidence import mixture, Wall
from contact_estimation.estimators.multiple_model.laws import COLUMNS, ONE
from contact_estimation.estimators.multiple_model.runs import in_doubt
from contact_estimation.studies.paths import ramp
import numpy as np
import pytest
from wall_worlds import Array, contact, fed, FINE, Samples, spring_damper

K, B = 5000.0, 100.0
NO_LAG = lag_prior(0.0, 1e-3)  # the sensor has none, and says so


def within(value: float, truth: float, std: float, stds: float = 2.0) -> bool:
    return abs(value - truth) <= stds * std


# -- against independent computations -----------------------------------------------------------

@pytest.mark.parametrize('seed', range(3))
def test_agrees_with_batch_least_squares_on_a_known_surface(seed: int) -> None:
    samples = contact(spring_damper(K, B), noise=1.0, seed=seed)
    known = fed(samples, WallPosterior(0.0, 0.0, NO_LAG)).known
    pressed = samples.depth > 1e-4
    d, v = samples.depth[pressed], np.gradient(samples.depth, samples.t)[pressed]
    batch = np.linalg.lstsq(np.stack([d, v], 1), samples.force[pressed], rcond=None)[0]
    assert within(known.stiffness, batch[0], known.stiffness_std, 3.0)
    assert within(known.damping, batch[1], known.damping_std, 3.0)
    assert known.stiffness_std < 0.01 * K


# -- contact ------------------------------------------------------------------------------------

@pytest.mark.parametrize('hertz', [20.0, 50.3, 120.0])
def test_hum_is_neither_a_contact_nor_a_stiffness(hertz: float) -> None:
    samples = contact(spring_damper(K, B), 4.0, noise=0.1, presses=((1.0, 4.0),))
    humming = samples.force + 0.5 * np.sin(2.0 * np.pi * hertz * samples.t)
    posterior, touched, last = WallPosterior(), 0, samples._replace(force=humming)
    for t, force, x, depth in zip(*(one.tolist() for one in last)):
        state = posterior.take(t, force, x)
        touched += state != FREE and depth < -1e-3 and t > 0.4
        known = posterior.known
        if known.valid and depth > 1e-3:
            assert within(known.stiffness, K, known.stiffness_std, 3.0)
    assert touched == 0
    assert posterior.known.stiffness_std < 0.02 * K


# -- from the first estimate on -----------------------------------------------------------------

def worst_error(samples: Samples, stiffness: float) -> float:
    """Return the largest error of the stiffness that is published, in deviations."""
    posterior, worst = WallPosterior(0.0, 2e-3), 0.0
    for t, force, x, _ in zip(*(one.tolist() for one in samples)):
        posterior.take(t, force, x)
        known = posterior.known
        if known.valid:
            worst = max(worst, abs(known.stiffness - stiffness) / known.stiffness_std)
    return worst


@pytest.mark.parametrize('seed', [
    *range(6),
    10])
def test_first_estimates_are_within_their_deviations(seed: int) -> None:
    samples = contact(spring_damper(4800.0, 200.0), 1.5, noise=1.0, seed=seed)
    assert worst_error(samples, 4800.0) < 4.0


# -- walls that change --------------------------------------------------------------------------

def test_follows_a_step_of_the_stiffness_within_0_2_s() -> None:
    before, after = (contact(spring_damper(factor * K, factor * B)) for factor in (1.0, 2.0))
    at = 2.0
    force = np.where(before.t < at, before.force, after.force)
    posterior, found = WallPosterior(0.0, 2e-3), []
    for t, f, x in zip(before.t, force, before.x):
        posterior.take(t, f, x)
        found.append(posterior.known.stiffness)
    settled = np.abs(np.array(found) - 2.0 * K) < 0.1 * 2.0 * K
    assert settled[before.t > at + 0.2].all()
    assert posterior.wall.changes >= 1
    assert np.all(np.abs(np.array(found)[(before.t > 1.5) & (before.t < at)] - K) < 0.02 * K)


def believed(
    step: float, at: float, location: float, since: float, shaken: float = 0.002,
) -> list[tuple[float, float]]:
    """Return K_e and its deviation in contact, of three contacts, the zero stepping in between."""
    samples = contact(spring_damper(K, B), 7.5, shaken=shaken,
                      presses=((0.3, 2.5), (3.0, 5.0), (5.5, 7.4)))
    force = samples.force + step * (samples.t > at)
    posterior, found = WallPosterior(location, 0.0, NO_LAG), []
    for t, f, x, depth in zip(samples.t, force, samples.x, samples.depth):
        posterior.take(t, f, x)
        if t > since and depth > 1e-3 and posterior.known.valid:
            found.append((posterior.known.stiffness, posterior.known.stiffness_std))
    assert len(found) > 500
    return found


@pytest.mark.parametrize('location', [0.0, nan])
@pytest.mark.parametrize('step', [1.0, 2.0])
def test_a_step_of_the_zero_before_a_touch_changes_no_stiffness(
    step: float, location: float,
) -> None:
    for stiffness, std in believed(step, 2.95, location, since=3.3):
        assert within(stiffness, K, max(std, 0.002 * K), 3.0)


@pytest.mark.parametrize('rate', [0.2, 0.5])
@pytest.mark.parametrize('shaken', [0.0, 0.002])
def test_a_zero_that_has_drifted_in_a_contact_changes_no_stiffness(
    rate: float, shaken: float,
) -> None:
    samples = contact(spring_damper(K, B), 13.0, shaken=shaken, presses=((0.5, 12.0),))
    drift = rate * np.clip(samples.t - 1.0, 0.0, 11.0)
    known = fed(samples._replace(force=samples.force + drift), WallPosterior(0.0, 2e-3)).known
    assert within(known.stiffness, K, known.published_stds[0], 3.0)


@pytest.mark.parametrize('location', [0.0, nan])
@pytest.mark.parametrize('follows', [-0.02, -5e-4, 0.01, 0.03])
def test_a_wall_that_a_controlled_force_follows_is_in_contact(
    follows: float, location: float,
) -> None:
    samples = contact(spring_damper(K, B), 4.0, shaken=0.0)
    x = samples.x + ramp(2.0, 1.5, follows)(samples.t)[0]
    posterior = WallPosterior(location, 2e-3, NO_LAG)
    states = [posterior.take(t, f, at) for t, f, at in zip(samples.t, samples.force, x)]
    assert set(states[1000:]) == {CONTACT}


def test_a_wall_that_presses_less_after_a_pull_is_in_contact() -> None:
    samples = contact(spring_damper(K, B), 3.5, shaken=0.0)
    t, force = samples.t, samples.force.copy()
    force[t > 2.0] *= 0.05
    force[(t > 2.0) & (t < 2.02)] = -5.0  # the sensor rings
    assert fed(samples._replace(force=force)).contact.state == CONTACT


@pytest.mark.parametrize('told', [-0.0065, -0.004])
def test_a_force_at_rest_near_a_wall_as_told_is_no_contact(told: float) -> None:
    samples = contact(spring_damper(K, B))
    known = fed(samples._replace(force=samples.force + 6.0), WallPosterior(told, 2e-3)).known
    assert within(known.stiffness, K, known.stiffness_std)
    assert known.stiffness_std < 0.01 * K


@pytest.mark.parametrize('seed', range(4))
def test_a_slow_press_on_a_wall_that_may_be_curved_has_a_band_that_holds_it(seed: int) -> None:
    t, v = np.arange(0.0, 4.0, 2e-3), 2.5e-3
    depth = np.minimum(v * t - 1.5e-3, 3.5e-3)
    rising = K * depth + 4e4 * depth * v * (depth < 3.5e-3)  # the damping of a spring alike
    draw = np.random.default_rng(seed)
    known = fed(Samples(
        t, np.maximum(rising, 0.0) + 0.2 * draw.standard_normal(len(t)),
        depth + 3e-6 * draw.standard_normal(len(t)), depth), WallPosterior(2e-3, 2e-3)).known
    assert within(known.stiffness, K, known.published_stds[0])


@pytest.mark.parametrize('step, at', [(5.0, 3.6), (2.0, 4.0)])
def test_a_step_of_the_zero_in_a_contact_is_forgotten_after_it(step: float, at: float) -> None:
    for stiffness, std in believed(step, at, 0.0, since=5.0):
        assert within(stiffness, K, max(std, 0.002 * K), 3.0)


@pytest.mark.parametrize('location', [0.0, nan])
@pytest.mark.parametrize('step', [-4.0, -2.0, 2.0, 4.0])
def test_the_band_in_a_hold_covers_a_step_of_the_zero(step: float, location: float) -> None:
    for stiffness, std in believed(step, 3.9, location, since=4.0, shaken=0.0):
        assert within(stiffness, K, max(std, 0.002 * K), 3.0)


@pytest.mark.parametrize('shaken', [0.0005, 0.002])
def test_the_band_of_a_stiffness_that_grows_in_a_hold_follows_it(shaken: float) -> None:
    def stiffness(t: Array) -> Array:
        return K * (1.0 + 0.05 * np.clip(t - 3.0, 0.0, 4.0))

    samples = contact(lambda d, v, a: stiffness(np.arange(len(d)) / FINE) * d + B * v, 8.0,
                      shaken=shaken, presses=((0.3, 2.5), (2.8, 7.9)), seed=2)
    posterior, found = WallPosterior(0.0, 2e-3, NO_LAG), []
    for t, f, x, truth in zip(*samples[:3], stiffness(samples.t)):
        posterior.take(t, f, x)
        if 3.5 < t < 7.4 and posterior.known.valid:
            found.append((posterior.known.stiffness / truth - 1.0,
                          posterior.known.stiffness_std / truth))
    off, std = np.array(found).T
    assert len(found) > 1900 and np.mean(np.abs(off)) < 0.06
    assert np.all(np.abs(off) < 4.0 * std)


@pytest.mark.parametrize('step', [-4.0, -2.0, 2.0, 4.0])
@pytest.mark.parametrize('location', [0.0, nan])
def test_a_constant_force_before_the_first_touch_is_a_zero_that_has_stepped(
    step: float, location: float,
) -> None:
    samples = contact(spring_damper(K, B), 2.0, shaken=0.0, presses=((1.0, 1.9),))
    posterior = WallPosterior(location, 2e-3, NO_LAG)
    for t, f, x, depth in zip(*samples):
        posterior.take(t, f + step * (t > 0.3), x)
        known = posterior.known
        if 0.8 < t < 1.0:
            assert posterior.contact.state == FREE
            assert posterior.contact.level == pytest.approx(step, abs=0.2)
        elif depth > 2e-3 and known.valid:
            assert within(known.stiffness, K, known.stiffness_std, 3.0)
    assert within(known.stiffness, K, 0.02 * K)


def test_what_is_all_but_impossible_does_not_widen_a_band() -> None:
    found = Wall(np.array([K, 1.0]), np.array([B, 1.0]), np.array([0.0, 0.1]), np.zeros((3, 2)))
    _, variances = mixture(np.array([1.0 - 2e-5, 2e-5]), found)
    assert max(variances) == 0.0


# -- surface, lag, rates, taps ------------------------------------------------------------------

@pytest.mark.parametrize('first_s', [0.7e-3, 0.62e-3])
def test_a_period_that_the_first_samples_mistake_is_refined(first_s: float) -> None:
    samples = contact(spring_damper(K, B), 3.0, rate=1500.0)
    stamps = samples.t.copy()
    stamps[:30] = stamps[30] - first_s * np.arange(30, 0, -1)
    known = fed(samples._replace(t=stamps)).known
    assert within(known.stiffness, K, known.stiffness_std)


def test_one_sample_a_second_is_enough() -> None:
    t = np.arange(0.0, 400.0)
    d = 1e-3 * np.sin(0.02 * t - 0.4)
    force = np.where(d > 0.0, K * d, 0.0) + 0.01 * np.random.default_rng(2).standard_normal(400)
    known = fed(Samples(t, force, d, d), WallPosterior(0.0, 2e-3, NO_LAG)).known
    assert within(known.stiffness, K, known.stiffness_std)


@pytest.mark.parametrize('metres', [0.1, 0.4])
def test_free_flight_inside_the_wall_as_told_says_that_it_is_elsewhere(metres: float) -> None:
    samples = contact(spring_damper(K, B), 4.0, shaken=0.0, noise=0.6, presses=((2.0, 4.0),))
    posterior = WallPosterior(0.0, 2e-3)
    for t, force, x, _ in zip(*(one.tolist() for one in samples)):
        posterior.take(t, force, x + metres)
        known = posterior.known
        if known.valid:
            assert within(known.stiffness, K, known.stiffness_std, 3.5)
    assert within(posterior.known.surface, metres, posterior.known.surface_std, 3.0)


# -- what must not enter ------------------------------------------------------------------------

@pytest.mark.parametrize('force, x', [
    (nan, 0.008), (40.0, nan), (np.inf, 0.008), (-np.inf, 0.008), (40.0, np.inf), (1e6, 0.008),
    (-1e6, 0.008)])
def test_nothing_that_is_no_measurement_enters(force: float, x: float) -> None:
    samples = contact(spring_damper(K, B), 2.0)
    posterior = fed(samples)
    before, state = posterior.known, posterior.contact.state
    variance = posterior.contact.variance
    for k in range(50):
        posterior.take(2.0 + 2e-3 * k, force, x)
    assert posterior.known == before
    assert (posterior.contact.state, posterior.contact.variance) == (state, variance)


# -- what an independent simulator found ----------------------------------------------------------

def test_positions_between_joint_states_have_the_noise_of_joint_states() -> None:
    draw, found = np.random.default_rng(3), []
    noise = 2e-5 * draw.standard_normal(4001)
    for share in (0.0, 0.5):  # where the wrench is stamped between two joint states
        samples = contact(spring_damper(K, B), 8.0, shaken=0.0, presses=((0.3, 7.8),))
        x = samples.x + ((1.0 - share) * noise[:-1] + share * noise[1:])[:len(samples.x)]
        found.append(fed(samples._replace(x=x)).blocks.noise[0] ** 0.5)
    assert found == pytest.approx([2e-5, 2e-5], rel=0.2)


def test_a_slow_touch_outside_of_the_known_wall_is_seen() -> None:
    posterior = fed(contact(spring_damper(18e3, B), 2.0, depth=0.002, noise=1.5, rate=1000.0,
                            presses=((0.3, 1.5),)))
    draw, t = np.random.default_rng(2), np.arange(2500) / 1000.0
    x = -0.008 + 1e-3 * t  # 1 mm/s; the wall is at -7 mm now
    force = 12e3 * np.maximum(x + 0.007, 0.0) + 1.5 * draw.standard_normal(len(t))
    states = [posterior.take(10.0 + one, f, at) for one, f, at in zip(t, force, x)]
    assert states[800] == FREE
    assert states[-1] == CONTACT  # at 12 standard deviations, 8 of them a second


def test_a_step_of_the_force_at_the_surface_is_no_singular_matrix() -> None:
    gram = np.zeros((COLUMNS, COLUMNS))
    gram[ONE, ONE] = 100.0  # of a tool at rest at depth 0
    assert np.isfinite(in_doubt(gram, gram, 0.0, 9.0)).all()


def test_what_noise_may_be_is_not_measured() -> None:
    contact_filter = ContactFilter()
    contact_filter.start(2.0 * np.random.default_rng(1).standard_normal(20), True)
    assert contact_filter.measured_std == pytest.approx(2.0, rel=0.5)
    assert contact_filter.noise_std > 2.0 * contact_filter.measured_std


def test_noise_of_the_position_is_larger_in_motion_where_stamps_have_errors() -> None:
    samples = contact(spring_damper(K, B), 6.0, shaken=0.0, presses=((1.0, 5.8),))
    stamps = samples.t + 1e-4 * np.random.default_rng(1).standard_normal(len(samples.t))
    x, found = np.interp(stamps, samples.t, samples.x), {}
    posterior = WallPosterior(0.0, 2e-3)
    for t, force, at in zip(samples.t, samples.force, x):
        posterior.take(t, force, at)
        found[round(t, 3)] = posterior.blocks.noise[0] ** 0.5
    assert found[0.9] < 2e-6
    assert 3e-6 < found[1.18] < 3e-5  # at up to 0.1 m/s
    assert found[2.0] < 2e-6
