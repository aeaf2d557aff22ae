# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The zero of the force sensor: tared once, and tracked."""

from functools import lru_cache
import json
from pathlib import Path
from typing import Any

import contact_estimation as ce
from contact_estimation.commands.replay import main as replay
from contact_estimation.diagnosis.checks.quantities import Quantities
from contact_estimation.diagnosis.checks.signs_and_axes import axis
from contact_estimation.diagnosis.observe.signals import Signals
from contact_estimation.plant.plant_parameters import PlantParameters, WallParameters
from contact_estimation.plant.simulation import simulate_experiment
from contact_estimation.recordings.recorded_signals import FIRST, tare_of
from contact_estimation.signals.conditioning import ZeroTracker
from contact_estimation.signals.stream_faults import zero_steps
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
    ((3.0,), 3.0, 0.0)])
def test_first_free_flight_presses_least(
    levels: tuple[float, ...], zero: float, begin: float
) -> None:
    found = tare_of(T, force(*levels), FIRST)
    assert found.force == pytest.approx(zero, abs=0.02)
    assert found.begin_s == pytest.approx(begin, abs=0.01)


@pytest.mark.parametrize('tare, text', [
    ('soon', 'must be first-free-flight, tracked, or a span .*example'), ('3:x', 'must be'),
    ('30:40', 'no wrench from 30 to 40 s'), (FIRST, 'no 0.5 s in which the force is steady')])
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
    (['--params', 'p.yaml'], False)])
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
    return axis(Quantities(signals, MODEL)).ok


def test_a_dome_that_buckles_is_accepted() -> None:
    bottom = 60.0 * np.maximum(DEPTH - 3.8e-3, 0.0) / 4e-3
    dome = np.sin(4.0 * np.pi * DEPTH / 4e-3) + bottom
    assert abs(np.corrcoef(dome, DEPTH)[0, 1]) < 0.2
    assert found_with(0.1 * dome)


def test_a_force_that_differs_on_the_way_out_is_refused() -> None:
    wanders = np.sin(2.0 * np.pi * (TIMES - 20.0) / 10.0)
    assert abs(np.corrcoef(wanders, DEPTH)[0, 1]) < 0.2
    assert not found_with(wanders)


TRUE_K = 4800.0


@lru_cache(maxsize=1)
def touches() -> Any:
    """Return time, force and position of three touches."""
    run = simulate_experiment(
        ce.PlantParameters(sensors=ce.SensorParameters(force_noise=0.3)),
        ce.experiment_named('rich'))
    return run.stamp_ns, run.measured[0], run.measured[1]


def drifting(folder: Path, rate: float) -> Path:
    """Write what a sensor records whose zero drifts by so many N/s."""
    stamp_ns, force, x = touches()
    t = 1e-9 * (stamp_ns - stamp_ns[0])
    path = folder / 'run.mcap'
    ce.write_recording(
        path, {'t_ns': stamp_ns, 'wrench.force.x': force + 4.0 + rate * t, 'joint.x': x})
    return path


def test_tracker_is_the_least_squares_line_of_a_steady_drift() -> None:
    t = np.arange(0.0, 2.0, 0.002)
    force = 0.4 * t + np.random.default_rng(1).normal(0.0, 0.1, len(t))
    tracker = ZeroTracker()
    for value in force:
        tracker.predict(0.002)
        tracker.correct(value - tracker.zero, 0.1)
    slope, level = np.polyfit(t - t[-1], force, 1)
    assert tracker.zero == pytest.approx(level, abs=0.03)
    assert tracker.drift == pytest.approx(slope, abs=0.05)


@pytest.mark.parametrize('rate', [0.0, 0.5])
def test_a_tracked_zero_takes_the_drift_out_of_the_stiffness(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], rate: float
) -> None:
    run, errors = drifting(tmp_path, rate), {}
    for tare in ('first-free-flight', 'tracked'):
        Command('replay', replay, capfd)(run, '--tare', tare, '--json', tmp_path / 'a.json',
                                         '--csv', tmp_path / 'a.csv')
        summary = json.loads((tmp_path / 'a.json').read_text())
        rows = np.genfromtxt(tmp_path / 'a.csv', delimiter=',', names=True, dtype=None,
                             encoding='utf-8')
        rows = rows[rows['status'] == 'estimating']
        errors[tare] = float(np.median(np.abs(rows['stiffness'] / TRUE_K - 1.0)))
    inside = np.abs(rows['stiffness'] - TRUE_K) < 2.0 * rows['stiffness_std']
    assert np.mean(inside) > 0.9
    assert errors['tracked'] < 0.01
    assert not rate or errors['tracked'] < 0.5 * errors['first-free-flight']
    names = {one['name'] for one in summary['warnings']}
    assert not names & {'force_bias', 'zero_step'}


def test_a_tracked_zero_leaves_a_band_where_the_surface_is_unknown(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / 'a.yaml').write_text(
        '/**: {ros__parameters: {environment: {location: .nan}}}\n')
    Command('replay', replay, capfd)(
        drifting(tmp_path, 0.5), '--tare', 'tracked', '--params', tmp_path / 'a.yaml', '--json',
        tmp_path / 'a.json')
    summary = json.loads((tmp_path / 'a.json').read_text())
    assert abs(summary['stiffness'] - TRUE_K) < 2.0 * summary['stiffness_std'] < 0.01 * TRUE_K


def test_a_step_of_a_tracked_zero_is_told(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    stamp_ns, force, x = touches()
    stepped = force + np.where(np.arange(len(x)) > 250, 6.0, 0.0)  # 0.5 s, in free flight
    ce.write_recording(tmp_path / 'run.mcap', {
        't_ns': stamp_ns, 'wrench.force.x': stepped, 'joint.x': x})
    Command('replay', replay, capfd)(
        tmp_path / 'run.mcap', '--tare', 'tracked', '--json', tmp_path / 'a.json')
    told = [one['text'] for one in json.loads((tmp_path / 'a.json').read_text())['warnings']
            if one['name'] == 'zero_step']
    assert told and 'stepped by +6 N' in told[0]


@pytest.mark.parametrize('place', ['in free flight', 'in contact'])
def test_a_step_of_a_tracked_zero_is_followed_where_it_is_seen_and_else_told(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], place: str
) -> None:
    stamp_ns, force, x = touches()
    pressing = np.flatnonzero(force < -10.0)
    at = 250 if place == 'in free flight' else int(pressing[200])
    stepped = force + np.where(np.arange(len(x)) > at, -6.0, 0.0)
    run = tmp_path / 'run.mcap'
    ce.write_recording(run, {'t_ns': stamp_ns, 'wrench.force.x': stepped, 'joint.x': x})
    recording = ce.read_recording(run, parameters={'force_sensor.zero': 'tracked'})
    left = recording.signals.force - force
    if place == 'in free flight':
        assert np.sqrt(np.mean(left**2)) < 0.4  # of 6 N, for the 40 ms until it is seen
        return
    end = int(pressing[200]) + int(np.argmax(x[pressing[200]:] < -0.005))
    assert np.median(left[end:]) - np.median(left[:at]) == pytest.approx(-6.0, abs=0.2)
    Command('replay', replay, capfd)(run, '--tare', 'tracked', '--json', tmp_path / 'a.json')
    told = [one['text'] for one in json.loads((tmp_path / 'a.json').read_text())['warnings']
            if one['name'] == 'zero_step']
    assert told and any(f'stepped by {N} N between' in told[0] for N in ('-6', '-5.9'))


def test_diagnosis_takes_the_force_less_its_tracked_zero(tmp_path: Path) -> None:
    run = drifting(tmp_path, 0.5)
    found = ce.read_recording(run, parameters={'force_sensor.zero': 'tracked'}).signals
    error = found.force - touches()[1]
    assert np.abs(error).max() < 0.2 and np.sqrt(np.mean(error**2)) < 0.05


@pytest.mark.parametrize('step, drift', [(-6.0, 0.0), (0.0, -6.0 / 4.5), (0.0, 0.0)])
def test_a_step_between_short_flights_is_found_and_a_drift_is_none(
    step: float, drift: float
) -> None:
    t = np.concatenate([np.arange(begin, end, 0.01) for begin, end in (
        (0.0, 0.6), (5.3, 5.46), (9.9, 10.16), (15.5, 15.9))])
    noise = np.random.default_rng(1).normal(0.0, 0.3, len(t))
    found = zero_steps(t, step * (t > 7.0) + drift * t + noise, 0.3)
    assert len(found) == (step != 0.0)
    for one in found:
        assert one.size == pytest.approx(step, abs=0.3)
        assert 5.4 < one.begin < one.end < 10.0


def test_a_zero_that_settles_makes_no_step() -> None:
    t = np.concatenate([np.arange(0.0, 0.8, 0.002), np.arange(3.6, 5.3, 0.002)])
    noise = np.random.default_rng(1).normal(0.0, 0.2, len(t))
    assert zero_steps(t, -1.7 - 5.3 * np.exp(-t / 4.4) + noise, 0.2) == []
    assert len(zero_steps(t, 3.0 * (t > 2.0) + noise, 0.2)) == 1


def test_a_zero_that_warms_up_or_a_wall_that_sticks_makes_no_step() -> None:
    rng = np.random.default_rng(1)
    t = np.concatenate([np.arange(0.0, 1.5, 0.002), np.arange(3.0, 4.7, 0.002),
                        np.arange(7.2, 8.0, 0.002)])
    warming = 2.5 * (1.0 - np.exp(-t / 6.0)) - 1.2 * (1.0 - np.exp(-t / 1.5))
    assert zero_steps(t, warming + rng.normal(0.0, 0.12, len(t)), 0.12) == []
    sticking = np.where((t > 3.0) & (t < 3.03) | (t > 7.2) & (t < 7.24), 2.0, 0.0)
    assert zero_steps(t, sticking + rng.normal(0.0, 0.12, len(t)), 0.12) == []
