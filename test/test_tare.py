# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The zero of the force, and the axis on which it acts."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import contact_estimation as ce
from contact_estimation.commands.replay import main as replay
from contact_estimation.diagnosis.checks.evidence import Evidence
from contact_estimation.diagnosis.checks.signs_and_axes import axis
from contact_estimation.diagnosis.observe.signals import Signals
from contact_estimation.plant.plant_parameters import PlantParameters, WallParameters
from contact_estimation.plant.simulation import simulate_experiment
from contact_estimation.recordings.recorded_signals import FIRST, tare_of
import numpy as np
from numpy.typing import NDArray
import pytest
from run_commands import Command

T = np.arange(0.0, 10.0, 0.002)


def force(*levels: float) -> NDArray[np.float64]:
    """Return steady forces, each for an equal time, with noise."""
    noise = np.random.default_rng(4).normal(0.0, 0.1, len(T))
    return np.repeat(levels, len(T) // len(levels)) + noise


@pytest.mark.parametrize('levels, zero, begin', [
    ((8.0, -22.0, 8.0, -32.0, 8.0), 8.0, 0.0),
    ((-52.0, -20.0, -60.0, -20.0), -20.0, 2.5),  # begins in contact
    ((6.0, -24.0, 0.0, -30.0, 0.0), 6.0, 0.0),  # the driver zeroes at half time
    ((0.0, -30.0, 6.0, -24.0), 0.0, 0.0),
    ((3.0,), 3.0, 0.0),
])
def test_first_free_flight_presses_least(
    levels: tuple[float, ...], zero: float, begin: float
) -> None:
    found = tare_of(T, force(*levels), FIRST)
    assert found.force == pytest.approx(zero, abs=0.02)
    assert found.begin_s == pytest.approx(begin, abs=0.01)


@pytest.mark.parametrize('tare, text', [
    ('soon', 'must be first-free-flight, tracked, or a span .*example'), ('3:x', 'must be'),
    ('30:40', 'no wrench from 30 to 40 s'), (FIRST, 'no 0.5 s in which the force is steady'),
])
def test_tare_without_free_flight_is_refused(tare: str, text: str) -> None:
    with pytest.raises(ce.ContactEstimationError, match=text):
        tare_of(T, np.sin(9.0 * T), tare)


@pytest.fixture(scope='module')
def untared(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return two touches measured by a sensor with an offset of 8 N."""
    run = simulate_experiment(ce.PlantParameters(), ce.experiment_named('sine'))
    path = tmp_path_factory.mktemp('tare') / 'run.mcap'
    ce.write_recording(path, {
        't_ns': run.stamp_ns, 'wrench.force.x': 8.0 + run.measured[0],
        'joint.x': run.measured[1]})
    return path


@pytest.mark.parametrize('options, warned', [
    ([], True), (['--tare', FIRST], False), (['--tare', '0:0.5'], False),
    (['--params', 'p.yaml'], False),
])
def test_tare_or_declared_bias_silences_the_warning(
    untared: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str], options: list[str],
    warned: bool
) -> None:
    (tmp_path / 'p.yaml').write_text(
        '/**: {ros__parameters: {physics: {force_bias: {bias: 8.0}}}}')
    paths = [str(tmp_path / one) if one == 'p.yaml' else one for one in options]
    ended = Command('replay', replay, capfd)(untared, '--json', tmp_path / 'a.json', *paths)
    summary: dict[str, Any] = json.loads((tmp_path / 'a.json').read_text())
    assert ('force_bias' in {one['name'] for one in summary['warnings']}) is warned
    assert ('give --tare first-free-flight' in ended.err) is warned
    if '--tare' in options:
        assert summary['tare']['x']['force'] == pytest.approx(8.0, abs=0.01)
        assert 'tare: 8 N subtracted from the force' in ended.out


TIMES = np.arange(0.0, 40.0, 0.02)
DEPTH = 4e-3 * (1.0 - np.abs(TIMES - 20.0) / 20.0)  # pressed and released once
MODEL = PlantParameters(environment=WallParameters(stiffness=250.0, damping=0.0))


def found_with(force: NDArray[np.float64]) -> bool:
    """Return whether the axis is accepted."""
    noise = 1e-3 * np.random.default_rng(5).standard_normal(len(TIMES))
    signals = Signals(TIMES, -force + noise, TIMES, DEPTH, np.empty(0), np.empty((4, 0)))
    return axis(Evidence(signals, MODEL)).ok


def test_a_dome_that_buckles_is_accepted() -> None:
    bottom = 60.0 * np.maximum(DEPTH - 3.8e-3, 0.0) / 4e-3
    dome = np.sin(4.0 * np.pi * DEPTH / 4e-3) + bottom
    assert abs(np.corrcoef(dome, DEPTH)[0, 1]) < 0.2
    assert found_with(0.1 * dome)


def test_a_force_that_differs_on_the_way_out_is_refused() -> None:
    wanders = np.sin(2.0 * np.pi * (TIMES - 20.0) / 10.0)
    assert abs(np.corrcoef(wanders, DEPTH)[0, 1]) < 0.2
    assert not found_with(wanders)
