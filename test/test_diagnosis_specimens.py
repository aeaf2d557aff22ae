# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Specimens that are attached for good, and simulations as the nominal model."""

from functools import lru_cache
import json
from pathlib import Path

from concealed_worlds import ATTACHED, attached, diagnosed, named, nominal, physics
from contact_estimation.commands import diagnose, simulate
from contact_estimation.diagnosis.diagnose import estimated_model
from contact_estimation.diagnosis.observe.signals import read_recording, Signals
from contact_estimation.diagnosis.result import Diagnosis
import numpy as np
import pytest
from run_commands import Command
from scipy.signal import lfilter
import yaml

MODEL = nominal(environment__stiffness=15.0, environment__damping=50.0,
                environment__unilateral=False)
RATE_HZ, DEPTH, TAU_S = 20.0, 0.04, 10.0


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
def diagnosis(
    elastic: bool = True, loss: bool = True, back_s: float = 30.0, stray: float = 0.004
) -> Diagnosis:
    return diagnosed(pulled(elastic, loss, back_s, stray), MODEL)


def families(found: Diagnosis) -> set[str]:
    return {effect.family for effect in found.effects}


@pytest.mark.slow
def test_law_and_loss_are_named() -> None:
    found = diagnosis()
    law, loss = sorted(found.effects, key=lambda effect: effect.family)
    assert law.family == 'elastic_law'
    assert loss.family in ('relaxation', 'friction')  # one loop, at one speed
    assert found.verdict == 'physics_missing'
    assert found.compared is not None
    compared = {one.key for one in found.compared.models}
    best = found.compared.models[0].key
    assert {best - {effect} for effect in best} <= compared  # each name against none


@pytest.mark.slow
def test_a_loss_is_named_beside_the_law_if_both_ways_are_as_fast() -> None:
    found = diagnosis(back_s=45.0)
    law, loss = sorted(found.effects, key=lambda effect: effect.family)
    assert law.family == 'elastic_law'
    assert loss.name in {'presliding_friction', 'viscoelastic_relaxation'}


@pytest.mark.slow
def test_a_short_way_back_on_which_the_force_is_lost_tells_that_it_yields() -> None:
    t = np.arange(1200) / RATE_HZ
    x = DEPTH * np.interp(t, (0.0, 45.0, 55.0), (0.0, 1.0, 0.84))
    force = 15.0 * x - 75.0 * (np.maximum.accumulate(x) - x)
    force += np.random.default_rng(3).normal(0.0, 1e-3, len(t))
    found = diagnosed(Signals(t, -force, t, x, np.empty(0), np.empty((4, 0))), MODEL)
    assert families(found) == {'hysteresis'}
    backwards = Signals(t, force, t, x, np.empty(0), np.empty((4, 0)))
    assert 'it would be an engine' in str(diagnosed(backwards, MODEL).checks)


ZERO, F_C, B_E, PERIOD = 250.0, 6.0, 600.0, 5.0
LAW = 'coulomb_friction'


def bowed(share: float) -> Diagnosis:
    """Diagnose a bar with an intercept that bends by a share of its force, which strays, too."""
    t = np.arange(690) / RATE_HZ
    s = t / t[-1]
    x = 2.6e-3 + 1.46e-3 * s
    random = np.random.default_rng(2)
    stray = 22.0 * np.sin(3.0 * t) * np.sin(0.7 * t) + random.normal(0.0, 4.5, len(t))
    force = -1.02e7 * (x - 0.9e-3) - 1.49e4 * share * (1.0 - (2.0 * s - 1.0)**2) + stray
    model = nominal(environment__stiffness=1e7, environment__damping=1e8,
                    environment__unilateral=False)
    return diagnosed(Signals(t, force, t, x, np.empty(0), np.empty((4, 0))), model)


def test_a_bend_within_what_instruments_leave_is_no_law() -> None:
    assert named(bowed(0.01)) == ['force_bias']
    assert families(bowed(0.05)) == {'sensor_zero', 'elastic_law'}


def held(t: np.ndarray, x: np.ndarray, force: np.ndarray) -> Signals:
    """Return signals of what is not moved by a robot."""
    return Signals(t, -force, t, x, np.empty(0), np.empty((4, 0)))


def test_a_wall_that_snaps_through_has_an_elastic_law_and_no_resonance() -> None:
    # Pressed at one speed, its force looks like an oscillation in time.
    t = np.arange(4 * 20 * 100) / 100.0
    x = 0.008 * np.interp(t % 20.0, (2.0, 10.0, 18.0), (-0.2, 1.0, -0.2))
    d = np.maximum(x, 0.0) / 0.008
    force = 300.0 * d - 750.0 * d**2 + 500.0 * d**3 + 3.0 * d * (1.0 - d)
    force += np.random.default_rng(4).normal(0.0, 0.02, len(t))
    model = nominal(environment__stiffness=2000.0, environment__damping=100.0)
    found = diagnosed(held(t, x, force), model)
    assert families(found) == {'elastic_law'}
    assert found.effects[0].share > 0.95


@lru_cache(maxsize=None)
def piston(bias: float) -> Diagnosis:
    """Push a piston to and fro: a damper that rubs, with a trifle that no law has."""
    t = np.arange(0.0, 60.0, 0.02)
    x = 0.01 * np.sin(2.0 * np.pi * t / PERIOD) + 0.004 * np.sin(2.0 * np.pi * t / 3.7)
    v = np.gradient(x, t)
    force = bias - B_E * v - F_C * np.tanh(v / 1e-4) + 0.8 * np.sin(900.0 * x)
    noise = np.random.default_rng(3).normal(0.0, 0.02, len(t))
    return diagnosed(
        Signals(t, force + noise, t, x, t[:0], np.empty((4, 0))),
        nominal(environment__unilateral=False, environment__stiffness=1000.0,
                environment__damping=B_E))


@pytest.mark.slow
def test_friction_is_named_tared_or_not() -> None:
    tared, untared = piston(0.0), piston(ZERO)
    assert [one.name for one in tared.effects] == [LAW]
    assert [one.name for one in untared.effects] == ['force_bias', LAW]
    assert untared.effects[0].parameters['bias'].value == pytest.approx(ZERO, rel=0.01)
    for found in (tared, untared):
        assert found.effects[-1].parameters['F_c'].value == pytest.approx(F_C, rel=0.05)


NO_REFERENCE = (np.empty(0), np.empty((4, 0)))
MASS, DRAG, DRY, BIAS = 90.0, 200.0, 20.0, 3.0  # of a linear drive


@pytest.mark.slow
def test_offset_of_an_attached_wall_is_a_bias_of_the_sensor() -> None:
    found = diagnosed(attached(*physics('force_bias', 5.0).items()), nominal(**ATTACHED))
    assert named(found) == ['force_bias']
    assert found.effects[0].parameters['bias'].value == pytest.approx(5.0, rel=0.02)


@lru_cache(maxsize=None)
def drive() -> Signals:
    """Record a drive without a spring that is controlled in position, integrated here."""
    rate, fine = 500, 10
    h = 1.0 / rate / fine
    t = np.arange(6 * rate) / rate
    wanted = 0.05 * np.sin(2.0 * t) + 0.02 * np.sin(5.3 * t + 1.0)
    wanted_rate = 0.1 * np.cos(2.0 * t) + 0.106 * np.cos(5.3 * t + 1.0)
    x, v = float(wanted[0]), float(wanted_rate[0])
    force, position = np.empty(len(t)), np.empty(len(t))
    for k in range(len(t)):
        push = 4e4 * (wanted[k] - x) + 3e3 * (wanted_rate[k] - v)
        force[k], position[k] = push, x
        for _ in range(fine):  # the controller holds its output
            v += h / MASS * (push - DRAG * v - DRY * np.tanh(v / 4e-4))
            x += h * v
    noise = np.random.default_rng(1).normal(size=(2, len(t)))
    measured = -force + BIAS + 0.2 * noise[0]
    return Signals(t, measured, t, position + 2e-7 * noise[1], *NO_REFERENCE)


@lru_cache(maxsize=None)
def of_drive() -> Diagnosis:
    """Diagnose the drive from its linear model, which has the wrong drag."""
    return diagnosed(drive(), nominal(
        environment__stiffness=0.0, environment__damping=300.0, environment__inertia=MASS,
        environment__unilateral=False))


@pytest.mark.slow
def test_dry_friction_and_bias_of_a_drive_are_named() -> None:
    found = of_drive()
    assert found.verdict == 'physics_missing'
    assert sorted(named(found)) == ['coulomb_friction', 'force_bias']
    values = {effect.name: effect.parameters for effect in found.effects}
    assert values['coulomb_friction']['F_c'].value == pytest.approx(DRY, rel=0.03)
    assert values['force_bias']['bias'].value == pytest.approx(BIAS, rel=0.03)


WORLDS = {'plain': {}, 'simulator': {'cubic_stiffness': {'K_3': 2e6}},
          'real': {'cubic_stiffness': {'K_3': 2e6}, 'coulomb_friction': {'F_c': 6.0}}}


@pytest.fixture(scope='module')
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Hold recordings of a simulator with law A, and of the real thing with A and B."""
    folder = tmp_path_factory.mktemp('simulation')
    for seed, (name, laws) in enumerate(WORLDS.items()):
        values = {'environment': {'stiffness': 4300.0, 'damping': 260.0, 'location': 0.003},
                  'robot': {'mass': 30.0, 'damping': 700.0, 'stiffness': 4000.0},
                  'sensors': {'force_noise': 0.05, 'position_noise': 1e-6}, 'physics': laws}
        (folder / f'{name}.yaml').write_text(
            yaml.safe_dump({'plant_node': {'ros__parameters': values}}))
        assert simulate.main(['--model', str(folder / f'{name}.yaml'), '--experiment', 'rich',
                              '--seed', str(seed), '--output', str(folder / f'{name}.mcap')]) == 0
    return folder


def test_robot_wall_and_surface_of_a_simulator_are_estimated(folder: Path) -> None:
    model = estimated_model(read_recording(folder / 'plain.mcap'))
    robot, wall = model.robot, model.environment
    assert (robot.mass, robot.damping, robot.stiffness) == pytest.approx(
        (30.0, 700.0, 4000.0), rel=0.01)
    assert (wall.stiffness, wall.damping) == pytest.approx((4300.0, 260.0), rel=0.01)
    assert wall.location == pytest.approx(0.003, abs=2e-5)


@pytest.mark.slow
def test_the_law_that_the_simulator_lacks_is_named_and_the_one_it_has_is_not(
    folder: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    command = Command('diagnose', diagnose.main, capfd)
    ended = command(folder / 'real.mcap', '--simulation', folder / 'simulator.mcap', '--json',
                    tmp_path / 'r.json')
    assert ended.code == 0, ended.err
    assert 'it has cubic stiffness\n' in ended.out
    report = json.loads((tmp_path / 'r.json').read_text())
    assert [one['name'] for one in report['effects']] == ['coulomb_friction']
    assert report['effects'][0]['parameters']['F_c']['value'] == pytest.approx(6.0, rel=0.02)
    assert 'cubic_stiffness' in [one['name'] for one in report['simulation']['effects']]
    refused = command.refusal(folder / 'real.mcap', '--simulation', folder / 'real.mcap')
    assert 'same data' in refused
