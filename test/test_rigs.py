# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Rigs of blind_trials: integration, nuisances, degree by which a law stands out, files."""

from __future__ import annotations

from dataclasses import replace
import json
from pathlib import Path
from typing import Any

from blind_worlds import EXPERIMENT, ROBOT, WALL, WORLD
from contact_estimation.blind_trials.nuisances import Nuisances
from contact_estimation.blind_trials.rig import Rig, simulate_rig
from contact_estimation.blind_trials.rig_trial import draw_rig_trial, magnitudes_of
from contact_estimation.blind_trials.simulation import Run, simulate
from contact_estimation.blind_trials.trial_files import TrialFiles, write_rig_trial
from contact_estimation.blind_trials.worlds import SensorModel
from contact_estimation.commands.blind_trials import main
from contact_estimation.foreign_laws import ALL_LAWS
import numpy as np
import pytest

NONE = Nuisances(0.0, 0.0, 0.0, 50.0, 0.0, 1.0, 0.0, 0.0)
RIG = Rig('press', WALL, ROBOT, SensorModel(), EXPERIMENT, NONE, 0.015)


def run_of(rig: Rig, name: str = '', rate: float = 2000.0, **values: float) -> Run:
    """Simulate a rig under a law."""
    law = ALL_LAWS[name](values) if name else None
    return simulate_rig(rig, law, rate, np.random.default_rng(0))


# -- integration ------------------------------------------------------------------------------


def test_a_rig_without_nuisances_and_law_moves_as_the_plant() -> None:
    rig, plant = run_of(RIG), simulate(WORLD, {}, 500.0, 2000.0)
    assert np.max(np.abs(rig.x[::4] - plant.x)) < 2e-6
    assert np.sqrt(np.mean((rig.force[::4] - plant.force) ** 2)) < 0.02


# -- nuisances --------------------------------------------------------------------------------


# -- degree -----------------------------------------------------------------------------------


# -- plan and files ---------------------------------------------------------------------------


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
