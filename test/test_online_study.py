# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The on-line study: its worlds obey their closed forms, and a row of it runs."""

from __future__ import annotations

from pathlib import Path
import re

from contact_estimation.benchmarks.online_faults import FAULTS
from contact_estimation.benchmarks.online_paths import Array, Piece
from contact_estimation.benchmarks.online_study import main, ROWS
from contact_estimation.benchmarks.online_worlds import Sensor, simulate, Wall, World
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
