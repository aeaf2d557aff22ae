# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The demonstration, but for its two loops over ROS: what it conceals and what it refuses."""

from __future__ import annotations

from pathlib import Path

from contact_estimation.commands.demonstrate import CONCEALED, main, WORLD
from contact_estimation.parameters import build
from contact_estimation.physics import effects_that_are_on
from contact_estimation.plant.plant_parameters import PlantParameters
import pytest


@pytest.mark.parametrize('concealed', CONCEALED)
def test_each_concealed_world_has_one_effect(concealed: dict[str, float]) -> None:
    plant = build(PlantParameters, {**WORLD, **concealed})
    assert len(effects_that_are_on(plant.physics)) == 1


def test_folder_that_is_not_empty_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / 'kept').write_text('')
    assert main(['--output', str(tmp_path)]) == 1
    assert 'not empty' in capsys.readouterr().err
