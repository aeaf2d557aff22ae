# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The report of a diagnosis: JSON, text, figures and page."""

from dataclasses import replace
from html.parser import HTMLParser
import json
from math import nan
from pathlib import Path
import re
import sys
from typing import Any

from contact_estimation.diagnosis.checks.check import Check
from contact_estimation.diagnosis.observe.model import Model
from contact_estimation.diagnosis.report import page as page_module
from contact_estimation.diagnosis.report.figures import COLOURS, plot_comparison, plot_evidence
from contact_estimation.diagnosis.report.json_report import as_dict, model_file
from contact_estimation.diagnosis.report.page import as_html, with_std
from contact_estimation.diagnosis.report.plot_data import plot_data
from contact_estimation.diagnosis.report.text_report import as_text
from contact_estimation.diagnosis.report.wording import headline, meaning
from contact_estimation.diagnosis.result import refuse, Value
from contact_estimation.exceptions import MissingPackageError
from contact_estimation.parameter_files import read_parameter_file
from contact_estimation.parameters import build
from contact_estimation.pipeline.parameters import EstimationParameters
from contact_estimation.plant.plant_parameters import PlantParameters
from diagnosed_worlds import diagnosed, nominal
import numpy as np
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
    ('hunt_crossley_damping', (2e4,), 'fitted', 0.0)])
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


@pytest.mark.parametrize('low, little', [(0.2, False), (-0.05, True)])
def test_text_says_if_the_held_out_force_tells_little_of_the_names(
    low: float, little: bool
) -> None:
    text = as_text(replace(diagnosed('friction'), improvement=(low, 0.31)))
    assert f'{100.0 * low:.0f} to 31 % below' in text
    assert ('tells little of the names' in text) is little


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


NAMES = ('clean', 'stiffer', 'friction', 'unknown')
VOID = {'meta', 'img'}  # elements without an end tag


class Page(HTMLParser):
    """Collects tags and text, and checks that elements are nested."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.text = ''
        self.feed(page)
        self.close()

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        """Record a tag."""
        self.tags.append((tag, dict(attributes)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        """Close the element that was opened last."""
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        """Collect text."""
        if 'style' not in self.open:
            self.text += data


@pytest.fixture(scope='module', params=[
    name if name == 'friction' else pytest.param(name, marks=pytest.mark.slow) for name in NAMES])
def page(request: pytest.FixtureRequest) -> tuple[str, str]:
    """Build the page of each world once."""
    pytest.importorskip('matplotlib')
    return request.param, as_html(diagnosed(request.param), 'a.mcap')


@pytest.fixture
def blank_pictures(monkeypatch: pytest.MonkeyPatch) -> None:
    """Plot all figures, but render none: the test looks at the text."""
    pytest.importorskip('matplotlib')
    monkeypatch.setattr(page_module, 'as_data_uri', lambda figure: 'data:image/png;base64,')


def test_page_is_self_contained(page: tuple[str, str]) -> None:
    name, text = page
    assert len(text) < 1.5e6
    # The letters of base64 spell anything.
    words = re.sub(r'data:image/png;base64,[A-Za-z0-9+/=]*', '', text)
    assert len(words) < 1e5
    assert 'http' not in words and 'url(' not in words and '@import' not in words
    tags = Page(text).tags
    assert not {'script', 'link', 'iframe', 'object'} & {tag for tag, _ in tags}
    sources = [attributes['src'] for _, attributes in tags if 'src' in attributes]
    with_evidence = bool(diagnosed(name).evidence)
    assert len(sources) == 6 + with_evidence + len(diagnosed(name).effects)
    assert all((source or '').startswith('data:image/png;base64,iVBOR') for source in sources)


def test_page_is_well_formed_and_describes_its_figures(page: tuple[str, str]) -> None:
    parsed = Page(page[1])
    assert parsed.open == []
    figures = [attributes for tag, attributes in parsed.tags if tag == 'img']
    assert all(len(attributes['alt'] or '') > 20 for attributes in figures)


def test_page_gives_verdict_effects_and_held_out_errors(page: tuple[str, str]) -> None:
    name, text = page
    d, shown = diagnosed(name), Page(text).text
    assert d.verdict.replace('_', ' ') in shown and headline(d) in shown
    for effect in d.effects:
        assert effect.name.replace('_', ' ') in shown and effect.equation in shown
        assert meaning(effect.name) in shown
    assert f'{d.holdouts[0].force.nominal:.4g}' in shown
    assert f'{d.noise_floor:.3g} N' in shown


@pytest.mark.usefixtures('blank_pictures')
def test_failed_checks_stand_on_top_and_passed_ones_are_folded() -> None:
    failed = Check('quantisation', False, 'record more digits')
    checks = [Check('gaps', True, 'no pause'), failed, Check('axis', True, '', tested=False)]
    text = as_html(replace(diagnosed('friction'), checks=checks), 'a.mcap')
    assert text.index('record more digits') < text.index('<details>') < text.index('no pause')
    assert '<summary>Checks of the recording passed: 1, not tested: 1</summary>' in text
    assert text.index('no pause') < text.index('</details>') < text.index('<img')


@pytest.mark.usefixtures('blank_pictures')
def test_text_from_outside_is_escaped() -> None:
    hostile = '<script>"&'
    d = diagnosed('friction')
    effect = replace(d.effects[0], indistinguishable_from=['stribeck_friction'])
    d = replace(d, effects=[effect], holdouts=[replace(d.holdouts[0], name=hostile)],
                next_experiment=hostile)
    text = as_html(d, hostile, hostile)
    assert '<script' not in text
    shown = Page(text).text
    assert shown.count(hostile) >= 4
    assert 'cannot distinguish it from stribeck friction: ' in ' '.join(shown.split())


def test_refused_recording_has_a_page_without_figures() -> None:
    pytest.importorskip('matplotlib')
    failed = Check('force_sign', False, 'the force pulls while pressing', fatal=True)
    text = as_html(refuse([failed], Model.of(nominal())), 'a.mcap')
    shown = Page(text).text
    assert 'Fix the recording first: force sign' in shown
    assert failed.text in shown
    assert '<img' not in text and 'Model parameters' not in shown


def test_missing_matplotlib_is_an_error_with_remedy(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, 'matplotlib', None)
    with pytest.raises(MissingPackageError, match='matplotlib.*pip install'):
        as_html(diagnosed('clean'), 'a')


@pytest.mark.parametrize(('value', 'std', 'text'), [
    (3.86767, 0.00531, '3.8677 &plusmn; 0.0053'),
    (-7.2018e6, 1.61e4, '(-7.202 &plusmn; 0.016) &times; 10<sup>6</sup>'),
    (12444.19, 0.53, '12444.19 &plusmn; 0.53'),
    (9.31e-6, 2.2e-8, '(9.310 &plusmn; 0.022) &times; 10<sup>-6</sup>'),
    (250.0, 131.0, '250 &plusmn; 131'),
    (1.5, float('nan'), '1.5'),
    (float('nan'), 1.0, '&ndash;')])
def test_numbers_are_rounded_to_two_digits_of_their_uncertainty(
    value: float, std: float, text: str
) -> None:
    assert with_std(value, std) == text


def line(axis: Any, label: str) -> Any:
    """Return the line with a label."""
    (found,) = (line for line in axis.lines if line.get_label() == label)
    return found


def test_comparison_shows_recording_and_all_models() -> None:
    pytest.importorskip('matplotlib')
    data = plot_data(diagnosed('friction'))
    whole, close = plot_comparison(data, data.force).axes
    assert [one.get_label() for one in whole.lines] == [
        'recorded', 'nominal', 'recalibrated', 'corrected']
    assert whole.get_ylabel() == 'force [N]' and close.get_xlabel() == 'time [s]'
    np.testing.assert_array_equal(line(close, 'recorded').get_ydata(),
                                  data.force.recorded[data.close_up])
    assert line(whole, 'corrected').get_color() == COLOURS['corrected']


def test_evidence_ranks_candidates_and_colours_named_effects() -> None:
    pytest.importorskip('matplotlib')
    evidence = {'robot_friction': 0.3, 'coulomb_friction': 0.98, 'force_lag': 0.1}
    d = replace(diagnosed('friction'), evidence=evidence)
    (axis,) = plot_evidence(d).axes
    widths = [bar.get_width() for bar in axis.patches]
    assert widths == sorted(widths, reverse=True)
    assert widths[0] == pytest.approx(98.0)
    names = [label.get_text() for label in axis.get_yticklabels()]
    colours = {bar.get_facecolor() for bar in axis.patches}
    assert 'coulomb friction' in names and len(colours) == 2
