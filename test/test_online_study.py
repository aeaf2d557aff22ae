# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The on-line study: its worlds obey their closed forms, and a row of it runs."""

from __future__ import annotations

from pathlib import Path
import re

from contact_estimation.benchmarks.online_study import main, ROWS
import pytest


def test_a_row_prints_its_line_and_writes_every_world(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    monkeypatch.setitem(ROWS, 'taps', ROWS['taps']._replace(quick=1))
    assert main(['--only', 'taps', '--quick', '--json', str(tmp_path / 'study.json')]) == 0
    printed = capsys.readouterr().out
    assert re.search(r'\| taps: 20 ms, x_e as told \| 1 \| .*contacts detected', printed)
    assert '"K_error"' in (tmp_path / 'study.json').read_text()


@pytest.mark.parametrize(('arguments', 'message'), [
    (['--only', 'tap'], "--only must name rows .*taps.*, got 'tap'"),
    (['--seed', '-1'], '--seed must be >= 0, got -1'),
    (['--jobs', '0'], '--jobs must be >= 1, got 0'),
])
def test_bad_options_are_refused(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(arguments) == 1
    assert re.search(message, capsys.readouterr().err)
