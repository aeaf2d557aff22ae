# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The files in config/ hold exactly the parameters that the nodes declare."""

from __future__ import annotations

from pathlib import Path
import re

from contact_estimation.commands.write_config import config_files
from contact_estimation.parameter_files import read_parameter_file
from contact_estimation.parameters import build, without
from contact_estimation.plant.plant_parameters import PlantNodeParameters, PlantParameters
import pytest

CONFIG = Path(__file__).resolve().parent.parent / 'config'


@pytest.mark.parametrize('name', config_files())
def test_file_is_up_to_date(name: str) -> None:
    assert (CONFIG / name).read_text() == config_files()[name], (
        f'config/{name} is stale; run `python -m contact_estimation.commands.write_config` in the '
        'root of the repository to update')


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


def test_plant_file_is_the_paper_s_world() -> None:
    values = read_parameter_file(CONFIG / 'plant_node.yaml', 'plant_node')
    plant = build(PlantParameters, without(PlantNodeParameters, values))
    noise = {'force_noise': 1.0, 'distribution': 'uniform'}
    expected = build(PlantParameters, {f'sensors.{k}': v for k, v in noise.items()})
    assert repr(plant) == repr(expected)
