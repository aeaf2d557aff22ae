# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""A nominal model with physics: these are recalibrated, and names are what lacks beyond."""

from functools import lru_cache
from pathlib import Path
from typing import Any

from concealed_worlds import diagnosed, named, physics, recorded
from contact_estimation.diagnosis.fit.free_run import plant_of
from contact_estimation.diagnosis.report.json_report import model_file
from contact_estimation.diagnosis.report.text_report import as_text
from contact_estimation.diagnosis.result import Diagnosis
from contact_estimation.plant.plant_parameters import PlantParameters, read_model
import pytest

pytestmark = pytest.mark.slow

F_C = 3.0
RUBBING = physics('coulomb_friction', F_C)


@lru_cache(maxsize=None)
def corrected() -> Diagnosis:
    """Diagnose friction, from the plain model."""
    return diagnosed(recorded(**RUBBING))


def again(seed: int, **changes: Any) -> Diagnosis:
    """Diagnose another recording of a world with friction, from the corrected model."""
    signals = recorded(seed=seed, **{**RUBBING, **changes})
    return diagnosed(signals, plant_of(corrected().corrected))


def test_corrected_model_is_read_from_its_file(tmp_path: Path) -> None:
    path = tmp_path / 'model.yaml'
    path.write_text(model_file(corrected()))
    model: PlantParameters = read_model(str(path))
    assert model.physics.coulomb_friction.F_c == pytest.approx(F_C, rel=0.03)
    assert model.environment.stiffness == pytest.approx(
        plant_of(corrected().corrected).environment.stiffness)


def test_physics_of_the_nominal_model_are_recalibrated() -> None:
    found = again(5, **physics('coulomb_friction', 1.5 * F_C))
    assert (found.verdict, named(found)) == ('recalibrate', [])
    assert found.recalibrated.effect('coulomb_friction').values()['F_c'] == pytest.approx(
        1.5 * F_C, rel=0.03)
    assert 'F_c' in as_text(found)


def test_what_lacks_beyond_is_named_alone() -> None:
    found = again(6, **physics('quadratic_damping', 600.0))
    assert (found.verdict, named(found)) == ('physics_missing', ['quadratic_damping'])
    value, = found.effects[0].parameters.values()
    assert value.value == pytest.approx(600.0, rel=0.1)
    friction = found.corrected.effect('coulomb_friction')
    assert friction.values()['F_c'] == pytest.approx(F_C, rel=0.1)
