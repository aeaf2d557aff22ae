# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Finished results as files: an interrupted run resumes where it stopped."""

from __future__ import annotations

import json
import os
from pathlib import Path

from .one_recording import Outcome, OUTCOME_NAMES, POOLED_NAMES, Result
from ..texts import json_content

_RESULTS, _PAGES = 'finished', 'recordings'


class Finished:
    """The finished results in the folder of a run."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        for name in (_RESULTS, _PAGES):
            (folder / name).mkdir(parents=True, exist_ok=True)

    def get(self, key: str, with_page: bool) -> Outcome | None:
        """Return a finished result."""
        try:
            outcome: Outcome = json_content(self._file(key).read_text(encoding='utf-8'))
        except (FileNotFoundError, ValueError):
            return None
        if not isinstance(outcome, dict) or set(outcome) not in (POOLED_NAMES, OUTCOME_NAMES):
            return None  # damaged, or of another version
        lacks_page = with_page and outcome['report'] is not None and not self.page(key)
        return None if lacks_page else outcome

    def keep(self, key: str, result: Result) -> None:
        """Write a result atomically."""
        if result.page:
            write_whole(self._folder / _PAGES / _page_name(key), result.page.encode('utf-8'))
        text = json.dumps(result.outcome, allow_nan=False)
        write_whole(self._file(key), text.encode('utf-8'))

    def page(self, key: str) -> str:
        """Return the path of a diagnosis's page."""
        path = f'{_PAGES}/{_page_name(key)}'
        return path if (self._folder / path).exists() else ''

    def _file(self, key: str) -> Path:
        return self._folder / _RESULTS / f'{key}.json'


def _page_name(key: str) -> str:
    return f'{key[:16]}.html'


def write_whole(file: Path, data: bytes) -> None:
    """Write a file whole or not at all."""
    partial = file.with_name(file.name + '.partial')
    with open(partial, 'wb') as stream:
        stream.write(data)
        stream.flush()
        os.fsync(stream.fileno())
    os.replace(partial, file)
