# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""A page in a headless Chromium: what its console says, and how it is laid out."""

from __future__ import annotations

import html
import json
from pathlib import Path
import re
import shutil
import subprocess
from typing import NamedTuple

NAMES = ('chromium', 'chromium-browser', 'google-chrome', 'google-chrome-stable')
OPTIONS = (
    '--headless', '--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run',
    '--disable-background-networking', '--disable-component-update', '--disable-sync',
    '--enable-logging=stderr', '--virtual-time-budget=5000', '--dump-dom',
    '--window-size=1400,900',
)
MEASURE = """<script>addEventListener('load', () => {
  const root = document.documentElement;
  parent.postMessage(JSON.stringify({
    dark: matchMedia('(prefers-color-scheme: dark)').matches,
    background: getComputedStyle(document.body).backgroundColor,
    width: root.clientWidth, needed: root.scrollWidth,
    pictures: [...document.images].map(image => image.naturalWidth),
  }), '*');
});</script>"""
# A window has a least width; a frame has not.
FRAME = """<!DOCTYPE html><script>
addEventListener('message', event => {{ document.title = event.data; }});
</script><iframe src="{page}" style="border: 0; width: {width}px; height: 800px"></iframe>"""


class Seen(NamedTuple):
    """What a browser makes of a page: lengths in pixels."""

    console: list[str]
    dark: bool
    background: str
    width: int
    needed: int
    pictures: list[int]


def browser() -> str | None:
    """Return the path of a Chromium, None where there is none."""
    return next((path for name in NAMES if (path := shutil.which(name))), None)


def look_at(page: str, folder: Path, width: int, dark: bool) -> Seen:
    """Open a page; `folder` is empty."""
    (folder / 'page.html').write_text(page.replace('</body>', f'{MEASURE}</body>'))
    (folder / 'frame.html').write_text(FRAME.format(page='page.html', width=width))
    scheme = f'--blink-settings=preferredColorScheme={0 if dark else 1}'
    done = subprocess.run(
        [str(browser()), *OPTIONS, scheme, f'--user-data-dir={folder / "profile"}',
         (folder / 'frame.html').as_uri()],
        capture_output=True, text=True, timeout=120, check=True)
    title = re.search('<title>(.*?)</title>', done.stdout)
    assert title is not None, f'the page did not load: {done.stdout[:500]}{done.stderr[-2000:]}'
    console = [line for line in done.stderr.splitlines() if 'CONSOLE' in line]
    return Seen(console, **json.loads(html.unescape(title[1])))
