# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Pictures of replay and simulate, and the progress bar of commands."""

from __future__ import annotations

import io
from pathlib import Path
import sys

from contact_estimation.commands import replay, simulate
from contact_estimation.commands.progress import Progress
import pytest
from run_commands import Command

PNG = b'\x89PNG\r\n'
SHORT = """
start: -0.01
segments:
- {duration: 0.4, position: 0.008}
- {duration: 0.3, position: -0.01}
"""


def test_simulate_and_replay_write_a_picture(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip('matplotlib')
    (tmp_path / 'model.yaml').write_text(
        'plant_node: {ros__parameters: {environment: {stiffness: 4800.0}}}')
    (tmp_path / 'short.yaml').write_text(SHORT)
    recording = tmp_path / 'a.mcap'
    simulated = Command('simulate', simulate.main, capfd)(
        '--model', tmp_path / 'model.yaml', '--experiment', tmp_path / 'short.yaml',
        '--output', recording, '--picture', tmp_path / 'a.png')
    replayed = Command('replay', replay.main, capfd)(recording, '--picture', tmp_path / 'b.png')
    assert (simulated.code, replayed.code) == (0, 0)
    assert (tmp_path / 'a.png').read_bytes().startswith(PNG)
    assert (tmp_path / 'b.png').read_bytes().startswith(PNG)


def test_a_picture_of_another_kind_is_refused(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip('matplotlib')
    message = Command('replay', replay.main, capfd).refusal('a.mcap', '--picture', 'run.pdf')
    assert '--picture writes a PNG file, got run.pdf' in message


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
