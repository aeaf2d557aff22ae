# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The live view, and the pictures of commands."""

import io
from pathlib import Path
import subprocess
import sys

from contact_estimation.commands import loop, replay, simulate, watch
from contact_estimation.commands.progress import Progress
from contact_estimation.pipeline.replay import RecordingReplay
from contact_estimation.recordings import RecordingReader, RecordingWriter
from contact_estimation.recordings.encoding import encode_string
from contact_estimation.recordings.mcap_file import GrowingRecording
from contact_estimation.recordings.source import RecordingSource
from contact_estimation.watch import view as watch_view
from contact_estimation.watch.live import ContactLog, STATUS
import pytest
from run_commands import Command

CURVES = {f'{plot}/{curve}' for plot, (_, curves) in watch_view.PLOTS.items() for curve in curves}
SHORT = """
start: -0.01
segments:
- {duration: 0.4, position: 0.008}
- {duration: 0.6, position: -0.01}
"""


class KeptView:
    """A view without a viewer."""

    def __init__(self) -> None:
        self.log = ContactLog()

    def flush(self) -> None:
        """Keep all."""


@pytest.fixture(scope='module')
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    pytest.importorskip('matplotlib')
    folder = tmp_path_factory.mktemp('watch')
    (folder / 'model.yaml').write_text(
        'plant_node: {ros__parameters: {environment: {stiffness: 4800.0}}}')
    (folder / 'short.yaml').write_text(SHORT)
    assert simulate.main(['--model', str(folder / 'model.yaml'), '--experiment',
                          str(folder / 'short.yaml'), '--output', str(folder / 'a.mcap'),
                          '--picture', str(folder / 'a.png')]) == 0
    return folder / 'a.mcap'


def replayed(path: Path) -> ContactLog:
    reader, view = RecordingReader(path), KeptView()
    replay = RecordingReplay(reader, RecordingSource(), {})
    watch_view.show_recording(view, reader, RecordingSource(), replay)  # type: ignore[arg-type]
    return view.log


def test_a_recording_is_shown_as_it_is_replayed(recording: Path) -> None:
    reader, log = RecordingReader(recording), replayed(recording)
    estimates = [axes[0] for batch in RecordingReplay(
        reader, RecordingSource(), {}).estimates() for axes in batch]
    stamps, stiffness = log.values['stiffness/estimate']
    assert stamps == [estimate.stamp_ns for estimate in estimates]
    assert stiffness == [estimate.stiffness for estimate in estimates]
    assert {text.text for text in log.texts if text.path == STATUS} >= {'free', 'estimating'}


def test_a_growing_recording_is_read_as_it_is_flushed(tmp_path: Path) -> None:
    growing = GrowingRecording(tmp_path / 'rec', ['status'])
    assert growing.new_messages() == []  # not there yet
    seen: list[bytes] = []
    with RecordingWriter.folder(tmp_path / 'rec') as writer:
        for number in range(3):
            raw = encode_string(str(number))
            writer.write('/status', 'std_msgs/msg/String', raw, number)
            writer.flush()
            seen += [message.data for message in growing.new_messages()]
            assert len(seen) == number + 1 and seen[-1] == raw
            assert growing.new_messages() == [] and not growing.finished
    assert growing.new_messages() == [] and growing.finished


def test_watch_writes_a_file_that_rerun_reads(
    recording: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip('rerun')
    file = tmp_path / 'view.rrd'
    done = Command('watch', watch.main, capfd)(recording, '--save', file)
    assert done.code == 0 and 'open it with: rerun ' in done.out
    printed = subprocess.run([sys.executable, '-m', 'rerun', 'rrd', 'print', '-v', str(file)],
                             capture_output=True, text=True, check=True).stdout
    for curve in CURVES - {'motion/desired'}:
        assert f'/{curve}' in printed
    assert '/log/status' in printed


def test_a_view_that_the_disk_does_not_hold_is_an_error_and_leaves_no_file(
    recording: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip('rerun')
    file = tmp_path / 'view.rrd'
    file.symlink_to('/dev/full')
    done = Command('watch', watch.main, capfd)(recording, '--save', file)
    assert done.code == 1 and 'watch: the view cannot be written: ' in done.err
    assert 'open it with' not in done.out and not file.is_symlink()


@pytest.mark.parametrize('words, text', [
    (['--save', 'view.png'], 'let its name end in .rrd'),
    (['--axis', 'y'], '--axis needs a RECORDING'),
    (['missing.mcap', '--save', 'view.rrd'], 'missing.mcap does not exist')])
def test_wrong_use_is_refused(
    words: list[str], text: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip('rerun')
    monkeypatch.chdir(tmp_path)
    assert text in Command('watch', watch.main, capfd).refusal(*words)


def test_loop_refuses_a_view_before_it_starts(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip('rerun')
    pytest.importorskip('rclpy')
    message = Command('loop', loop.main, capfd).refusal(
        '--output', tmp_path / 'out', '--watch', 'view.png')
    assert 'let its name end in .rrd' in message and not (tmp_path / 'out').exists()


def test_simulate_and_replay_write_a_picture(
    recording: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    drawn = Command('replay', replay.main, capfd)(recording, '--picture', tmp_path / 'b.png')
    assert drawn.code == 0
    for picture in (recording.with_suffix('.png'), tmp_path / 'b.png'):
        assert picture.read_bytes().startswith(b'\x89PNG\r\n')


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
