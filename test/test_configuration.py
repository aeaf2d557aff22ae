# Copyright 2026 contact_estimation authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""The files in config/ hold exactly the parameters that the nodes declare."""

from __future__ import annotations

from pathlib import Path

from contact_estimation.estimation.parameters import EstimationParameters
from contact_estimation.parameters.file import read_parameter_file
from contact_estimation.parameters.specification import ParameterGroup, specifications
from contact_estimation.parameters.values import build, flatten, without
from contact_estimation.plant.plant_parameters import PlantParameters
from contact_estimation.ros.estimator_node_parameters import EstimatorNodeParameters
from contact_estimation.ros.plant_node_parameters import PlantNodeParameters
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


@pytest.mark.parametrize('node, groups', NODES)
def test_every_line_of_the_file_has_a_comment(
    node: str, groups: tuple[type[ParameterGroup], ...]
) -> None:
    lines = (CONFIG / f'{node}.yaml').read_text().splitlines()
    for before, line in zip(lines, lines[1:]):
        value = line.partition(':')[2].strip()
        assert not value or line.lstrip().startswith('#') or before.lstrip().startswith('#'), line


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
    content = yaml.safe_load(text)['estimator_node']['ros__parameters']
    assert isinstance(content['contact']['position_noise'], float)
