# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The view of a contact: the same curves from a replay, a growing recording and live topics."""

from __future__ import annotations

from math import isnan, nan
from pathlib import Path
import shutil
import subprocess
import sys
from threading import Event
from typing import Any

from contact_estimation.commands import loop, simulate, watch
from contact_estimation.messages import encode_string, Vector3StampedEncoder, WrenchEncoder
from contact_estimation.messages.plain_decoding import DIAGNOSTICS_TYPE
from contact_estimation.pipeline.replay import RecordingReplay
from contact_estimation.recordings import RecordingReader, RecordingWriter
from contact_estimation.recordings.growing import GrowingRecording
from contact_estimation.recordings.source import RecordingSource
from contact_estimation.watch import show as watch_show
from contact_estimation.watch.layouts import PLOTS
from contact_estimation.watch.live import LiveContact
from contact_estimation.watch.readings import CHECKS, ContactLog, STATUS
from contact_estimation.watch.show import follow_recording, show
from contact_estimation.watch.view import ContactView
import numpy as np
import pytest
from run_commands import Command

CURVES = {f'{plot.key}/{curve.key}' for plot in PLOTS for curve in plot.curves}
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
    folder = tmp_path_factory.mktemp('watch')
    (folder / 'model.yaml').write_text(
        'plant_node: {ros__parameters: {environment: {stiffness: 4800.0}}}')
    (folder / 'short.yaml').write_text(SHORT)
    assert simulate.main(['--model', str(folder / 'model.yaml'), '--experiment',
                          str(folder / 'short.yaml'), '--output', str(folder / 'a.mcap')]) == 0
    return folder / 'a.mcap'


def diagnostics(name: str, values: dict[str, str]) -> bytes:
    reference = pytest.importorskip('reference_messages')
    pairs = [reference.new('KeyValue', key, value) for key, value in values.items()]
    status = reference.new('DiagnosticStatus', 0, name, 'fine', 'sensor', pairs)
    array = reference.new('DiagnosticArray', reference.header(), [status])
    return bytes(reference.serialized(array, DIAGNOSTICS_TYPE))


def replayed(path: Path) -> ContactLog:
    reader, view = RecordingReader(path), KeptView()
    replay = RecordingReplay(reader, RecordingSource(), {})
    watch_show.show_recording(view, reader, RecordingSource(), replay)  # type: ignore[arg-type]
    return view.log


def test_a_recording_is_shown_as_it_is_replayed(recording: Path) -> None:
    reader, log = RecordingReader(recording), replayed(recording)
    estimates = [axes[0] for batch in RecordingReplay(
        reader, RecordingSource(), {}).estimates() for axes in batch]
    stamps, stiffness = log.values['stiffness/estimate']
    assert stamps == [estimate.stamp_ns for estimate in estimates]
    assert stiffness == [estimate.stiffness for estimate in estimates]
    assert {text.text for text in log.texts if text.path == STATUS} >= {'free', 'estimating'}


def test_curves_are_those_of_the_layout(recording: Path) -> None:
    # x_d is published by a planner, which a simulation has not.
    assert set(replayed(recording).values) == CURVES - {'motion/desired'}


def test_a_long_recording_is_thinned(
    recording: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = replayed(recording).values['stiffness/estimate']
    monkeypatch.setattr(watch_show, '_MOST', 100)
    step = 1 + len(whole[0]) // 100
    thinned = replayed(recording).values
    assert thinned['stiffness/estimate'] == (whole[0][::step], whole[1][::step])
    assert len(thinned['force/measured'][0]) <= 101


def test_band_is_two_deviations_where_it_tells_something() -> None:
    log = ContactLog()
    log.add_estimate('stiffness', 1, 100.0, 10.0)
    log.add_estimate('stiffness', 2, 100.0, 60.0)
    log.add_estimate('stiffness', 3, 100.0, nan)
    assert log.values['stiffness/upper'][1][0] == 120.0
    assert log.values['stiffness/lower'][1][0] == 80.0
    assert all(isnan(value) for value in log.values['stiffness/upper'][1][1:])


def test_a_warning_is_said_when_it_begins_and_when_it_is_over() -> None:
    log = ContactLog()
    for stamp_ns, active in enumerate(({}, {'a': 'a 1'}, {'a': 'a 2'}, {})):
        log.add_checks(stamp_ns, active)
    assert [(said.stamp_ns, said.text) for said in log.texts] == [(1, 'a 1'), (3, 'over: a 2')]
    assert {said.path for said in log.texts} == {CHECKS}


def test_estimate_and_its_deviation_are_joined_by_their_stamp() -> None:
    log, encode = ContactLog(), Vector3StampedEncoder('tool').encode
    on = {topic: callback for topic, _, callback, _ in LiveContact(log).subscriptions()}
    on['estimator_node/stiffness'](encode(1, 100.0, nan, nan))
    on['estimator_node/stiffness_std'](encode(1, 10.0, nan, nan))
    on['estimator_node/stiffness'](encode(2, 200.0, nan, nan))  # its deviation is lost
    on['estimator_node/stiffness'](encode(3, 300.0, nan, nan))
    on['estimator_node/stiffness_std'](encode(3, 10.0, nan, nan))
    assert log.values['stiffness/estimate'] == ([1, 2, 3], [100.0, 200.0, 300.0])
    np.testing.assert_equal(log.values['stiffness/upper'][1], [120.0, nan, 320.0])


def test_status_without_a_stamp_gets_that_of_the_next_wrench() -> None:
    log = ContactLog()
    on = {topic: callback for topic, _, callback, _ in LiveContact(log).subscriptions()}
    on['estimator_node/status'](encode_string('free'))  # latched, before the first wrench
    assert log.texts == []
    on['wrench'](WrenchEncoder('tool').encode(5, -1.0, 0.0, 0.0))
    on['estimator_node/status'](encode_string('estimating'))
    assert [(said.stamp_ns, said.text) for said in log.texts] == [(5, 'free'), (5, 'estimating')]


def test_a_sparing_view_takes_deviations_from_diagnostics() -> None:
    log, encode = ContactLog(), Vector3StampedEncoder('tool').encode
    live = LiveContact(log, '/arm/estimator_node', sparing=True)
    on = {topic: callback for topic, _, callback, _ in live.subscriptions()}
    assert not any(topic.endswith(('_std', 'model_fit')) for topic in on)
    on['wrench'](WrenchEncoder('tool').encode(5, -1.0, 0.0, 0.0))
    for name in ('/arm/estimator_node', '/arm/another_node'):
        values = {'stiffness_std': '10.0' if 'estimator' in name else '30.0', 'model_fit': '1.5',
                  'warning_1': 'samples come at 419.5 Hz'}
        on['/diagnostics'](diagnostics(f'{name}: contact estimation', values))
    on['/arm/estimator_node/stiffness'](encode(6, 100.0, nan, nan))
    assert log.values['stiffness/upper'] == ([6], [120.0])
    assert log.values['model_fit/ratio'] == ([5], [1.5])
    assert [said.text for said in log.texts] == ['samples come at 419.5 Hz']


def test_messages_that_cannot_be_read_are_left_out() -> None:
    log = ContactLog()
    on = {topic: callback for topic, _, callback, _ in LiveContact(log).subscriptions()}
    for topic in ('wrench', 'joint_states', 'reference_trajectory'):
        on[topic](b'\x00\x01\x00\x00')
    assert log.values == {}


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


def test_a_cut_chunk_is_read_when_it_is_complete(tmp_path: Path) -> None:
    with RecordingWriter.folder(tmp_path / 'rec') as writer:
        writer.write('/status', 'std_msgs/msg/String', encode_string('a'), 1)
    whole = next((tmp_path / 'rec').glob('*.mcap')).read_bytes()
    file = tmp_path / 'cut.mcap'
    growing, count = GrowingRecording(file, ['/status']), 0
    for size in range(0, len(whole), 7):
        file.write_bytes(whole[:size])
        count += len(growing.new_messages())
    file.write_bytes(whole)
    count += len(growing.new_messages())
    assert (count, growing.finished) == (1, True)


def test_following_a_finished_recording_shows_the_recorded_messages(recording: Path) -> None:
    view: Any = KeptView()
    follow_recording(view, recording, 'estimator_node', Event(), period_s=0.0)
    assert view.log.values['force/measured'] == replayed(recording).values['force/measured']
    assert view.log.values['motion/measured'] == replayed(recording).values['motion/measured']


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


def test_a_view_needs_rerun(
    recording: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, 'rerun', None)
    message = Command('watch', watch.main, capfd).refusal(recording)
    assert "needs the Python package 'rerun-sdk'" in message


@pytest.mark.parametrize('words, text', [
    (['--save', 'view.png'], 'let its name end in .rrd'),
    (['--axis', 'y'], '--axis needs a RECORDING'),
    (['missing.mcap', '--save', 'view.rrd'], 'missing.mcap does not exist'),
])
def test_wrong_use_is_refused(
    words: list[str], text: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip('rerun')
    monkeypatch.chdir(tmp_path)
    assert text in Command('watch', watch.main, capfd).refusal(*words)


def test_a_view_replaces_no_recording(
    recording: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip('rerun')
    copy = tmp_path / 'recording.rrd'
    shutil.copy(recording, copy)
    assert 'cannot write' in Command('watch', watch.main, capfd).refusal(
        recording, '--save', copy)
    assert copy.read_bytes() == recording.read_bytes()


def test_without_a_display_a_page_is_served(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip('rerun')
    monkeypatch.setattr(sys, 'platform', 'linux')
    for name in ('DISPLAY', 'WAYLAND_DISPLAY'):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr('contact_estimation.watch.show.serve', lambda view, layout: 'served')
    assert show(ContactView('a'), 'window') == 'no display; served'


def test_loop_refuses_a_view_before_it_starts(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip('rerun')
    pytest.importorskip('rclpy')
    message = Command('loop', loop.main, capfd).refusal(
        '--output', tmp_path / 'out', '--watch', 'view.png')
    assert 'let its name end in .rrd' in message and not (tmp_path / 'out').exists()
