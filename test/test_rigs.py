# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Rigs of blind_trials: integration, nuisances, degree by which a law stands out, files."""

from __future__ import annotations

from pathlib import Path

from blind_worlds import EXPERIMENT, ROBOT, WALL, WORLD
from contact_estimation.blind_trials.nuisances import Nuisances
from contact_estimation.blind_trials.rig import Rig, simulate_rig
from contact_estimation.blind_trials.simulation import Run, simulate
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
