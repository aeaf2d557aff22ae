# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from __future__ import annotations

from math import nan, sqrt
from typing import Callable

from contact_estimation.estimators.multiple_model import (
    CONTACT, FREE, lag_prior, LAWS, WallPosterior)
from contact_estimation.estimators.multiple_model.contact import ContactFilter
from contact_estimation.estimators.multiple_model.evidence import Hypotheses, judge, Scene
from contact_estimation.estimators.multiple_model.laws import (
    CHOSEN, COLUMNS, DEEP, FORCE, FORCE_RATE, prior, scales, shifted_table, UNKNOWNS)
from contact_estimation.estimators.multiple_model.smoothing import Smoothing
import numpy as np
import pytest
from scipy.stats import multivariate_normal
from wall_worlds import Array, contact, fed, Law, Samples, spring_damper, step

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
    assert within(known.stiffness, batch[0], known.stiffness_std)
    assert within(known.damping, batch[1], known.damping_std)
    assert known.stiffness_std < 0.01 * K


def test_is_within_two_standard_deviations_of_the_truth_as_often_as_it_says() -> None:
    errors = []
    for seed in range(8):
        known = fed(contact(spring_damper(K, B), seconds=2.0, noise=1.0, seed=seed),
                    WallPosterior(0.0, 2e-3, NO_LAG)).known
        errors += [abs(known.stiffness - K) / known.stiffness_std,
                   abs(known.damping - B) / known.damping_std]
    assert np.mean(np.array(errors) < 2.0) >= 0.85
    assert max(errors) < 4.0


@pytest.mark.parametrize('law', LAWS)
@pytest.mark.parametrize('lag', [0.0, 1e-3])
def test_evidence_is_the_marginal_likelihood_of_a_gaussian_model(law: str, lag: float) -> None:
    draw = np.random.default_rng(LAWS.index(law))
    count, index = 12, np.array([LAWS.index(law)])
    columns, weight = 0.01 * draw.standard_normal((COLUMNS, count)), 4.0
    columns[FORCE] *= 100.0
    scene = Scene(0.0, 0.5, 0.02, (lag, 5e-4))
    what = Hypotheses(index, np.array([30.0]), np.array([0.01]), np.array([0.05]))
    judged = judge((weight * columns @ columns.T)[None], scene, what)

    stretch = scales(index, scene.depth)[0]
    design = (columns[CHOSEN[index[0]]] * stretch[:, None])[:UNKNOWNS].T
    force = columns[FORCE] + (lag * columns[FORCE_RATE] if DEEP[index[0]] else 0.0)
    mean, std = (one[0] for one in prior(index, what.stiffness, scene.damping, scene.lag))
    std[0], std[3] = 1e4, 30.0 * 0.05  # K of any wall; s + K centre ~ N(0, (30 N/m std)^2)
    turn = np.eye(UNKNOWNS)
    turn[3, 0] = -what.centre[0]
    covariance = turn @ np.diag(std**2) @ turn.T
    expected = multivariate_normal(
        design @ mean, design @ covariance @ design.T + np.eye(count) / weight).logpdf(force)
    shared = 0.5 * count * np.log(weight / (2.0 * np.pi))  # of all hypotheses on these data
    assert judged.evidence[0] == pytest.approx(expected - shared, rel=1e-7, abs=1e-6)
    precision = np.linalg.inv(covariance) + weight * design.T @ design
    theta = np.linalg.solve(
        precision, np.linalg.inv(covariance) @ mean + weight * design.T @ force)
    assert judged.theta[0] == pytest.approx(theta, rel=1e-5, abs=1e-6)
    assert judged.P[0] == pytest.approx(np.linalg.inv(precision), rel=1e-5, abs=1e-9)


@pytest.mark.parametrize('law', [law for law in LAWS if law != 'hunt_crossley_1.5'])
def test_columns_move_exactly_to_another_surface(law: str) -> None:
    smooth = Smoothing(2e-3)
    t = np.arange(smooth.length(5)) * 2e-3
    x = 0.01 + 2e-3 * np.sin(20.0 * t)
    here, there = (smooth.rows(K * x, x, np.full_like(x, nan), x0, (1e-18, nan))
                   for x0 in (0.0, 1.5e-3))
    table = shifted_table(1.5e-3)
    used = list(CHOSEN[LAWS.index(law)])
    moved = (table @ here @ here.T @ table.T)[np.ix_(used, used)]
    assert moved == pytest.approx((there @ there.T)[np.ix_(used, used)], rel=1e-9, abs=1e-15)


# -- smoothing ----------------------------------------------------------------------------------

@pytest.mark.parametrize('rate', [100.0, 500.0, 1000.0])
def test_kernels_differentiate_parabolas_exactly(rate: float) -> None:
    smooth = Smoothing(1.0 / rate)
    t = (np.arange(smooth.length(3)) - smooth.half) / rate
    centres = t[smooth.half:-smooth.half:smooth.hop]
    a, b, c = 0.02, 0.3, -4.0
    phi = smooth.rows(a + b * t + c * t * t, a + b * t + c * t * t, np.full_like(t, nan), 0.0,
                      (1e-18, nan))
    shift = phi[1] - (a + b * centres + c * centres**2)  # what averaging a parabola adds
    assert shift == pytest.approx(shift[0])
    assert phi[2] == pytest.approx(b + 2.0 * c * centres)
    assert phi[3] == pytest.approx(2.0 * c)
    assert phi[FORCE_RATE] == pytest.approx(b + 2.0 * c * centres)


@pytest.mark.parametrize('rate', [100.0, 500.0, 1000.0])
def test_kernels_leave_of_white_noise_what_they_say(rate: float) -> None:
    smooth = Smoothing(1.0 / rate)
    windows = 4000
    noise = np.random.default_rng(0).standard_normal(smooth.length(windows))
    width = 2 * smooth.half + 1
    unit = np.zeros(smooth.length(1))
    found = []
    for row in (FORCE, FORCE_RATE):
        kernel = []
        for k in range(width):
            unit[:] = 0.0
            unit[k] = 1.0
            kernel.append(smooth.rows(unit, unit, np.full(width, nan), 0.0, (1e-18, nan))[row, 0])
        found.append(np.var(np.correlate(noise, kernel, 'valid')))
    assert found == pytest.approx([smooth.noise, smooth.rate_noise], rel=0.1)


# -- contact ------------------------------------------------------------------------------------

def judged(contact_filter: ContactFilter, forces: Array, x: float = -1.0) -> list[int]:
    states = []
    for force in forces.tolist():
        contact_filter.take((2e-3,), (force,), (x,), nan, nan)
        states.append(contact_filter.state)
    return states


def started(draw: np.random.Generator, noise: float = 0.5) -> ContactFilter:
    contact_filter = ContactFilter()
    contact_filter.start(noise * draw.standard_normal(20), True)
    judged(contact_filter, noise * draw.standard_normal(500))
    return contact_filter


def test_noise_alone_is_no_contact() -> None:
    draw = np.random.default_rng(5)
    assert set(judged(started(draw), 0.5 * draw.standard_normal(100_000))) == {FREE}


@pytest.mark.parametrize('slope', [5.0, 20.0, 100.0])  # [deviations / s]
@pytest.mark.parametrize('seed', range(5))
def test_slow_touch_is_found_before_eight_deviations_and_never_early(
    slope: float, seed: int
) -> None:
    draw = np.random.default_rng(seed)
    contact_filter = started(draw)
    ramp = np.maximum(np.arange(3000) * 2e-3 - 1.0, 0.0) * slope
    states = np.array(judged(contact_filter, 0.5 * (ramp + draw.standard_normal(len(ramp)))))
    first = int(np.flatnonzero(states == CONTACT)[0])
    assert 0.0 < ramp[first] < 8.0
    assert not np.any(states[first:] == FREE)


def test_noise_alone_is_no_contact_in_the_first_second_either() -> None:
    touched = 0
    for seed in range(200):
        forces = np.random.default_rng(seed).standard_normal(520)
        contact_filter = ContactFilter()
        contact_filter.start(forces[:20], True)
        touched += CONTACT in judged(contact_filter, forces[20:])
    assert touched == 0


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


def test_first_estimate_of_an_impact_on_a_damper_is_within_its_deviation() -> None:
    t = np.arange(0.0, 0.62, 2e-3)
    for touch in 0.5255 + 2e-3 * np.arange(5):  # early and late in a block
        s = t - touch
        d = 0.073 * s + np.where(s > 0.0, 0.8 * s * s, 0.0)
        v = 0.073 + 1.6 * s
        draw = np.random.default_rng(0)
        force = np.where(s > 0.0, 4800.0 * d + 200.0 * v, 0.0) + 0.3 * draw.standard_normal(len(t))
        assert worst_error(Samples(t, force, d, d), 4800.0) < 4.0


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


@pytest.mark.parametrize('factor', [0.4, 3.0])
def test_learns_another_wall_at_the_next_touch(factor: float) -> None:
    presses = ((0.2, 2.0), (2.5, 4.5))
    first, second = (contact(spring_damper(k * K, k * B), 4.0, presses=presses)
                     for k in (1.0, factor))
    mixed = first._replace(force=np.where(first.t < 2.2, first.force, second.force))
    known = fed(mixed).known
    assert known.stiffness == pytest.approx(factor * K, rel=0.02)
    assert within(known.stiffness, factor * K, known.stiffness_std, 3.0)


# -- laws ---------------------------------------------------------------------------------------

def hunt_crossley(exponent: float) -> Law:
    def law(d: Array, v: Array, a: Array) -> Array:
        power = (np.maximum(d, 0.0) / 0.008)**exponent
        return power * (0.008 * K + 300.0 * v)

    return law


def moved(t: Array) -> Array:
    return np.asarray(1e-3 * (step(t, 1.2, 0.8) - step(t, 2.2, 0.8)))


WORLDS: dict[str, tuple[Law, Callable[[Array], Array] | None]] = {
    'kelvin_voigt': (spring_damper(K, B), None),
    'mass': (lambda d, v, a: K * d + B * v + 2.0 * a, None),
    'friction': (lambda d, v, a: K * d + B * v + 5.0 * np.tanh(v / 4e-4), None),
    'hunt_crossley_1': (hunt_crossley(1.0), None),
    'hunt_crossley_1.5': (hunt_crossley(1.5), None),
    'hunt_crossley_2': (hunt_crossley(2.0), None),
    'moving_wall': (spring_damper(K, B), moved),
}


@pytest.mark.parametrize('name', LAWS)
def test_right_law_is_the_probable_one_after_three_seconds(name: str) -> None:
    law, wall = WORLDS[name]
    samples = contact(law, shaken=0.003, wall=wall)
    posterior = fed(samples, WallPosterior(0.0, 2e-3, NO_LAG))
    assert posterior.known.laws[LAWS.index(name)] > 0.5
    assert posterior.wall.law == name
    assert sum(posterior.known.laws) == pytest.approx(1.0)


def test_mass_is_told() -> None:
    known = fed(contact(WORLDS['mass'][0], shaken=0.003), WallPosterior(0.0, 2e-3, NO_LAG)).known
    assert known.inertia == pytest.approx(2.0, abs=0.2)


# -- surface, lag, rates, taps ------------------------------------------------------------------

def test_unknown_surface_is_found() -> None:
    known = fed(contact(spring_damper(K, B), surface=0.123), WallPosterior()).known
    assert within(known.surface, 0.123, known.surface_std)
    assert known.surface_std < 1e-3
    assert within(known.stiffness, K, known.stiffness_std)


@pytest.mark.parametrize('pole_s, delay_s', [(1e-3, 0.0), (0.0, 1e-3)])
def test_lag_of_the_sensor_is_learned(pole_s: float, delay_s: float) -> None:
    posterior = fed(contact(
        spring_damper(K, 250.0), 4.0, shaken=0.003, pole_s=pole_s, delay_s=delay_s))
    known = posterior.known
    assert within(known.damping, 250.0, known.damping_std)
    assert within(posterior.wall.lag.lag[0], 1e-3, posterior.wall.lag.lag[1])
    assert posterior.wall.lag.lag[1] < 0.5e-3


@pytest.mark.parametrize('rate', [
    100.0,
    125.0, 200.0, 333.0, 500.0, 1000.0])
def test_rate_of_the_samples_is_measured(rate: float) -> None:
    posterior = fed(contact(spring_damper(K, B), rate=rate), WallPosterior(0.0, 2e-3, NO_LAG))
    known = posterior.known
    assert posterior.period_s == pytest.approx(1.0 / rate)
    assert within(known.stiffness, K, known.stiffness_std)
    assert within(known.damping, B, known.damping_std)


def taps(count: int) -> Samples:
    """Tap for 40 ms each, on a path of half sines [m]; the touches are between samples."""
    t = np.arange(0.0, 0.5 * (count + 1), 2e-3)
    within_period = t % 0.4993
    phase = (within_period - 0.4593) / 0.04 * np.pi  # each ends the period
    tapping = (phase > 0.0) & (t > 0.4993)
    d = np.where(tapping, 5e-3 * np.sin(phase), -5e-3 * np.sin(within_period / 0.4593 * np.pi))
    d[(phase > 0.0) & (t < 0.4993)] = 0.0
    v = np.where(tapping, 5e-3 * np.pi / 0.04 * np.cos(phase), 0.0)
    force = np.where(tapping, np.maximum(K * d + 10.0 * v, 0.0), 0.0)
    draw = np.random.default_rng(2)
    return Samples(t, force + 0.1 * draw.standard_normal(len(t)),
                   d + 1e-6 * draw.standard_normal(len(t)), d)


def test_short_taps_add_up() -> None:
    few, many = fed(taps(2)).known, fed(taps(10)).known
    assert many.stiffness == pytest.approx(K, rel=0.1)
    assert within(many.stiffness, K, many.stiffness_std)
    assert many.damping_std < 0.5 * few.damping_std
    assert many.stiffness_std < 1.2 * few.stiffness_std  # limited by the surface


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


def test_single_wild_sample_changes_little() -> None:
    samples = contact(spring_damper(K, B), 2.0)
    wild = samples.force.copy()
    wild[700] += 500.0
    right, other = fed(samples).known, fed(samples._replace(force=wild)).known
    assert other.stiffness == pytest.approx(right.stiffness, abs=right.stiffness_std)
    assert other.damping == pytest.approx(right.damping, abs=right.damping_std)


def test_equal_samples_give_equal_estimates() -> None:
    samples = contact(spring_damper(K, B), 1.0)
    assert fed(samples).known == fed(samples).known


def test_standard_deviation_falls_as_the_noise_does() -> None:
    stds = [fed(contact(spring_damper(K, B), 2.0, noise=noise)).known.damping_std
            for noise in (0.1, 3.0)]
    assert stds[0] < stds[1]
    assert sqrt(stds[1]) < sqrt(B)
