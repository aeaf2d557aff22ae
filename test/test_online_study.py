# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The on-line study: its worlds obey their closed forms, and a row of it runs."""

from __future__ import annotations

from pathlib import Path
import re
from typing import Callable

from contact_estimation.studies.benchmarks.online_inputs import FAULTS
from contact_estimation.studies.benchmarks.online_row import law_families, Trace
from contact_estimation.studies.benchmarks.online_study import main, make_parser, ROWS, scored
from contact_estimation.studies.benchmarks.online_worlds import (
    Array, bump, cruise, Piece, ramp, Sensor, simulate, sines, Wall, World)
import numpy as np
import pytest

SILENT = Sensor(lag_s=1.3e-3, noise=0.0, position_noise=0.0)
OMEGA, DEPTH, SWING = 40.0, 5e-3, 2e-3


def swinging(t: Array) -> Array:
    """Swing inside the wall."""
    return np.array([DEPTH + SWING * np.sin(OMEGA * t), SWING * OMEGA * np.cos(OMEGA * t),
                     -SWING * OMEGA**2 * np.sin(OMEGA * t)])


def world_of(wall: Wall, sensor: Sensor = SILENT, piece: Piece = swinging) -> World:
    return simulate('', {}, [piece], 1.0, wall, sensor, np.random.default_rng(1))


@pytest.mark.parametrize('poles', [1, 2])
def test_the_force_is_that_of_spring_damper_and_mass_through_the_filter(poles: int) -> None:
    wall = Wall(3000.0, 40.0, mass=0.5)
    t, _, force = world_of(wall, SILENT._replace(poles=poles)).wrenches
    s, tau = 1j * OMEGA, SILENT.lag_s
    filtered = 1.0 / (1.0 + s * tau) if poles == 1 else 1.0 / (1.0 + s * tau + (s * tau)**2 / 2.0)
    swing = SWING * (3000.0 + 40.0 * s + 0.5 * s**2) * filtered
    expected = 3000.0 * DEPTH + np.imag(swing * np.exp(s * t))
    settled = t > 0.05
    assert -force[settled, 0] == pytest.approx(expected[settled], abs=2e-4 * 3000.0 * DEPTH)


def test_a_hunt_crossley_wall_has_its_stiffness_at_the_mean_depth() -> None:
    wall = Wall(3000.0, 40.0, exponent=1.5, depth=DEPTH)
    truth = world_of(wall).truth
    assert truth.stiffness[-1] == pytest.approx(3000.0, rel=0.02)
    assert truth.damping[-1] == pytest.approx(40.0, rel=0.06)
    d, v, _ = swinging(truth.t)
    expected = (d / DEPTH)**1.5 * (3000.0 * DEPTH + 40.0 * v)
    assert truth.pressing == pytest.approx(expected, rel=1e-9)


def test_a_wall_does_not_pull_and_its_friction_opposes_the_motion() -> None:
    out = world_of(Wall(1000.0, 500.0), piece=lambda t: swinging(t) - [[DEPTH], [0.0], [0.0]])
    d, v, _ = swinging(out.truth.t)
    assert out.truth.pressing.min() == 0.0 and not out.truth.pressing[d < DEPTH].any()
    rubbed = world_of(Wall(3000.0, 0.0, friction=2.0)).truth.pressing - 3000.0 * d
    fast = np.abs(v) > 0.01
    assert rubbed[fast] == pytest.approx(2.0 * np.sign(v[fast]))


def test_measurements_have_the_noise_and_the_gaps_of_their_sensor() -> None:
    sensor = Sensor(noise=0.3, zero=0.1, velocity_noise=1e-3, rate=1000.0)
    free = simulate('', {}, [ramp(1.0, 0.5, -0.02)], 20.0, Wall(1e3, 1.0, location=0.2), sensor,
                    np.random.default_rng(2))
    errors = free.wrenches.stamp_ns - 10**18 - free.wrenches.t * 1e9
    assert np.std(errors) == pytest.approx(1e5, rel=0.03)
    assert np.mean(free.wrenches.values) == pytest.approx(0.1, abs=0.01)
    assert np.std(free.wrenches.values) == pytest.approx(0.3, rel=0.03)
    assert free.motions.values[-1, 0] == pytest.approx(0.18, abs=1e-5)
    assert np.std(free.motions.values[-9000:, 1]) == pytest.approx(1e-3, rel=0.03)
    assert len(free.motions.t) == pytest.approx(0.998 * 20000, abs=20)


PIECES: dict[str, Callable[[], Piece]] = {
    'ramp': lambda: ramp(0.2, 0.5, 0.01), 'cruise': lambda: cruise(0.2, 0.7, 0.02, 0.1),
    'sines': lambda: sines(0.1, 0.9, 0.003, np.random.default_rng(3)),
    'bump': lambda: bump(0.5, 0.3, 0.004)}


@pytest.mark.parametrize('name', PIECES)
def test_velocity_and_acceleration_are_the_derivatives_of_the_path(name: str) -> None:
    t = np.linspace(0.0, 1.0, 10001)
    x, v, a = PIECES[name]()(t)
    assert np.gradient(x, t)[1:-1] == pytest.approx(v[1:-1], abs=1e-4 * np.max(np.abs(v)))
    assert np.gradient(v, t)[1:-1] == pytest.approx(a[1:-1], abs=1e-2 * np.max(np.abs(a)))


@pytest.mark.parametrize('name', sorted(set(FAULTS) - {'clock back'}))
def test_a_fault_changes_nothing_but_the_messages_of_its_time(name: str) -> None:
    world = world_of(Wall(3000.0, 40.0))
    faulty = FAULTS[name](world, 0.3, 0.6, np.random.default_rng(4))
    same = True
    for before, after in ((world.wrenches, faulty.wrenches), (world.motions, faulty.motions)):
        outside = (before.t < 0.3) | (before.t >= 0.6)
        kept = (after.t < 0.3) | (after.t >= 0.6)
        assert np.array_equal(before.values[outside], after.values[kept], equal_nan=True)
        same &= np.array_equal(before.values, after.values, equal_nan=True)
    assert not same


def test_a_world_is_the_same_for_the_same_seed() -> None:
    make = ROWS['end_of_contact'].make
    first, again, other = (make(np.random.default_rng(seed), 0) for seed in (5, 5, 6))
    assert np.array_equal(first.wrenches.values, again.wrenches.values)
    assert not np.array_equal(first.wrenches.values[:100], other.wrenches.values[:100])


def test_a_told_wall_is_found_at_the_end_of_the_second_contact() -> None:
    name, score = scored(('end_of_contact_as_told', 0, 0))
    assert name == 'end_of_contact_as_told'
    assert abs(score.K_error) < 0.05
    assert score.K_held[1] > 20


def test_laws_of_a_family_add_up() -> None:
    nothing = np.zeros(0)
    laws = {'hunt_crossley_1': 0.3, 'hunt_crossley_1.5': 0.3, 'kelvin_voigt': 0.4}
    trace = Trace(nothing, nothing, nothing, nothing, nothing, nothing, nothing > 0.0, [],
                  [(1.0, laws)], '')
    assert law_families(trace, 0.9) == {}
    assert law_families(trace, 1.1) == {'hunt_crossley': 0.6, 'spring_damper': 0.4}


def test_a_row_prints_its_line_and_writes_every_world(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    monkeypatch.setitem(ROWS, 'taps', ROWS['taps']._replace(quick=1))
    assert main(['--only', 'taps', '--quick', '--json', str(tmp_path / 'study.json')]) == 0
    printed = capsys.readouterr().out
    assert re.search(r'\| taps: 20 ms, x_e as told \| 1 \| .*contacts detected', printed)
    assert '"K_error"' in (tmp_path / 'study.json').read_text()


@pytest.mark.parametrize(('arguments', 'message'), [
    (['--only', 'tap'], "--only must name rows .*taps.*, got 'tap'"),
    (['--seed', '-1'], '--seed must be >= 0, got -1'),
    (['--jobs', '0'], '--jobs must be >= 1, got 0'),
])
def test_bad_options_are_refused(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(arguments) == 1
    assert re.search(message, capsys.readouterr().err)


def test_the_help_lists_the_rows() -> None:
    text = make_parser().format_help()
    assert all(name in text for name in ROWS)
