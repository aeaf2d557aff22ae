# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The report as JSON, as text and as model file: keys, nulls and numbers."""

from __future__ import annotations

from dataclasses import replace
import json
from math import inf, nan
from pathlib import Path
from typing import Any

from contact_estimation.diagnosis.compare.shares import Share
from contact_estimation.diagnosis.conclude.location import Location
from contact_estimation.diagnosis.conclude.result import Errors, Remainder, Value
from contact_estimation.diagnosis.report.corrected_model import model_file
from contact_estimation.diagnosis.report.json_report import as_dict
from contact_estimation.diagnosis.report.page import as_html
from contact_estimation.diagnosis.report.text_report import as_text
from contact_estimation.diagnosis.report.wording import headline
from contact_estimation.parameters.file import read_parameter_file
from contact_estimation.parameters.values import build
from contact_estimation.pipeline.parameters import EstimationParameters
from contact_estimation.plant.plant_parameters import PlantParameters
from diagnosed_worlds import diagnosed
import numpy as np
import pytest

VERDICTS = {'clean': 'consistent', 'stiffer': 'recalibrate', 'friction': 'physics_missing',
            'unknown': 'unexplained'}
MODELS = {'nominal', 'recalibrated', 'corrected'}
PLACE = {'intervals_s', 'phase', 'region', 'band_hz', 'port'}
EVERY = pytest.mark.parametrize('name', VERDICTS)


@pytest.mark.slow
@EVERY
def test_worlds_get_their_verdicts(name: str) -> None:
    assert diagnosed(name).verdict == VERDICTS[name]


@EVERY
def test_report_has_the_keys_of_its_schema(name: str) -> None:
    report = as_dict(diagnosed(name))
    assert {'verdict', 'effects', 'location', 'nominal', 'recalibrated', 'corrected', 'fit',
            'next_experiment'} <= set(report)
    assert set(report['nominal']) == set(report['recalibrated']) == {'stiffness', 'damping'}
    assert set(report['corrected']) == {'stiffness', 'damping'}
    assert {'noise_floor_n', 'force_rmse_n', 'motion_rmse_m', 'improvement_interval',
            'holdouts'} <= set(report['fit'])
    assert set(report['fit']['force_rmse_n']) == set(report['fit']['motion_rmse_m']) == MODELS
    for part in report['fit']['holdouts']:
        assert set(part) == {'name', 'force_rmse_n', 'motion_rmse_m'}
        assert set(part['force_rmse_n']) == set(part['motion_rmse_m']) == MODELS
    assert set(report['next_experiment']) == {'text', 'file'}


@pytest.mark.parametrize('name', ['clean', 'stiffer'])
def test_corrected_is_recalibrated_where_nothing_is_missing(name: str) -> None:
    d = diagnosed(name)
    assert d.corrected.values == d.recalibrated.values
    assert d.force.corrected == d.force.recalibrated


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


def test_values_that_do_not_exist_are_null() -> None:
    nothing = Errors(None, None, None)
    part = replace(diagnosed('clean').holdouts[0], motion=nothing)
    fit = as_dict(replace(
        diagnosed('clean'), motion=nothing, improvement=None, holdouts=[part]))['fit']
    assert fit['motion_rmse_m'] is None and fit['improvement_interval'] is None
    assert fit['holdouts'][0]['motion_rmse_m'] is None


def test_improvement_is_that_of_corrected_over_recalibrated() -> None:
    fit = as_dict(diagnosed('friction'))['fit']
    low, high = fit['improvement_interval']
    errors = fit['force_rmse_n']
    assert low < 1.0 - errors['corrected'] / errors['recalibrated'] < high


def test_text_lists_significant_dependences_of_the_residuals_before_and_after() -> None:
    d = diagnosed('friction')
    lines = as_text(d).splitlines()
    (before,) = (line for line in lines if line.startswith('  recalibrated model:'))
    shares = [one['share'] for found in as_dict(d)['dependence'].values() for one in found
              if (one['port'], one['on']) == ('force', 'velocity')]
    assert f'velocity {100.0 * shares[0]:.0f} %' in before
    assert shares[1] < 0.2 * shares[0]


@EVERY
def test_text_begins_with_the_verdict_and_gives_effects_and_errors(name: str) -> None:
    d = diagnosed(name)
    text = as_text(d)
    assert text.startswith(f'{d.verdict.replace("_", " ")}: the simulation ')
    assert all(f'{effect.name} (in the contact)' in text for effect in d.effects)
    assert f'{d.force.nominal:.4g}' in text
    assert f'{d.stiffness.value:.6g} +- {d.stiffness.std:.2g}' in text


def test_text_gives_family_share_and_parameters_on_the_parts() -> None:
    d = diagnosed('friction')
    (effect,) = d.effects
    low, high = (100.0 * value for value in effect.share_interval)
    found = [part.parameters['F_c'] for part in effect.parts]
    text = as_text(d)
    assert 'coulomb_friction (in the contact), family friction, probability ' in text
    assert (f'  explains {100.0 * effect.share:.0f} % ({low:.0f} to {high:.0f} %) of the misfit '
            'in cross-validation\n') in text
    assert (f'  fitted on each of {len(found)} parts alone: '
            f'F_c = {min(found):.3g} to {max(found):.3g} N\n') in text


@pytest.mark.parametrize(('count', 'subject'), [
    (1, 'The named effect leaves'), (2, 'The named effects together leave'),
])
def test_text_says_how_much_the_names_leave_and_where(count: int, subject: str) -> None:
    d = diagnosed('friction')
    place = Location('robot', [(1.0, 2.0)], 'hold', 'small |v|', (5.0, 40.0))
    left = replace(d, effects=d.effects * count, remainder=Remainder(0.123, place, ''))
    assert (f'\n{subject} 12 % of the misfit: in the robot, during the hold (1.0-2.0 s), '
            'strongest at small |v|, 5 to 40 Hz.\n') in as_text(left)
    assert (f'\n{subject} less than 1 % of the misfit above the noise.\n'
            in as_text(replace(left, remainder=None)))


@pytest.mark.parametrize('verdict, error, told', [
    ('recalibrate', 2.0, True), ('recalibrate', 1.2, False), ('unexplained', 2.0, False),
    ('consistent', 2.0, True), ('consistent', 1.2, False)])
def test_a_trifle_beyond_the_noise_is_told_where_nothing_is_named(
    verdict: str, error: float, told: bool
) -> None:
    d = diagnosed('friction')
    models = {'nominal': 0.1 * error, 'recalibrated': 0.1 * error}
    unnamed = replace(d, verdict=verdict, effects=[], noise_floor=0.1,
                      force=replace(d.force, **models))
    low, high = np.percentile(d.recordings[0].observed.force, (1.0, 99.0))
    percent = f'{17.32 / (high - low):.2g}'
    text = (f'Held-out residual 0.17 N rms beyond the noise, {percent} % of the range of the '
            'force: below the reporting threshold.')
    assert (text in as_text(unnamed)) is told
    if (verdict, told) == ('recalibrate', True):
        assert text in as_html(unnamed, 'a.mcap')
    assert ('to within the sensor noise' in as_text(unnamed)) is (
        verdict == 'consistent' and not told)


def test_headline_lists_the_values_that_recalibration_changes() -> None:
    d = diagnosed('friction')
    model = d.nominal
    to = replace(d, verdict='recalibrate', effects=[],
                 recalibrated=model.at((2.0 * model.stiffness, *model.values[1:])))
    assert headline(to) == (
        'The simulation has the right physics with wrong values: K_e is '
        f'{2.0 * model.stiffness:.5g} N/m instead of {model.stiffness:.5g} N/m')


def test_what_the_position_does_not_resolve_is_no_trifle() -> None:
    d = diagnosed('friction')
    low, high = np.percentile(d.recordings[0].observed.force, (1.0, 99.0))
    unnamed = replace(d, verdict='recalibrate', effects=[], noise_floor=1e-6 * (high - low),
                      force=replace(d.force, recalibrated=0.1 * (high - low)))
    assert ('10 % of the range of the force: this recording does not tell which law it obeys.'
            in as_text(unnamed))


def test_text_omits_the_interval_of_a_share_of_one_part() -> None:
    d = diagnosed('friction')
    alone = replace(d.effects[0], parts=d.effects[0].parts[:1], share=0.5,
                    share_interval=(-inf, inf))
    text = as_text(replace(d, effects=[alone]))
    assert '  explains 50 % of the misfit' in text
    assert 'parts alone' not in text


def test_small_shares_have_a_decimal() -> None:
    d = diagnosed('friction')
    small = replace(d.effects[0], share=0.012, share_interval=(0.004, 0.02))
    assert '  explains 1.2 % (0.4 to 2.0 %) of the misfit' in as_text(replace(d, effects=[small]))


def test_a_law_beside_zeros_has_its_share_of_what_they_leave() -> None:
    d = diagnosed('friction')
    beside = Share(0.64, (0.55, 0.73), np.array([0.6, 0.7]))
    small = replace(d.effects[0], share=4e-5, share_interval=(3e-5, 5e-5), beside_zeros=beside)
    text = as_text(replace(d, effects=[small]))
    assert ('  explains below 0.1 % of the misfit in cross-validation, 64 % (55 to 73 %) of what '
            'the offsets leave\n') in text
    assert as_dict(replace(d, effects=[small]))['effects'][0]['share_beside_zeros'] == 0.64


def test_unexplained_mismatch_beside_names_is_most_of_it() -> None:
    d = replace(diagnosed('friction'), verdict='unexplained')
    text = as_text(d)
    assert text.startswith(
        'unexplained: the simulation lacks coulomb friction in the contact; most of the mismatch '
        'is physics that no effect of the library explains.\n')
    assert 'Mismatch of the recalibrated model: in the contact' in text
    assert 'Unexplained mismatch' not in text


def test_text_follows_the_order_of_the_page() -> None:
    text = as_text(replace(diagnosed('unknown'), next_experiment='press harder'))
    titles = ('unexplained: ', 'Model parameters', 'Held-out errors', 'Unexplained mismatch',
              'Next experiment: press harder')
    places = [text.index(title) for title in titles]
    assert places == sorted(places)


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
