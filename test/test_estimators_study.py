# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The estimators study: its worlds are as declared, and its scores are right."""

from __future__ import annotations

from pathlib import Path
import re

from contact_estimation.benchmarks.estimators_study import main
from contact_estimation.benchmarks.study_scores import score
from contact_estimation.benchmarks.study_worlds import make_world, SCENARIOS, World
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


def test_an_exact_trace_scores_no_error_and_full_coverage(world: World) -> None:
    std = np.full(len(world.t), 1e-9)
    exact = score(world, (world.stiffness, world.damping, std, std))
    assert exact.stiffness_error == exact.damping_error == 0.0
    assert 0.0 <= exact.converged_s < 2e-3  # the first sample of the contact
    assert exact.stiffness_held.all() and exact.damping_held.all()
    assert exact.given == (1.0, 1.0) and max(exact.widths) < 1e-8


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
