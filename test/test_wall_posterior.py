# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from math import nan
from typing import Callable

from contact_estimation.estimators.multiple_model import (
    CONTACT, FREE, lag_prior, LAWS, WallPosterior)
from contact_estimation.estimators.multiple_model.contact import ContactFilter
from contact_estimation.estimators.multiple_model.evidence import mixture, Wall
from contact_estimation.estimators.multiple_model.laws import (
    COLUMNS, DEPTH, ONE, POWER, shifted_table, SQUARE)
from contact_estimation.estimators.multiple_model.runs import in_doubt
from contact_estimation.estimators.multiple_model.smoothing import Smoothing
from contact_estimation.studies.paths import ramp
import numpy as np
import pytest
from scipy.signal import lfilter
from wall_worlds import Array, contact, fed, FINE, Law, Samples, spring_damper

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

def judged(contact_filter: ContactFilter, forces: Array, places: Array | None = None) -> list[int]:
    states = []
    places = np.full(len(forces), -1.0) if places is None else places
    for force, x in zip(forces.tolist(), places.tolist()):
        contact_filter.take((2e-3,), (force,), (x,), nan, nan)
        states.append(contact_filter.state)
    return states


def started(draw: np.random.Generator, noise: float = 0.5) -> ContactFilter:
    contact_filter = ContactFilter()
    contact_filter.start(noise * draw.standard_normal(20), True)
    judged(contact_filter, noise * draw.standard_normal(500))
    return contact_filter


@pytest.mark.parametrize('seed', [1, 5])
def test_a_pull_and_a_touch_after_it_are_judged_at_once_as_one_by_one(seed: int) -> None:
    k, found = np.arange(1500), []
    x = np.where(k < 1000, 1e-3 * np.sin(0.02 * k) - 0.02, 2e-5 * (k - 1000))
    pull = np.where(k < 200, 0.0, np.where(k < 1000, -8.0 - 6.0 * np.sin(0.05 * k), -8.0))
    force = pull + np.maximum(0.1 * (k - 1000), 0.0) + 0.5 * np.random.default_rng(
        seed).standard_normal(1500)
    for size in (1, 400):
        contact_filter, done, changes = ContactFilter(), 0, []
        contact_filter.start(force[:20], True)
        while done < 1500:
            part, before = slice(done, done + size), contact_filter.state
            done += contact_filter.take(
                [2e-3] * size, force[part].tolist(), x[part].tolist(), 0.0, 1e-3)
            if contact_filter.state != before:
                changes.append((done, contact_filter.state))
        found.append((changes, contact_filter.level))
    assert found[0] == found[1] and found[0][0][-1][1] == CONTACT


def test_noise_alone_is_no_contact() -> None:
    draw = np.random.default_rng(5)
    assert set(judged(started(draw), 0.5 * draw.standard_normal(100_000))) == {FREE}


def test_slow_touch_is_found_before_eight_deviations_and_never_early() -> None:
    for slope in [5.0, 20.0, 100.0]:
        for seed in range(5):
            draw = np.random.default_rng(seed)
            contact_filter = started(draw)
            ramp = np.maximum(np.arange(3000) * 2e-3 - 1.0, 0.0) * slope
            force = 0.5 * (ramp + draw.standard_normal(len(ramp)))
            states = np.array(judged(contact_filter, force, 1e-3 * ramp - 1.0))
            first = int(np.flatnonzero(states == CONTACT)[0])
            assert 0.0 < ramp[first] < 8.0, (slope, seed)
            assert not np.any(states[first:] == FREE), (slope, seed)


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


# -- laws ---------------------------------------------------------------------------------------

def hunt_crossley(exponent: float) -> Law:
    def law(d: Array, v: Array, a: Array) -> Array:
        power = (np.maximum(d, 0.0) / 0.008)**exponent
        return power * (0.008 * K + 300.0 * v)

    return law


def growing(t: Array) -> Array:
    return np.asarray(K * (1.0 + 0.05 * np.clip(t - 1.0, 0.0, 4.0)))


def moved(t: Array) -> Array:
    return np.asarray(1e-3 * (ramp(1.2, 0.8, 1.0)(t) - ramp(2.2, 0.8, 1.0)(t)))


WORLDS: dict[str, tuple[Law, Callable[[Array], Array] | None]] = {
    'kelvin_voigt': (spring_damper(K, B), None),
    'mass': (lambda d, v, a: K * d + B * v + 2.0 * a, None),
    'friction': (lambda d, v, a: K * d + B * v + 5.0 * np.tanh(v / 4e-4), None),
    'hunt_crossley_1': (hunt_crossley(1.0), None),
    'hunt_crossley_1.5': (hunt_crossley(1.5), None),
    'hunt_crossley_2': (hunt_crossley(2.0), None),
    'moving_wall': (spring_damper(K, B), moved),
    'drifting_stiffness': (lambda d, v, a: growing(np.arange(len(d)) / FINE) * d + B * v, None),
}


@pytest.mark.slow
@pytest.mark.parametrize('name', LAWS)
def test_right_law_is_the_probable_one_after_three_seconds(name: str) -> None:
    law, wall = WORLDS[name]
    samples = contact(law, shaken=0.003, wall=wall)
    posterior = fed(samples, WallPosterior(0.0, 2e-3, NO_LAG))
    assert posterior.known.laws[LAWS.index(name)] > 0.5
    assert posterior.wall.law == name
    assert sum(posterior.known.laws) == pytest.approx(1.0)


def test_columns_follow_another_reference_to_second_order() -> None:
    smooth, delta = Smoothing(0.002), 3e-4
    x = 2e-3 + 1e-3 * np.sin(0.04 * np.arange(smooth.length(25)))
    before, after = (smooth.rows(x, x, np.full(len(x), nan), x0, (1e-12, 1e-12))
                     for x0 in (0.0, delta))
    moved = shifted_table(delta) @ before
    assert moved[[DEPTH, SQUARE]] == pytest.approx(after[[DEPTH, SQUARE]], rel=1e-9)
    assert moved[POWER] == pytest.approx(after[POWER], rel=1e-3)  # to first order 9e-3


@pytest.mark.parametrize('seed', [1, 2])
def test_a_curved_wall_is_seen_although_its_touch_is_felt_late(seed: int) -> None:
    samples = contact(hunt_crossley(1.5), depth=0.002, shaken=6e-4, noise=0.3, rate=250.0,
                      seed=seed)
    posterior = fed(samples, WallPosterior(nan, 2e-3))
    secant = K * (samples.depth[samples.t > 2.5].mean() / 0.008)**0.5
    assert posterior.wall.law == 'hunt_crossley_1.5'
    assert within(posterior.known.stiffness, secant, posterior.known.published_stds[0])


def test_band_holds_the_secants_of_all_recent_depths() -> None:
    samples = contact(hunt_crossley(1.5), 3.0, shaken=0.004)
    pressed = (samples.t > 1.6) & (samples.t < 2.4)
    posterior = fed(Samples(*(one[samples.t < 2.4] for one in samples)),
                    WallPosterior(0.0, 2e-3, NO_LAG))
    known = posterior.known
    std, _ = known.published_stds
    for depth in np.quantile(samples.depth[pressed], [0.05, 0.5, 0.95]):
        assert within(known.stiffness, K * (depth / 0.008)**0.5, std)
    assert known.stiffness_std < 0.02 * K < std


def held(law: Callable[[Array, Array], Array], depth: float, seed: int) -> Samples:
    """Return a steady ramp of 1 s and a hold of 5 s at 125 Hz, with 5 um of noise in x."""
    draw, t = np.random.default_rng(seed), np.arange(0.0, 7.0, 0.008)
    d = np.minimum(t - 1.0, 1.0) * depth
    force = np.where(d > 0.0, law(t, np.maximum(d, 0.0)), 0.0)
    return Samples(t, force + 0.05 * draw.standard_normal(len(t)),
                   0.1 + d + 5e-6 * draw.standard_normal(len(t)), d)


def test_noise_of_the_position_does_not_hide_the_damping_of_a_slow_press() -> None:
    samples = held(lambda t, d: 17e3 * d + 550.0 * np.gradient(d, t), 1.3e-3, 1)
    draw = np.random.default_rng(2)
    posterior = WallPosterior(0.1, 0.0, NO_LAG)
    x = samples.x + 1e-5 * draw.standard_normal(len(samples.x))
    known = fed(samples._replace(x=x), posterior).known
    assert within(known.damping, 550.0, known.damping_std, 3.0)
    assert within(known.stiffness, 17e3, max(known.stiffness_std, 0.003 * 17e3), 3.0)
    assert posterior.wall.law == 'kelvin_voigt'


@pytest.mark.parametrize('F_c, position_noise', [(1.0, 5e-6), (3.0, 1e-5)])
def test_noise_of_the_position_does_not_hide_the_sign_of_friction(
    F_c: float, position_noise: float
) -> None:
    samples = contact(lambda d, v, a: K * d + B * v + F_c * np.tanh(v / 4e-4), 4.0, 0.004, 3e-4,
                      noise=0.05, rate=1000.0, position_noise=position_noise)
    posterior = fed(samples)
    assert posterior.wall.law == 'friction'
    assert within(posterior.known.stiffness, K, posterior.known.stiffness_std, 3.0)
    assert abs(posterior.known.stiffness - K) < 0.01 * K


@pytest.mark.parametrize('seed', [0, 1])
def test_noise_of_the_force_in_a_hold_is_no_moving_wall(seed: int) -> None:
    draw, t = np.random.default_rng(seed), np.arange(0.0, 6.0, 0.002)
    d = np.minimum(2e-3 * (t - 1.0), 4e-4)
    force = 26e3 * np.maximum(d, 0.0) + draw.standard_normal(len(t))
    posterior, moving = WallPosterior(0.1, 2e-3, NO_LAG), LAWS.index('moving_wall')
    for sample in zip(t, force, 0.1 + d + 4e-6 * draw.standard_normal(len(t))):
        posterior.take(*sample)
        assert posterior.known.laws[moving] < 0.1


def relaxing(t: Array, d: Array) -> Array:
    """Return a spring of 8000 N/m beside one of 12000 N/m in series with a damper, of 1 s."""
    decay = np.exp(-0.008)
    return np.asarray(8e3 * d + 12e3 * lfilter([1.0], [1.0, -decay], np.diff(d, prepend=0.0)))


def yielding(t: Array, d: Array) -> Array:
    """Return a spring of 20000 N/m that yields at 5 N, from where it is as soft as 5000 N/m."""
    return np.asarray(np.where(d < 2.5e-4, 2e4 * d, 5.0 + 5e3 * (d - 2.5e-4)))


# Which slopes the law has anywhere [N/m].
UNLISTED: dict[str, tuple[Callable[[Array, Array], Array], float, float]] = {
    'softening': (lambda t, d: 20.0 * -np.expm1(-d / 1e-3), 2.7e3, 2e4),
    'stiffening': (lambda t, d: 4.0 * np.expm1(d / 1e-3), 4e3, 3e4),
    'relaxing': (relaxing, 8e3, 2e4),
    'yielding': (yielding, 5e3, 2e4),
}


@pytest.mark.parametrize('told', [0.1, nan])
@pytest.mark.parametrize('name', UNLISTED)
def test_no_slope_is_claimed_that_a_wall_of_another_law_never_has(name: str, told: float) -> None:
    law, least, most = UNLISTED[name]
    for seed in range(2):
        posterior, false, claims = WallPosterior(told, 2e-3), 0, 0
        for t, force, x, _ in zip(*(one.tolist() for one in held(law, 2e-3, seed))):
            if posterior.take(t, force, x) == CONTACT and posterior.known.valid:
                K_hat, _, std = posterior.known[:3]
                claims += 1
                false += not least - 3.0 * std <= K_hat <= most + 3.0 * std
        assert false <= 0.02 * claims


def test_cycles_claim_no_slope_that_a_stiffening_wall_never_has() -> None:
    law, least, most = UNLISTED['stiffening'][0], 4e3, 4e3 * np.exp(0.95)
    for seed in range(2):
        draw, t = np.random.default_rng(seed), np.arange(0.0, 8.0, 0.008)
        d = np.minimum(2.0 * t - 2.0, 1.0) * (
            0.6e-3 + 0.35e-3 * np.sin(2.0 * np.pi * 1.6 * (t - 1.0)))
        force = np.where(d > 0.0, law(t, np.maximum(d, 0.0)) + 20.0 * np.gradient(d, t), 0.0)
        posterior, false, claims = WallPosterior(0.1, 2e-3), 0, 0
        for sample in zip(t.tolist(), (force + 0.05 * draw.standard_normal(len(t))).tolist(),
                          (0.1 + d).tolist()):
            if posterior.take(*sample) == CONTACT and posterior.known.valid:
                std, _ = posterior.known.published_stds
                claims += 1
                false += not least - 2.0 * std <= posterior.known.stiffness <= most + 2.0 * std
        assert false <= 0.03 * claims
        assert claims > 400


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


def hertz(d: Array, v: Array, a: Array) -> Array:
    """Press a sphere into a wall."""
    return np.asarray(np.maximum(d, 0.0) ** 1.5 * (5e4 + 2e3 * v))


@pytest.mark.parametrize('told', [-1.7e-3, 1.7e-3])
def test_a_curved_wall_is_found_where_it_is_not_told_to_be(told: float) -> None:
    samples = contact(hertz, 3.0, depth=0.006, shaken=0.001)
    known = fed(samples, WallPosterior(told, 2e-3, NO_LAG)).known
    recent = samples.depth[samples.t > samples.t[-1] - 1.0].mean()
    assert LAWS[int(np.argmax(known.laws))] == 'hunt_crossley_1.5'
    assert within(known.stiffness, 5e4 * recent ** 0.5, known.published_stds[0])
    assert within(known.surface, 0.0, known.surface_std, 3.0) and known.surface_std < 1e-4


def test_a_curved_wall_elsewhere_is_another_one() -> None:
    posterior = WallPosterior(nan, 2e-3, NO_LAG)
    samples = contact(hertz, 3.0, depth=0.006, shaken=0.001, presses=((0.3, 2.5),))
    for k, shift in enumerate((0.0, 0.02, -0.01)):
        moved = samples._replace(t=samples.t + 10.0 * k, x=samples.x + shift)
        known = fed(moved, posterior).known
        assert LAWS[int(np.argmax(known.laws))] == 'hunt_crossley_1.5'
        assert within(known.surface, shift, known.surface_std, 3.0) and known.surface_std < 1e-4


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


@pytest.mark.parametrize('seed', range(3))
def test_errors_of_stamps_do_not_hide_a_mass_in_a_single_press(seed: int) -> None:
    samples = contact(lambda d, v, a: 1e3 * d + 8.0 * v + 2.0 * a, 2.0, 0.03, 0.0, seed=seed)
    stamps = samples.t + 1e-4 * np.random.default_rng(100 + seed).standard_normal(len(samples.t))
    posterior = fed(samples._replace(x=np.interp(stamps, samples.t, samples.x)))
    known = posterior.known
    assert posterior.wall.law == 'mass'
    assert within(known.stiffness, 1e3, known.stiffness_std)


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
