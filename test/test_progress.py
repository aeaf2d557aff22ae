# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The progress bar of the commands: shown on a terminal, silent in a pipe."""

from __future__ import annotations

import io
import sys

from contact_estimation.commands.progress import Progress
import pytest


class Terminal(io.StringIO):
    """A stream that claims to be a terminal."""

    def isatty(self) -> bool:
        return True


def run_to_the_end(stream: io.StringIO, monkeypatch: pytest.MonkeyPatch) -> str:
    """Show three updates on stderr; the bar's delays are removed."""
    monkeypatch.setattr(sys, 'stderr', stream)
    progress = Progress('replay')
    progress._bar.delay = progress._bar.mininterval = 0.0
    for fraction in (0.25, 0.5, 1.0):
        progress.show(fraction, '7 samples')
    progress.done()
    return stream.getvalue()


def test_bar_is_shown_on_a_terminal_and_cleared(monkeypatch: pytest.MonkeyPatch) -> None:
    shown = run_to_the_end(Terminal(), monkeypatch)
    assert 'replay  50.0 %' in shown and '7 samples' in shown
    assert shown.endswith('\r') and not shown.rsplit('\r', 2)[-2].strip()


def test_nothing_is_written_to_a_pipe(monkeypatch: pytest.MonkeyPatch) -> None:
    assert run_to_the_end(io.StringIO(), monkeypatch) == ''
