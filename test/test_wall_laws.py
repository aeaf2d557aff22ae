# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from math import nan
from typing import Callable

from contact_estimation.estimators.multiple_model import (
    CONTACT, lag_prior, LAWS, WallPosterior)
from contact_estimation.estimators.multiple_model.laws import (
    DEPTH, POWER, shifted_table, SQUARE)
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
    'curved': (lambda d, v, a: 13.0 * np.expm1(175.0 * np.maximum(d, 0.0)) + B * v, None),
    'yielding': (lambda d, v, a: K * (d - 0.3 * np.maximum.accumulate(np.maximum(d, 0.0))) + B * v,
                 None),
    'moving_wall': (spring_damper(K, B), moved),
    'drifting_stiffness': (lambda d, v, a: growing(np.arange(len(d)) / FINE) * d + B * v, None),
}


MOTIONS = 'moving_wall', 'creeping_wall'


@pytest.mark.slow
@pytest.mark.parametrize('name', [name for name in LAWS if name != 'creeping_wall'])
def test_right_law_is_the_probable_one_after_three_seconds(name: str) -> None:
    law, wall = WORLDS[name]
    samples = contact(law, shaken=0.003, wall=wall)
    posterior = fed(samples, WallPosterior(0.0, 2e-3, NO_LAG))
    alike = MOTIONS if name in MOTIONS else (name,)  # the speeds of two overlap
    assert sum(posterior.known.laws[LAWS.index(one)] for one in alike) > 0.5
    assert posterior.wall.law in alike
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


@pytest.mark.parametrize('speed', [-3e-3, 3e-3, 1e-2])
def test_a_wall_that_gives_way_at_a_constant_force_is_no_softer(speed: float) -> None:
    draw, t = np.random.default_rng(1), np.arange(0.0, 8.0, 0.002)
    moved = speed * np.maximum(t - 3.0, 0.0)
    behind = speed * 0.05 * -np.expm1(-np.maximum(t - 3.0, 0.0) / 0.05)
    d = np.clip(0.02 * (t - 1.0), -0.005, 2e-3) - behind
    rate = np.gradient(d, t)
    force = np.where(d > 0.0, K * d + B * rate, 0.0) + 0.1 * draw.standard_normal(len(t))
    posterior = WallPosterior(0.0, 2e-3, NO_LAG)
    for sample in zip(t, force, d + moved + 2e-6 * draw.standard_normal(len(t))):
        posterior.take(*sample)
        known = posterior.known
        if sample[0] > 2.0:
            assert within(known.stiffness, K, known.published_stds[0], 4.0)
    assert known.valid
    assert known.stiffness == pytest.approx(K, rel=0.05)


@pytest.mark.filterwarnings('error')
def test_a_touch_after_a_gap_leaves_what_walls_that_move_have_told() -> None:
    samples = contact(spring_damper(K, B), 6.0, presses=((0.3, 2.0), (3.0, 5.8)))
    posterior = WallPosterior(0.0, 2e-3, NO_LAG)
    for k, sample in enumerate(zip(*samples[:3])):
        if k == 1250:  # between the contacts
            posterior.restart()
        posterior.take(*sample)
    assert within(posterior.known.stiffness, K, posterior.known.stiffness_std)


@pytest.mark.parametrize('seed', [0, 1])
def test_noise_of_the_force_in_a_hold_is_no_moving_wall(seed: int) -> None:
    draw, t = np.random.default_rng(seed), np.arange(0.0, 6.0, 0.002)
    d = np.minimum(2e-3 * (t - 1.0), 4e-4)
    force = 26e3 * np.maximum(d, 0.0) + draw.standard_normal(len(t))
    posterior = WallPosterior(0.1, 2e-3, NO_LAG)
    for sample in zip(t, force, 0.1 + d + 4e-6 * draw.standard_normal(len(t))):
        posterior.take(*sample)
        assert sum(posterior.known.laws[LAWS.index(name)] for name in MOTIONS) < 0.1


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


@pytest.mark.parametrize('seed', range(3))
def test_errors_of_stamps_do_not_hide_a_mass_in_a_single_press(seed: int) -> None:
    samples = contact(lambda d, v, a: 1e3 * d + 8.0 * v + 2.0 * a, 2.0, 0.03, 0.0, seed=seed)
    stamps = samples.t + 1e-4 * np.random.default_rng(100 + seed).standard_normal(len(samples.t))
    posterior = fed(samples._replace(x=np.interp(stamps, samples.t, samples.x)))
    known = posterior.known
    assert posterior.wall.law == 'mass'
    assert within(known.stiffness, 1e3, known.stiffness_std)


@pytest.mark.parametrize('rate', [4e-3, 2e-2])
@pytest.mark.parametrize('seed', range(3))
def test_the_band_says_where_no_law_explains_a_wall_that_snaps(rate: float, seed: int) -> None:
    draw = np.random.default_rng(seed)
    depth = np.concatenate([[-1.0, 0.0, 1e-3], 1e-3 + np.cumsum(draw.uniform(3e-4, 1.2e-3, 40))])
    peaks, valleys = draw.uniform(15.0, 20.0, 20), draw.uniform(6.0, 10.0, 20)
    course = [0.0, 0.0, 20.0, *np.stack([valleys, peaks], 1).ravel()]
    t = np.arange(0.0, 1.0 + 0.034 / rate, 2e-3)
    x = np.minimum(rate * np.maximum(t - 1.0, 0.0) - 4e-3, depth[-1])
    force = np.interp(x, depth, course) + 0.1 * draw.standard_normal(len(t))
    known = fed(Samples(t, force, x + 1e-6 * draw.standard_normal(len(t)), x)).known
    assert not known.valid or known.published_stds[0] > 0.05 * known.stiffness
