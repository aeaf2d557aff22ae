# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The files in config/ hold exactly the parameters that the nodes declare."""

from __future__ import annotations

from pathlib import Path
import re

from contact_estimation.commands.write_config import config_files, main
from contact_estimation.parameters.file import read_parameter_file
from contact_estimation.parameters.specification import ParameterGroup, specifications
from contact_estimation.parameters.values import build, flatten, without
from contact_estimation.pipeline.parameters import EstimationParameters
from contact_estimation.plant.plant_parameters import PlantNodeParameters, PlantParameters
from contact_estimation.ros.estimator_node_parameters import EstimatorNodeParameters
import pytest
import yaml

CONFIG = Path(__file__).resolve().parent.parent / 'config'
NODES: list[tuple[str, tuple[type[ParameterGroup], ...]]] = [
    ('estimator_node', (EstimationParameters, EstimatorNodeParameters)),
    ('plant_node', (PlantParameters, PlantNodeParameters)),
]


@pytest.mark.parametrize('node, groups', NODES)
def test_file_holds_every_parameter_and_no_other(
    node: str, groups: tuple[type[ParameterGroup], ...]
) -> None:
    declared = {spec.name for group in groups for spec in specifications(group)}
    assert set(read_parameter_file(CONFIG / f'{node}.yaml', node)) == declared


@pytest.mark.parametrize('name', config_files())
def test_file_is_up_to_date(name: str) -> None:
    assert (CONFIG / name).read_text() == config_files()[name], (
        f'config/{name} is stale; run `python -m contact_estimation.commands.write_config` in the '
        'root of the repository to update')


def test_command_writes_the_files(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(['--output', str(tmp_path / 'new')]) == 0
    assert {f.name: f.read_text() for f in (tmp_path / 'new').iterdir()} == config_files()
    assert capsys.readouterr().out.count('wrote ') == len(config_files())


def test_every_value_has_a_comment_with_meaning_unit_and_range() -> None:
    text = config_files()['estimator_node.yaml']
    assert (
        '    # Nominal rate of the wrench, for which filters and relations are designed [Hz]; '
        '1 to 100000\n    sample_rate: 500.0\n') in text
    for file in config_files().values():
        lines = file.splitlines()
        for before, line in zip(lines, lines[1:]):
            if re.match(r' +\w+: .', line):
                assert before.lstrip().startswith('#'), line


def test_estimator_file_holds_the_defaults() -> None:
    values = read_parameter_file(CONFIG / 'estimator_node.yaml', 'estimator_node')
    given = build(EstimationParameters, without(EstimatorNodeParameters, values))
    assert repr(flatten(given)) == repr(flatten(EstimationParameters()))


def test_plant_file_is_the_paper_s_world() -> None:
    values = read_parameter_file(CONFIG / 'plant_node.yaml', 'plant_node')
    plant = build(PlantParameters, without(PlantNodeParameters, values))
    noise = {'force_noise': 1.0, 'distribution': 'uniform'}
    expected = build(PlantParameters, {f'sensors.{k}': v for k, v in noise.items()})
    assert repr(plant) == repr(expected)


def test_parameter_file_of_rclpy_reads_the_same_numbers() -> None:
    # rcl reads 1.0e-06 as a number but 1e-06 as text, so a dot must stand in every exponent.
    text = (CONFIG / 'estimator_node.yaml').read_text()
    content = yaml.safe_load(text)['/**']['ros__parameters']
    assert isinstance(content['contact']['position_noise'], float)
