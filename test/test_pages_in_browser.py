# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The pages of diagnose and fleet as a browser shows them."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

from browser import browser, look_at
from contact_estimation.diagnosis.report.page import as_html as diagnosis_page
from contact_estimation.fleet.page.builder import as_html as fleet_page
from diagnosed_worlds import diagnosed
import pytest
from test_fleet_run import made_up

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(browser() is None, reason='no Chromium is installed'),
]
LIGHT, DARK = 'rgb(255, 255, 255)', 'rgb(22, 27, 33)'


@lru_cache(maxsize=None)
def page_of(name: str) -> str:
    pytest.importorskip('matplotlib')
    return fleet_page(made_up()) if name == 'fleet' else diagnosis_page(diagnosed(name), name)


@pytest.mark.parametrize('width, dark', [(1200, False), (400, True)])
@pytest.mark.parametrize('name', ['fleet', 'friction'])
def test_page_shows_its_pictures_and_fits(
    name: str, width: int, dark: bool, tmp_path: Path
) -> None:
    page = page_of(name)
    seen = look_at(page, tmp_path, width, dark)
    assert seen.console == []
    assert len(seen.pictures) == page.count('<img') > 2 and min(seen.pictures) > 0
    assert width - 20 <= seen.width <= width and seen.needed <= seen.width
    assert (seen.dark, seen.background) == (dark, DARK if dark else LIGHT)


def test_an_error_and_an_overflow_are_seen(tmp_path: Path) -> None:
    page = ('<body><p style="width: 900px">wide</p><img src="data:image/png;base64,x">'
            '<script>nonsense()</script></body>')
    seen = look_at(page, tmp_path, 400, False)
    assert len(seen.console) == 1 and 'nonsense' in seen.console[0]
    assert seen.needed > seen.width and seen.pictures == [0]
