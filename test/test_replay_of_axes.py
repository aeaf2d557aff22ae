# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The command replay on several axes: columns, fields and vectors beside those of one axis."""

from __future__ import annotations

import json
from pathlib import Path

from axes_runs import feed_axes, instants, JOINTS, LOCATIONS, PARAMETERS, session_of_axes
from contact_estimation.commands import replay
from contact_estimation.messages import Vector3StampedDecoder, WrenchEncoder
from contact_estimation.recordings import RecordingReader, RecordingWriter
from contact_estimation.recordings.estimation_metadata import RECORD, to_metadata
import pytest
from reference_messages import joint_state_bytes, JOINTS as JOINTS_TYPE

SAMPLES = instants(0.3)
COLUMNS = ('stiffness', 'damping', 'stiffness_std', 'damping_std')


@pytest.fixture(scope='module')
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp('axes') / 'a.mcap'
    wrenches = WrenchEncoder('tool')
    with RecordingWriter.file(path) as writer:
        for stamp_ns, positions, velocities, forces in SAMPLES:
            raw = joint_state_bytes(
                ['elbow', *reversed(JOINTS.values())], [9.0, *reversed(positions)],
                [9.0, *reversed(velocities)], stamp_ns=stamp_ns,
            )
            writer.write('/joint_states', JOINTS_TYPE, raw, stamp_ns)
            raw = wrenches.encode(stamp_ns, *forces)
            writer.write('/wrench', 'geometry_msgs/msg/WrenchStamped', raw, stamp_ns)
        writer.write_metadata(RECORD, to_metadata(PARAMETERS))
    return path


def run(*arguments: object) -> int:
    """Run the command in this process."""
    return replay.main([str(argument) for argument in arguments])


def test_csv_has_columns_of_every_axis(recording: Path, tmp_path: Path) -> None:
    assert run(recording, '--csv', tmp_path / 'a.csv') == 0
    header, *rows = (tmp_path / 'a.csv').read_text().splitlines()
    names = [*COLUMNS, 'status']
    assert header.split(',') == ['t', *names, *(f'{n}_{a}' for a in 'yz' for n in names)]
    results = feed_axes(session_of_axes(False), SAMPLES)
    for row, result in zip(rows, results, strict=True):
        own = [[*(repr(getattr(e, n)) for n in COLUMNS), e.status.value]
               for e in result.estimates]
        assert row.split(',')[1:] == sum(own, [])


def test_json_has_an_entry_for_every_axis(recording: Path, tmp_path: Path) -> None:
    assert run(recording, '--json', tmp_path / 'a.json') == 0
    summary = json.loads((tmp_path / 'a.json').read_text())
    last = feed_axes(session_of_axes(False), SAMPLES)[-1]
    for axis, estimate in zip('xyz', last.estimates):
        own = summary['axes'][axis]
        assert (own['stiffness'], own['status']) == (estimate.stiffness, estimate.status.value)
        assert own['location'] == estimate.location
        assert own['location'] == pytest.approx(LOCATIONS[axis], abs=1e-4)  # as found
    assert summary['stiffness'] == summary['axes']['x']['stiffness']


def test_mcap_has_every_axis_in_its_place(recording: Path, tmp_path: Path) -> None:
    assert run(recording, '--output', tmp_path / 'out.mcap') == 0
    decode = Vector3StampedDecoder().decode
    messages = RecordingReader(tmp_path / 'out.mcap').messages(['/estimator_node/damping'])
    vectors = [decode(message.data)[1:] for message in messages]
    results = feed_axes(session_of_axes(False), SAMPLES)
    assert vectors == [tuple(e.damping for e in r.estimates) for r in results]


@pytest.mark.parametrize('given, text', [
    ('y=contact_y', 'AXIS:=JOINT'), ('y:=', 'AXIS:=JOINT'), ('w:=a', 'unknown axis'),
    ('x:=contact_x', 'x is the contact axis'),
])
def test_wrong_further_axis_is_refused(
    recording: Path, capfd: pytest.CaptureFixture[str], given: str, text: str
) -> None:
    assert run(recording, '--further', given) == 1
    lines = capfd.readouterr().err.strip().splitlines()
    assert len(lines) == 1 and text in lines[0]
