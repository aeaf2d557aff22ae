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

"""The page with pictures: all in one file, in plain words, and nothing that would break it."""

from __future__ import annotations

from dataclasses import replace
from html.parser import HTMLParser
import sys

from contact_estimation.diagnosis.report.page import as_html, headline, meaning
from contact_estimation.diagnosis.report.pictures import draw
from contact_estimation.diagnosis.report.seen import held_out_spans, seen
from contact_estimation.diagnosis.report.written_numbers import plain, with_std
from contact_estimation.exceptions import MissingPackageError
from contact_estimation.physics import EFFECTS
from diagnosed_worlds import diagnosed
import numpy as np
import pytest

NAMES = ('clean', 'stiffer', 'friction', 'unknown')
EVERY = pytest.mark.parametrize('name', NAMES)
ALONE = {'meta', 'img', '!doctype'}  # tags that need no end


class Page(HTMLParser):
    """Collects tags and text, and checks that they are nested."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.text = ''
        self.feed(page)
        self.close()

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        """Note a tag."""
        self.tags.append((tag, dict(attributes)))
        if tag not in ALONE:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        """Close the tag that was opened last."""
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        """Collect text."""
        if 'style' not in self.open:
            self.text += data


@pytest.fixture(scope='module', params=NAMES)
def page(request: pytest.FixtureRequest) -> tuple[str, str]:
    """Make the page of each world once."""
    pytest.importorskip('matplotlib')
    return request.param, as_html(diagnosed(request.param), 'a.mcap')


def test_page_needs_nothing_but_itself(page: tuple[str, str]) -> None:
    _, text = page
    assert len(text) < 1.5e6
    assert 'http' not in text and 'url(' not in text and '@import' not in text
    tags = Page(text).tags
    assert not {'script', 'link', 'iframe', 'object'} & {tag for tag, _ in tags}
    sources = [attributes['src'] for _, attributes in tags if 'src' in attributes]
    assert len(sources) == 5
    assert all((source or '').startswith('data:image/png;base64,iVBOR') for source in sources)


def test_page_is_well_formed_and_describes_its_pictures(page: tuple[str, str]) -> None:
    parsed = Page(page[1])
    assert parsed.open == []
    pictures = [attributes for tag, attributes in parsed.tags if tag == 'img']
    assert all(len(attributes['alt'] or '') > 20 for attributes in pictures)


def test_page_says_verdict_effects_and_held_out_errors(page: tuple[str, str]) -> None:
    name, text = page
    d, said = diagnosed(name), Page(text).text
    assert d.verdict.replace('_', ' ') in said and headline(d) in said
    for effect in d.effects:
        assert effect.name in said and effect.equation in said and meaning(effect.name) in said
    assert f'{d.holdouts[0].force.nominal:.4g}' in said
    assert f'{d.noise_floor:.3g} N' in said


def test_names_from_outside_are_escaped() -> None:
    pytest.importorskip('matplotlib')
    nasty = '<script>"&'
    d = diagnosed('friction')
    effect = replace(d.effects[0], indistinguishable_from=['stribeck_friction'])
    d = replace(d, effects=[effect], holdouts=[replace(d.holdouts[0], name=nasty)],
                next_experiment=nasty)
    text = as_html(d, nasty, nasty)
    assert '<script' not in text
    said = Page(text).text
    assert said.count(nasty) >= 4
    assert 'cannot tell it from stribeck_friction' in said


def test_headline_gives_the_values() -> None:
    assert headline(diagnosed('friction')).startswith(
        'The simulation lacks coulomb friction in the contact (F_c = ')
    K = diagnosed('stiffer').recalibrated.stiffness
    assert f'K_e is {K:.5g} N/m instead of 5000' in headline(diagnosed('stiffer'))


@pytest.mark.parametrize('name', EFFECTS)
def test_every_effect_has_a_meaning_in_one_plain_line(name: str) -> None:
    assert 10 < len(meaning(name)) < 99 and meaning(name).endswith('.')


@EVERY
def test_shaded_spans_are_the_samples_that_no_fit_has_used(name: str) -> None:
    port = diagnosed(name).recordings[0]
    ((first, last),) = held_out_spans(diagnosed(name))
    inside = (port.observed.t >= first) & (port.observed.t <= last)
    assert not port.use[inside].any()
    assert port.use[~inside].mean() > 0.95


def test_close_up_holds_the_greatest_difference() -> None:
    data = seen(diagnosed('unknown'))
    before, _ = data.pair
    left = data.residuals[0].left[before]
    first, last = data.close_up_span
    inside = (data.block_t >= first) & (data.block_t <= last)
    assert np.mean(left[inside] ** 2) > 1.2 * np.mean(left**2)


def test_pictures_are_png_of_moderate_size() -> None:
    pytest.importorskip('matplotlib')
    pictures = draw(diagnosed('friction'))
    assert set(pictures) == {'overlay', 'residuals', 'plane', 'dependence', 'evidence'}
    assert all(data.startswith(b'\x89PNG') and len(data) < 4e5 for data in pictures.values())


def test_missing_matplotlib_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
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
def test_numbers_keep_the_digits_that_their_uncertainty_leaves(
    value: float, std: float, text: str
) -> None:
    assert with_std(value, std) == text


def test_plain_numbers_keep_five_digits() -> None:
    assert [plain(5000.0), plain(123456.7)] == ['5000', '1.2346 &times; 10<sup>5</sup>']
