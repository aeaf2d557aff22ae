# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""A simulator's recording as the nominal model: what it has is known, what it lacks is named."""

from __future__ import annotations

import json
from pathlib import Path

from contact_estimation.commands import diagnose, simulate
from contact_estimation.diagnosis.diagnose import estimated_model
from contact_estimation.diagnosis.observe.signals import read_recording
import pytest
from run_commands import Command
import yaml

WORLDS = {'plain': {}, 'simulator': {'cubic_stiffness': {'K_3': 2e6}},
          'real': {'cubic_stiffness': {'K_3': 2e6}, 'coulomb_friction': {'F_c': 6.0}}}


@pytest.fixture(scope='module')
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Hold recordings of a simulator with law A, and of the real thing with A and B."""
    folder = tmp_path_factory.mktemp('simulation')
    for seed, (name, physics) in enumerate(WORLDS.items()):
        values = {'environment': {'stiffness': 4300.0, 'damping': 260.0, 'location': 0.003},
                  'robot': {'mass': 30.0, 'damping': 700.0, 'stiffness': 4000.0},
                  'sensors': {'force_noise': 0.05, 'position_noise': 1e-6}, 'physics': physics}
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
