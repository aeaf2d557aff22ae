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

"""Worlds of blind_trials: what is drawn, how well it is concealed, what the sensors add."""

from __future__ import annotations

from dataclasses import replace

from blind_setups import made_up_run, ROBOT, SETUP, short_trial, WALL
from contact_estimation.blind_trials.concealment import acting, conceal, degree, residual
from contact_estimation.blind_trials.drawing import draw_trial, LEAST, MOST, plan_effects, port_of
from contact_estimation.blind_trials.experiments import draw_experiment, Faded, Stage
from contact_estimation.blind_trials.sensing import NOTED_HZ, record
from contact_estimation.blind_trials.setups import draw_nominal, draw_setup, Sensing, Setup
from contact_estimation.blind_trials.simulation import Run, simulate
from contact_estimation.blind_trials.strengths import draw_strength, wall_alike
from contact_estimation.blind_trials.unknown import UNKNOWN
from contact_estimation.physics import EFFECTS
from contact_estimation.physics.physics import Scales
from contact_estimation.reference.excitation import Sine
import numpy as np
import pytest

NOT_MAGNITUDES = {'frequency', 'damping_ratio', 'first', 'last', 'tau', 'wavelength'}
SCALES = Scales(0.02, 0.1, 80.0, 150.0, 0.0, 15.0, 4000.0, 100.0, 20.0)


def rms_of(port: str, setup: Setup, run: Run) -> float:
    """Square, average and root what is left at a port."""
    return float(np.sqrt(np.nanmean(residual(port, setup, run) ** 2)))


def slow_press(count: int = 20000) -> Run:
    """Note down a force that grows evenly, at the rate at which worlds are noted down."""
    t = np.arange(count) / NOTED_HZ
    still = np.zeros(count)
    return Run(t, 0.001 * t, still + 0.001, -10.0 * t, -10.0 * t, still, still, still)


# -- drawing --------------------------------------------------------------------------------


def test_a_plan_has_every_effect_once_before_any_comes_twice() -> None:
    effects = plan_effects(2 * len(EFFECTS), 5)
    assert sorted(effects[:len(EFFECTS)]) == sorted(EFFECTS)
    assert sorted(effects[len(EFFECTS):]) == sorted(EFFECTS)
    assert plan_effects(7, 5) == effects[:7]


@pytest.mark.parametrize('name', EFFECTS)
def test_a_stronger_effect_departs_further_and_none_is_neutral(name: str) -> None:
    strength = draw_strength(name, SCALES, np.random.default_rng(1))
    neutral = EFFECTS[name].neutral

    def departure(s: float) -> float:
        values = strength(s)
        if 'limit' in values:
            return max(SCALES.force, SCALES.control) - values['limit']
        return sum(abs(v - neutral.get(k, 0.0)) for k, v in values.items() if k != 'K_n')

    assert departure(0.2) < departure(0.4)
    cls = EFFECTS[name]
    assert cls(cls.Parameters(**strength(0.3))).plausible(cls.Parameters(**strength(0.3)))


def test_an_effect_new_to_the_library_is_drawn_from_its_own_start(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(EFFECTS, 'new', EFFECTS['viscoelastic_relaxation'])
    K_1, tau = EFFECTS['new'].starts(SCALES)[0]
    values = draw_strength('new', SCALES, np.random.default_rng(0))(0.5)
    assert values == {'K_1': 15.0 * K_1, 'tau': tau}


def test_the_nominal_wall_is_off_by_what_the_study_allows() -> None:
    rng = np.random.default_rng(0)
    off = [draw_nominal(WALL, rng, exactly=0.0) for _ in range(300)]
    K = np.array([w.stiffness for w in off]) / WALL.stiffness - 1.0
    B = np.array([w.damping for w in off]) / WALL.damping - 1.0
    assert 0.2 < np.max(np.abs(K)) <= 0.25
    assert 0.5 < np.max(np.abs(B)) <= 0.6
    assert draw_nominal(WALL, rng, exactly=1.0) == WALL


def test_a_quarter_is_without_velocity_and_a_fifth_loses_samples() -> None:
    rng = np.random.default_rng(0)
    drawn = [draw_setup(rng).sensing for _ in range(800)]
    assert 0.2 < np.mean([s.velocity_noise is None for s in drawn]) < 0.3
    assert 0.16 < np.mean([s.dropped > 0.0 for s in drawn]) < 0.24


def test_a_wall_without_a_linear_damper_is_modelled_by_its_damping_at_half_the_depth() -> None:
    assert wall_alike('hunt_crossley_damping', {'chi': 2000.0}, SETUP).damping == 15.0
    assert wall_alike('coulomb_friction', {'F_c': 3.0}, SETUP) == WALL


def test_what_is_asked_of_the_robot_is_gentle_and_its_derivatives_are_right() -> None:
    for seed in range(6):
        plan = draw_experiment(Stage(0.0, -0.02, 0.05), np.random.default_rng(seed))
        t = np.arange(0.0, plan.duration, 1e-3)
        x, v, _, _ = np.array([plan.desired(s) for s in t.tolist()]).T
        jumps = np.abs(np.diff(x)) > 0.002  # of a binary sequence
        rate = np.diff(x) / 1e-3
        assert np.max(np.abs(rate - 0.5 * (v[1:] + v[:-1]))[~jumps]) < 2e-3
        assert plan.desired(plan.duration).position == pytest.approx(-0.02)


def test_a_faded_sine_has_the_rates_of_its_values() -> None:
    faded, h = Faded(Sine(2.0, 9.0), 1.0, 3.0), 1e-5
    for t in (1.1, 1.25, 2.0, 2.85):
        first, second = faded.rates(t)
        before, now, after = (faded.value(t + k * h) for k in (-1, 0, 1))
        assert first == pytest.approx((after - before) / (2.0 * h), rel=1e-5)
        assert second == pytest.approx((after - 2.0 * now + before) / h**2, rel=1e-3, abs=1e-3)
    assert faded.value(0.9) == faded.value(3.1) == 0.0


# -- concealment ----------------------------------------------------------------------------


def test_a_spring_damper_leaves_nothing_of_its_own_kind() -> None:
    assert rms_of('contact', SETUP, made_up_run()) < 1e-9


def test_what_a_refitted_spring_damper_leaves_matches_the_normal_equations() -> None:
    run = made_up_run()
    extra = np.where(run.force < 0.0, -0.7 * np.tanh(run.v / 4e-4), 0.0)
    on = (run.force < 0.0) & (run.x > 0.0)
    touching = run.x > 0.0
    A = np.column_stack((run.x, run.v))[on]
    K, B = np.linalg.solve(A.T @ A, -A.T @ (run.force + extra)[on])
    predicted = np.minimum(0.0, -K * run.x - B * run.v)[touching]
    left = float(np.sqrt(np.mean(((run.force + extra)[touching] - predicted) ** 2)))
    assert rms_of('contact', SETUP, made_up_run(run.force + extra)) == pytest.approx(left)


def test_an_effect_is_concealed_by_the_noise_of_its_own_recording() -> None:
    run = made_up_run()
    biased = made_up_run(run.force + 0.5 * np.sin(40.0 * run.t))
    left = rms_of('contact', SETUP, biased)
    r = degree('force_sensor', SETUP, biased, run)
    assert r == pytest.approx(np.hypot(1.0, left / SETUP.sensing.force_std), rel=1e-6)
    assert degree('contact', SETUP, run, run) == 1.0


def test_a_robot_effect_is_held_against_the_noise_of_its_impedance_equation() -> None:
    rng, run, sensing = np.random.default_rng(3), made_up_run(count=40000), SETUP.sensing
    x = sensing.position_std * rng.standard_normal(len(run.t))
    still = 0.0 * run.x
    F = sensing.force_std * rng.standard_normal(len(run.t))
    noise = rms_of('robot', SETUP, Run(run.t, x, still, still, F, still, still, still))
    pushed = Run(run.t, still, still, still, still + 3.0, still, still, still)
    nothing = Run(run.t, *(still for _ in range(7)))
    r = degree('robot', SETUP, pushed, nothing)
    assert r == pytest.approx(np.hypot(1.0, 3.0 / noise), rel=0.02)


def test_the_impedance_equation_holds_of_its_own_robot_alone() -> None:
    own = simulate(SETUP, {}, 500.0)
    other = simulate(SETUP, {'robot_friction.F_c': 6.0}, 500.0)
    assert rms_of('robot', SETUP, own) < 0.4
    assert rms_of('robot', SETUP, other) > 2.0
    stiff = replace(SETUP, robot=replace(ROBOT, stiffness=5000.0))
    wrong = float(np.sqrt(np.mean((1000.0 * (own.x - own.x_r)) ** 2)))
    assert rms_of('robot', stiff, own) == pytest.approx(wrong, rel=0.02)


def test_an_effect_shows_while_it_acts() -> None:
    t = np.arange(4000) / 500.0
    left = np.where((t > 2.0) & (t < 2.5) | (t > 2.7) & (t < 3.0) | (t > 6.0), 3.0, 0.02)
    left[:100] = np.nan
    (first, second), (third, fourth) = acting(left, t)
    assert (first, second, third) == pytest.approx((2.0, 3.0, 6.0), abs=0.1)
    assert fourth == pytest.approx(t[-1], abs=0.01)
    assert acting(np.full(4000, np.nan), t) == []


@pytest.mark.parametrize('name', UNKNOWN)
def test_an_effect_outside_the_library_shows_at_its_port_and_is_in_no_parameter_file(
    name: str,
) -> None:
    values = UNKNOWN[name].draw(SCALES._replace(duration=3.0), np.random.default_rng(2))(0.2)
    physics = {f'{name}.{key}': value for key, value in values.items()}
    without, run = simulate(SETUP, {}, 500.0), simulate(SETUP, physics, 500.0)
    port = port_of(name)
    assert name not in EFFECTS
    assert rms_of(port, SETUP, run) > 3.0 * rms_of(port, SETUP, without) + 1e-3
    nothing = {key: value if key in NOT_MAGNITUDES else 0.0 for key, value in values.items()}
    if 'mass' not in nothing:  # a mass of 0 has no acceleration
        again = simulate(SETUP, {f'{name}.{key}': v for key, v in nothing.items()}, 500.0)
        np.testing.assert_allclose(again.force, without.force, atol=1e-9)


def test_a_magnitude_is_found_that_conceals_as_asked() -> None:
    found = conceal(lambda s: float(np.hypot(1.0, 80.0 * s**1.4)), 2.5)
    assert found.degree == pytest.approx(2.5, rel=0.02)
    assert not found.plain


def test_an_effect_too_weak_for_a_world_is_given_at_its_strongest() -> None:
    found = conceal(lambda s: float(np.hypot(1.0, 0.5 * s)), 3.0)
    assert (found.strength, found.plain) == (1.0, False)


def test_an_effect_that_no_magnitude_conceals_is_told_so() -> None:
    assert conceal(lambda s: 40.0 + s, 2.0).plain
    assert conceal(lambda s: 1.0 if s < 1e-3 else 30.0, 2.0).plain


@pytest.mark.slow
def test_a_trial_is_concealed_as_drawn() -> None:
    trial = draw_trial('coulomb_friction', np.random.default_rng(4))
    rate = trial.setup.sensing.rate
    run = simulate(trial.setup, trial.physics, rate)
    r = degree('contact', trial.setup, run, simulate(trial.setup, {}, rate))
    assert LEAST <= trial.wanted <= MOST
    assert r == pytest.approx(trial.wanted, rel=0.1)


def test_nothing_is_missing_from_a_clean_world() -> None:
    trial = draw_trial('', np.random.default_rng(4))
    assert (trial.effect, trial.values, trial.physics) == ('', {}, {})


def test_a_trial_without_effect_obeys_eq_3() -> None:
    run = simulate(SETUP, short_trial().physics, 500.0)
    d = run.x - WALL.location
    wall = np.where(d > 0.0, np.minimum(0.0, -WALL.stiffness * d - WALL.damping * run.v), 0.0)
    assert np.allclose(run.force, wall, atol=1e-9)
    assert np.min(run.force) < -30.0


# -- sensors --------------------------------------------------------------------------------


def test_force_noise_is_as_strong_as_told() -> None:
    for distribution in ('normal', 'uniform'):
        sensing = Sensing(force_noise=0.5, distribution=distribution)
        recorded = record(slow_press(), sensing, np.random.default_rng(0))
        assert recorded.force_floor == pytest.approx(0.5, rel=0.05)
        wrong = recorded.force.values + 10.0 * recorded.force.stamps * 1e-9
        assert float(np.std(wrong)) == pytest.approx(recorded.force_floor, rel=1e-3)


def test_readings_are_multiples_of_the_steps() -> None:
    sensing = Sensing(force_step=0.25, position_step=2e-5)
    recorded = record(slow_press(), sensing, np.random.default_rng(0))
    for values, step in ((recorded.force.values, 0.25), (recorded.joint.values[:, 0], 2e-5)):
        assert np.allclose(values / step, np.round(values / step), atol=1e-6)


def test_the_anti_alias_filter_does_not_delay_what_is_slow() -> None:
    sensing = Sensing(force_noise=0.0, low_pass=100.0)
    force = record(slow_press(), sensing, np.random.default_rng(0)).force
    assert np.allclose(force.values[50:], -10e-9 * force.stamps[50:], atol=2e-3)


def test_stamps_jitter_and_rise_and_some_samples_are_lost() -> None:
    sensing = Sensing(jitter=4e-5, dropped=0.02)
    force, joint, _, _ = record(slow_press(), sensing, np.random.default_rng(0))
    steps = np.diff(force.stamps) * 1e-9
    whole = steps[steps < 0.003]
    assert np.min(steps) > 0.0
    assert float(np.std(whole)) == pytest.approx(4e-5 * 2.0**0.5, rel=0.1)
    assert 0.005 < np.mean(steps > 0.003) < 0.04
    assert list(force.stamps) != list(joint.stamps)


def test_joint_samples_between_those_of_the_force_are_stamped_so() -> None:
    sensing = Sensing(position_noise=0.0, position_step=0.0, joint_phase=0.5)
    joint = record(slow_press(), sensing, np.random.default_rng(0)).joint
    assert joint.stamps[0] == 1_000_000
    assert np.allclose(joint.values[:, 0], 0.001 * joint.stamps * 1e-9)
