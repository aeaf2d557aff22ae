# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The page: self-contained, well formed, complete, and escaped."""

from __future__ import annotations

from dataclasses import replace
from html.parser import HTMLParser
import re
import sys

from contact_estimation.diagnosis.checks.check import Check
from contact_estimation.diagnosis.observe.model import Model
from contact_estimation.diagnosis.report import page as page_module
from contact_estimation.diagnosis.report.page import as_html, with_std
from contact_estimation.diagnosis.report.wording import headline, meaning
from contact_estimation.diagnosis.result import refuse
from contact_estimation.exceptions import MissingPackageError
from diagnosed_worlds import diagnosed, nominal
import pytest

pytestmark = pytest.mark.slow

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
    name if name == 'friction' else pytest.param(name, marks=pytest.mark.slow) for name in NAMES
])
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
    (float('nan'), 1.0, '&ndash;'),
])
def test_numbers_are_rounded_to_two_digits_of_their_uncertainty(
    value: float, std: float, text: str
) -> None:
    assert with_std(value, std) == text
