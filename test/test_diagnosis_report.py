# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The report as JSON, as text and as model file: keys, nulls and numbers."""

from __future__ import annotations

from dataclasses import replace
import json
from math import nan
from pathlib import Path
from typing import Any

from contact_estimation.diagnosis.report.json_report import as_dict, model_file
from contact_estimation.diagnosis.report.text_report import as_text
from contact_estimation.diagnosis.result import Value
from contact_estimation.parameter_files import read_parameter_file
from contact_estimation.parameters import build
from contact_estimation.pipeline.parameters import EstimationParameters
from contact_estimation.plant.plant_parameters import PlantParameters
from diagnosed_worlds import diagnosed
import pytest

pytestmark = pytest.mark.slow

VERDICTS = {'clean': 'consistent', 'stiffer': 'recalibrate', 'friction': 'physics_missing',
            'unknown': 'unexplained'}
MODELS = {'nominal', 'recalibrated', 'corrected'}
PLACE = {'intervals_s', 'phase', 'region', 'band_hz', 'port'}
EVERY = pytest.mark.parametrize('name', VERDICTS)


@EVERY
def test_worlds_get_their_verdicts(name: str) -> None:
    assert diagnosed(name).verdict == VERDICTS[name]


@EVERY
def test_report_has_the_keys_of_its_schema(name: str) -> None:
    report = as_dict(diagnosed(name))
    assert {'verdict', 'effects', 'location', 'remainder', 'checks', 'nominal', 'recalibrated',
            'corrected', 'fit', 'next_experiment'} <= set(report)
    assert set(report['nominal']) == set(report['recalibrated']) == {'stiffness', 'damping'}
    assert set(report['corrected']) == {'stiffness', 'damping'}
    assert {'noise_floor_n', 'force_rmse_n', 'motion_rmse_m', 'improvement_interval',
            'holdouts'} <= set(report['fit'])
    assert set(report['fit']['force_rmse_n']) == set(report['fit']['motion_rmse_m']) == MODELS
    for part in report['fit']['holdouts']:
        assert set(part) == {'name', 'force_rmse_n', 'motion_rmse_m'}
        assert set(part['force_rmse_n']) == set(part['motion_rmse_m']) == MODELS
    assert set(report['next_experiment']) == {'text', 'file'}


def test_effects_have_the_keys_of_their_schema() -> None:
    (effect,) = as_dict(diagnosed('friction'))['effects']
    assert set(effect) == {'name', 'family', 'port', 'probability', 'equation', 'share',
                           'share_interval', 'share_beside_zeros', 'parts', 'parameters',
                           'indistinguishable_from', 'location'}
    assert effect['share_beside_zeros'] is None  # there are no zeros
    assert all(set(part) == {'name', 'share', 'parameters'} for part in effect['parts'])
    assert set(effect['parameters']) == {'F_c'}
    assert set(effect['parameters']['F_c']) == {'value', 'std', 'unit'}
    assert set(effect['location']) == PLACE
    assert effect['name'] == 'coulomb_friction' and effect['port'] == 'contact'
    assert effect['parameters']['F_c']['value'] == pytest.approx(2.0, rel=0.05)


@EVERY
def test_mismatch_is_located_only_where_there_is_one(name: str) -> None:
    location = as_dict(diagnosed(name))['location']
    if VERDICTS[name] in ('physics_missing', 'unexplained'):
        assert set(location) == PLACE
        assert location['port'] in ('contact', 'force_sensor', 'robot')
        assert all(0.0 <= a < b for a, b in location['intervals_s'])
    else:
        assert location is None


@EVERY
def test_report_is_json_without_nan(name: str) -> None:
    wild = replace(diagnosed(name), stiffness=Value(nan, nan, 'N/m'), residual_power=float('inf'))
    for diagnosis in (diagnosed(name), wild):
        report = as_dict(diagnosis)
        assert json.loads(json.dumps(report, allow_nan=False)) == report
    assert as_dict(wild)['corrected']['stiffness'] == {'value': None, 'std': None}


@pytest.mark.parametrize(('effect', 'values', 'stiffness', 'damping'), [
    ('power_law_stiffness', (1.2, 7000.0), None, 'fitted'),
    ('hunt_crossley_damping', (2e4,), 'fitted', 0.0),
])
def test_stiffness_or_damping_replaced_by_an_effect_is_null_or_zero(
    effect: str, values: tuple[float, ...], stiffness: Any, damping: Any
) -> None:
    before = diagnosed('clean')
    report = as_dict(replace(before, corrected=before.nominal.with_effect(effect, values)))
    fitted = {'stiffness': before.stiffness.value, 'damping': before.damping.value}
    for name, expected in (('stiffness', stiffness), ('damping', damping)):
        value = fitted[name] if expected == 'fitted' else expected
        assert report['corrected'][name]['value'] == value


@EVERY
def test_text_begins_with_the_verdict_and_gives_effects_and_errors(name: str) -> None:
    d = diagnosed(name)
    text = as_text(d)
    assert text.startswith(f'{d.verdict.replace("_", " ")}: the simulation ')
    assert all(f'{effect.name} (in the contact)' in text for effect in d.effects)
    assert f'{d.force.nominal:.4g}' in text
    assert f'{d.stiffness.value:.6g} +- {d.stiffness.std:.2g}' in text


def test_model_file_configures_plant_and_estimator(tmp_path: Path) -> None:
    d = diagnosed('friction')
    path = tmp_path / 'model.yaml'
    path.write_text(model_file(d))
    plant = build(PlantParameters, read_parameter_file(path, 'plant_node'))
    assert plant.environment.stiffness == pytest.approx(d.stiffness.value, rel=1e-9)
    assert plant.robot == d.nominal.nominal.robot
    F_c = d.effects[0].parameters['F_c'].value
    assert plant.physics.coulomb_friction.F_c == pytest.approx(F_c, rel=1e-9)
    estimator = build(EstimationParameters, read_parameter_file(path, 'estimator_node'))
    assert estimator.physics.coulomb_friction.F_c == plant.physics.coulomb_friction.F_c
