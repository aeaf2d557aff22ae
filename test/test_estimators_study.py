# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The estimators study: its worlds are as declared, and its scores are right."""

from __future__ import annotations

from math import inf
from pathlib import Path
import re

from contact_estimation.studies.benchmarks.estimators_study import main
from contact_estimation.studies.benchmarks.study_report import candidates, score, scores
from contact_estimation.studies.benchmarks.study_worlds import make_world, SCENARIOS, World
import numpy as np
import pytest


@pytest.fixture(scope='module')
def world() -> World:
    """Return a world with a wall that is new in the second contact."""
    return make_world(SCENARIOS['300 to 30000 N/m'], 0, 2, seed=1)


def test_a_world_is_the_same_for_the_same_seed(world: World) -> None:
    again = make_world(SCENARIOS['300 to 30000 N/m'], 0, 2, seed=1)
    other = make_world(SCENARIOS['300 to 30000 N/m'], 0, 2, seed=2)
    assert again.samples[700:710] == world.samples[700:710] != other.samples[700:710]


def test_the_sensors_of_a_world_are_those_of_a_real_robot(world: World) -> None:
    spacing = np.diff(world.t)
    free = np.array([sample.force for sample in world.samples])[world.t < world.contacts[0][0]]
    assert np.std(spacing[spacing < 3e-3]) == pytest.approx(np.sqrt(2.0) * 1e-4, rel=0.1)
    assert 0 < np.sum(spacing > 3e-3) < 0.01 * len(spacing)
    assert np.std(free) == pytest.approx(world.sensor.noise, rel=0.1)


def test_the_force_lags_by_the_filter_of_the_sensor(world: World) -> None:
    begin, end = world.contacts[1]
    inside = (world.t > begin + 0.7) & (world.t < end - 0.7)
    force = -np.array([sample.force for sample in world.samples])[inside]
    delta = np.array([sample.position for sample in world.samples])[inside]
    rate = np.gradient(delta, world.t[inside])
    K, B = np.linalg.lstsq(np.column_stack([delta, rate]), force, rcond=None)[0]
    lag = np.sqrt(world.sensor.poles) / (2.0 * np.pi * world.sensor.cutoff)
    assert K == pytest.approx(3e4, rel=0.01)
    assert B == pytest.approx(world.damping[-1] - 3e4 * lag, abs=0.2 * 3e4 * lag)


def test_an_exact_trace_scores_no_error_and_full_coverage(world: World) -> None:
    std = np.full(len(world.t), 1e-9)
    exact = score(world, (world.stiffness, world.damping, std, std))
    assert exact.stiffness_error == exact.damping_error == 0.0
    assert 0.0 <= exact.converged_s < 2e-3  # the first sample of the contact
    assert exact.stiffness_held.all() and exact.damping_held.all()
    assert exact.given == (1.0, 1.0) and max(exact.widths) < 1e-8


def test_a_trace_that_keeps_the_old_wall_never_converges(world: World) -> None:
    old, unknown = np.full(len(world.t), 300.0), np.full(len(world.t), np.nan)
    kept = score(world, (old, world.damping, unknown, unknown))
    assert kept.converged_s == inf
    assert kept.stiffness_error == pytest.approx(-0.99)
    assert kept.given == (0.0, 0.0) and len(kept.stiffness_held) == 0


@pytest.mark.slow
def test_the_peers_estimate_a_wall_that_stays() -> None:
    pytest.importorskip('padasip')
    worlds = [make_world(SCENARIOS['excited'], 0, 1, seed=3)]
    for name in ('filterpy Kalman, bare', 'padasip RLS, bare'):
        (found,) = scores(candidates()[name], worlds)
        assert abs(found.stiffness_error) < 0.02


@pytest.mark.slow
def test_the_study_writes_tables_and_three_pictures(tmp_path: Path) -> None:
    pytest.importorskip('matplotlib')
    arguments = ['--quick', '--only', 'rls', '--output', str(tmp_path)]
    assert main([*arguments, '--scenario', 'unexcited', 'step x 2']) == 0
    text = (tmp_path / 'estimators_study.md').read_text()
    assert text.count('| rls |') == 4
    pictures = sorted(path.name for path in tmp_path.glob('*.png'))
    assert pictures == ['study_convergence.png', 'study_coverage.png', 'study_errors.png']


@pytest.mark.parametrize(('arguments', 'message'), [
    (['--only', 'rsl'], "--only must name candidates .*rls.*, got 'rsl'"),
    (['--seed', '-1'], '--seed must be >= 0, got -1'),
])
def test_bad_options_are_refused(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(arguments) == 1
    assert re.search(message, capsys.readouterr().err)
