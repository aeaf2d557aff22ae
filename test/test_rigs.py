# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Rigs of blind_trials: integration, nuisances, degree by which a law stands out, files."""

from __future__ import annotations

from dataclasses import replace
import json
from pathlib import Path
from typing import Any

from blind_worlds import EXPERIMENT, ROBOT, WALL, WORLD
import contact_estimation as ce
from contact_estimation.commands.blind_trials import main
from contact_estimation.diagnosis.observe.signals import signals_of
from contact_estimation.parameters.file import read_parameter_file
from contact_estimation.plant.plant_parameters import WallParameters
from contact_estimation.recordings import RecordingReader
from contact_estimation.recordings.recorded_signals import read_signals
from contact_estimation.recordings.source import RecordingSource
from contact_estimation.studies.blind_trials.family_scoring import NEUTRAL
from contact_estimation.studies.blind_trials.rig import (
    disturbed, draw_nuisances, Nuisances, planned_motion, Rig, simulate_rig)
from contact_estimation.studies.blind_trials.rig_trial import (
    degree,
    draw_rig_trial,
    integration_rate,
    magnitudes_of,
    MAX_DEGREE,
    MIN_DEGREE,
    rig_residual,
)
from contact_estimation.studies.blind_trials.rig_worlds import draw_rig, STAGES
from contact_estimation.studies.blind_trials.study import plan_study
from contact_estimation.studies.blind_trials.trial import TrialFiles, write_rig_trial
from contact_estimation.studies.blind_trials.worlds import Run, SensorModel, simulate
from contact_estimation.studies.foreign_laws import ALL_LAWS, FOREIGN_LAWS, UNKNOWN_LAWS
import numpy as np
import pytest

NONE = Nuisances(0.0, 0.0, 0.0, 50.0, 0.0, 1.0, 0.0, 0.0)
RIG = Rig('press', WALL, ROBOT, SensorModel(), EXPERIMENT, NONE, 0.015)
ATTACHED = WallParameters(stiffness=4000.0, damping=100.0, inertia=2.0, unilateral=False)
SPECIMEN = replace(RIG, stage='specimen', wall=ATTACHED, robot=None)


def run_of(rig: Rig, name: str = '', rate: float = 2000.0, **values: float) -> Run:
    """Simulate a rig under a law."""
    law = ALL_LAWS[name](values) if name else None
    return simulate_rig(rig, law, rate, np.random.default_rng(0))


# -- integration ------------------------------------------------------------------------------


def test_a_rig_without_nuisances_and_law_moves_as_the_plant() -> None:
    rig, plant = run_of(RIG), simulate(WORLD, {}, 500.0, 2000.0)
    assert np.max(np.abs(rig.x[::4] - plant.x)) < 2e-6
    assert np.sqrt(np.mean((rig.force[::4] - plant.force) ** 2)) < 0.02


def test_friction_of_the_robot_agrees_with_that_of_the_plant() -> None:
    rig = run_of(replace(RIG, nuisances=replace(NONE, robot_friction=4.0)))
    plant = simulate(WORLD, {'robot_friction.F_c': 4.0}, 500.0, 2000.0)
    without = run_of(RIG)
    changed = np.max(np.abs(without.x[::4] - plant.x))
    assert np.max(np.abs(rig.x[::4] - plant.x)) < 0.2 * changed  # the plant's creeps at rest


def test_the_force_of_an_attached_specimen_is_that_of_eq_3() -> None:
    run = run_of(SPECIMEN)
    a = planned_motion(EXPERIMENT, 2000.0)[1][:, 2]
    assert run.force == pytest.approx(-(4000.0 * run.x + 100.0 * run.v + 2.0 * a), abs=1e-9)
    assert not np.any(run.x_r)


@pytest.mark.parametrize('name', ['flexible_mount', 'flexible_joint'])
def test_a_compliance_is_in_series_with_the_wall(name: str) -> None:
    run = run_of(RIG, name, mass=1.0, stiffness=12000.0, damping=40.0)
    resting = (run.force < -20.0) & (np.abs(run.v) < 1e-5)
    assert np.any(resting)
    stiffness = -run.force[resting] / run.x[resting]
    expected = 1.0 / (1.0 / 4000.0 + 1.0 / 12000.0)
    assert np.median(stiffness) == pytest.approx(expected, rel=1e-3)


def test_a_wall_that_breathes_carries_the_force_with_it() -> None:
    breath = {'amplitude': 1e-3, 'frequency': 2.0, 'power': 4.0, 'phase': 0.0}
    run = run_of(RIG, 'breathing_surface', **breath)
    law = ALL_LAWS['breathing_surface'](breath)
    shift, rate = np.array([law.surface(t) for t in run.t.tolist()]).T  # type: ignore
    d, v = run.x - shift, run.v - rate
    wall = np.where(d > 0.0, np.minimum(0.0, -4000.0 * d - 100.0 * v), 0.0)
    assert np.max(np.abs(run.force - wall)) < 0.05 * np.max(np.abs(run.force))


def test_a_held_command_moves_the_robot_late() -> None:
    plain, late = run_of(RIG), run_of(RIG, 'sampled_command', period=0.01, delay=0.02)
    assert np.array_equal(plain.x_r, late.x_r)  # recorded as sent
    rising = slice(700, 1400)
    lags = [np.sum((late.x[rising] - plain.x[700 - k:1400 - k]) ** 2) for k in range(100)]
    assert np.argmin(lags) / 2000.0 == pytest.approx(0.025, abs=0.004)


# -- nuisances --------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize('stage', STAGES)
def test_nuisances_are_about_one_percent_of_the_force(stage: str) -> None:
    shares = []
    for seed in range(3):
        rig = draw_rig(stage, np.random.default_rng(seed))
        run = run_of(rig, rate=integration_rate(rig, final=False))
        left = float(np.sqrt(np.mean(rig_residual('contact', rig, run) ** 2)))
        shares.append(left / float(np.percentile(np.abs(run.force), 99.0)))
    assert 5e-4 < np.median(shares) < 0.03


def test_bias_cable_and_hum_appear_on_the_force() -> None:
    t = np.arange(2000) / 1000.0
    x, still = 0.01 * t, np.zeros(2000)
    n = replace(NONE, bias=0.5, cable=30.0, hum=0.2)
    added = disturbed(t, x, still, n, np.random.default_rng(0))
    phi = np.column_stack((np.ones(2000), x, np.sin(2.0 * np.pi * 50.0 * t)))
    theta = np.linalg.lstsq(phi, added, rcond=None)[0]
    assert theta == pytest.approx([0.5, -30.0, 0.2])


def test_coloured_noise_has_its_size_and_corner() -> None:
    t = np.arange(200_000) / 1000.0
    n = replace(NONE, colour=0.3, colour_corner=5.0)
    noise = disturbed(t, 0.0 * t, 0.0 * t, n, np.random.default_rng(0))
    assert np.std(noise) == pytest.approx(0.3, rel=0.05)
    lag = float(np.mean(noise[32:] * noise[:-32]) / np.var(noise))
    assert lag == pytest.approx(np.exp(-2.0 * np.pi * 5.0 * 0.032), abs=0.06)


def test_nuisances_scale_with_the_ranges() -> None:
    small, large = (draw_nuisances(f, 0.01, 0.004 * f, np.random.default_rng(3))
                    for f in (1.0, 100.0))
    assert large.bias == pytest.approx(100.0 * small.bias)
    assert large.cubic == small.cubic


# -- degree -----------------------------------------------------------------------------------


def test_degree_grows_with_the_law_and_is_one_without() -> None:
    rig = replace(RIG, nuisances=draw_nuisances(60.0, 0.015, 0.3, np.random.default_rng(0)))
    without = run_of(rig)
    values = {'F_c': 1.0, 'F_s': 1.2, 'v_s': 0.01, 'sigma_0': 2e4, 'sigma_1': 10.0}
    weak = degree('contact', rig, run_of(rig, 'lugre_friction', **values), without)
    values.update(F_c=4.0, F_s=4.8, sigma_0=8e4)
    strong = degree('contact', rig, run_of(rig, 'lugre_friction', **values), without)
    assert degree('contact', rig, without, without) == 1.0
    assert 1.0 < weak < strong


def test_magnitudes_are_those_of_the_run() -> None:
    run = run_of(RIG)
    m = magnitudes_of(RIG, run)
    assert (m.stiffness, m.damping, m.mass) == (4000.0, 100.0, 20.0)
    assert m.depth == pytest.approx(run.x.max())
    assert m.force == pytest.approx(-run.force.min(), rel=0.05)
    assert m.control == pytest.approx(m.force, rel=0.2)  # at rest they balance


@pytest.mark.slow
@pytest.mark.parametrize('name', ALL_LAWS)
def test_a_law_stands_out_two_to_ten_times(name: str) -> None:
    trial = draw_rig_trial(name, np.random.default_rng(6))
    assert trial.rig.stage in ALL_LAWS[name].stages
    assert 0.6 * MIN_DEGREE < trial.degree < 1.5 * MAX_DEGREE


@pytest.mark.slow
@pytest.mark.parametrize('name', {law.port: name for name, law in ALL_LAWS.items()}.values())
def test_the_degree_holds_at_the_finer_steps_of_the_recording(name: str) -> None:
    trial = draw_rig_trial(name, np.random.default_rng(6))
    rig = trial.rig
    rate = integration_rate(rig)
    run = simulate_rig(rig, trial.make_law(), rate, np.random.default_rng(1))
    without = simulate_rig(rig, None, rate, np.random.default_rng(1))
    again = degree(ALL_LAWS[name].port, rig, run, without)
    assert again == pytest.approx(trial.degree, rel=0.3)


# -- plan and files ---------------------------------------------------------------------------


def test_every_ninth_rig_is_clean_and_laws_come_evenly() -> None:
    rigs, others = 9 * len(FOREIGN_LAWS) // 8, len(UNKNOWN_LAWS)
    trials = plan_study(0, 0, 5, unknown=others, foreign=rigs)
    unknown, foreign = trials[:others], trials[others:]
    assert [t.effect for t in foreign].count('') == rigs // 9
    assert sorted(t.effect for t in foreign if t.effect) == sorted(FOREIGN_LAWS)
    assert sorted(t.effect for t in unknown) == sorted(UNKNOWN_LAWS)
    assert all(t.on_rig for t in trials)
    assert plan_study(0, 0, 5, unknown=3, foreign=9)[3:] == foreign[:9]


def written(folder: Path, law: str, stage: str) -> tuple[TrialFiles, dict[str, Any]]:
    """Write a trial on a rig of a given stage."""
    rng = np.random.default_rng(8)
    trial = draw_rig_trial('', rng)
    while trial.rig.stage != stage:
        trial = draw_rig_trial('', rng)
    values = ALL_LAWS[law].draw(magnitudes_of(trial.rig, run_of(trial.rig)), rng)(0.3)
    files = TrialFiles.of(folder, 'trial_x')
    write_rig_trial(replace(trial, law=law, values=values, degree=3.0), files, rng)
    return files, json.loads(files.truth.read_text())


@pytest.mark.slow
def test_an_attached_specimen_is_recorded_without_reference(tmp_path: Path) -> None:
    files, truth = written(tmp_path, 'prony_relaxation', 'slow')
    signals = signals_of(read_signals(RecordingReader(files.recording), RecordingSource()))
    assert not len(signals.reference_t)
    assert 1.0 / np.median(np.diff(signals.wrench_t)) == pytest.approx(
        truth['sensing']['rate'], rel=0.01)
    model = read_parameter_file(str(files.nominal), 'plant_node')
    assert model['environment.unilateral'] is False
    assert not any(name.startswith('robot') for name in model)


@pytest.mark.slow
def test_the_truth_holds_law_families_and_nuisances(tmp_path: Path) -> None:
    _, truth = written(tmp_path / 'known', 'lugre_friction', 'press')
    assert (truth['law'], truth['families'], truth['unknown']) == (
        'lugre_friction', ['friction', 'hysteresis'], None)
    assert set(truth['nuisances']) >= {'bias', 'cable', 'hum', 'cubic', 'robot_friction'}
    _, truth = written(tmp_path / 'unknown', 'soft_spell', 'specimen')
    assert (truth['families'], truth['verdict']) == ([], 'unexplained')
    first, last = truth['parameters']['first'], truth['parameters']['last']
    assert all(first - 0.1 < a < b < last + 0.1 for a, b in truth['unknown']['intervals_s'])


@pytest.mark.slow
def test_only_write_leaves_recordings_and_truths(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ['--count', '0', '--foreign', '1', '--unknown', '1', '--seed', '5', '--only-write',
             '--output', str(tmp_path)]
    assert main(words) == 0
    assert 'wrote 2 trials' in capsys.readouterr().out
    recordings = sorted(path.stem for path in (tmp_path / 'handed_over').glob('*.mcap'))
    truths = sorted(path.name for path in (tmp_path / 'sealed').glob('*.truth.json'))
    assert truths == [f'{name}.truth.json' for name in recordings]
    assert not (tmp_path / 'reports').exists()
    first = (tmp_path / 'sealed' / truths[0]).read_text()
    assert main([*words[:-1], str(tmp_path / 'again')]) == 0
    assert (tmp_path / 'again' / 'sealed' / truths[0]).read_text() == first


@pytest.mark.slow
def test_a_bias_that_pushes_the_robot_is_not_taken_for_a_wrong_impedance(tmp_path: Path) -> None:
    rng = np.random.default_rng((1001, 3, 17))  # a rig without a law
    files = TrialFiles.of(tmp_path, 'trial_x')
    write_rig_trial(draw_rig_trial('', rng), files, rng)
    found = ce.diagnose(ce.read_recording(str(files.recording)), ce.read_model(str(files.nominal)))
    assert {effect.name for effect in found.effects} <= set(NEUTRAL)
