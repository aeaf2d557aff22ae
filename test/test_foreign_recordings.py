# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Foreign recordings: other types, no stamps, stamps of another clock, unknown rates."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Callable

import contact_estimation as ce
from contact_estimation.pipeline.replay import RecordingReplay
from contact_estimation.recordings import RecordingReader
from contact_estimation.recordings.encoding import (
    encode_multi_array, fresh_typestore, JointStateEncoder, WrenchEncoder)
from contact_estimation.recordings.source import RecordingSource
from mcap.writer import Writer
import numpy as np
import pytest

START_NS, PERIOD_NS = 1_750_000_000_000_000_000, 10_000_000
WRENCH, ARRAY = 'geometry_msgs/msg/WrenchStamped', 'std_msgs/msg/Float64MultiArray'
DEFINED = ('float64 gain\nSample[2] samples\n' + '=' * 80
           + '\nMSG: lab_msgs/Sample\ngeometry_msgs/Vector3 force\n' + '=' * 80
           + '\nMSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n')


def bag(path: Path, kind: str, wrench: Callable[[int, int], bytes], definition: str = '',
        joint_stamp_ns: int | None = None, count: int = 60) -> Path:
    """Write wrenches of any type, and joint states with stamps of their own."""
    joints = JointStateEncoder('', 'slide', False)
    with open(path, 'wb') as stream:
        writer = Writer(stream)
        writer.start('ros2')
        channels = []
        for topic, name, text in (('/wrench', kind, definition),
                                  ('/joint_states', 'sensor_msgs/msg/JointState', '')):
            schema = writer.register_schema(name, 'ros2msg', text.encode())
            channels.append(writer.register_channel(topic, 'cdr', schema))
        for k in range(count):
            time_ns = START_NS + k * PERIOD_NS
            stamp_ns = time_ns if joint_stamp_ns is None else joint_stamp_ns + k * PERIOD_NS
            writer.add_message(channels[0], time_ns, wrench(k, time_ns), time_ns)
            joint_state = joints.encode(stamp_ns, 0.1 * k, 0.0)
            writer.add_message(channels[1], time_ns, joint_state, time_ns)
        writer.finish()
    return path


def stamped(k: int, time_ns: int) -> bytes:
    return WrenchEncoder('tool').encode(time_ns, k, 0.0, 0.0)


def unstamped(k: int, time_ns: int) -> bytes:
    return b'\0\1\0\0' + np.array([k, 0, 0, 0, 0, 0.0]).tobytes()


def array(k: int, time_ns: int) -> bytes:
    return encode_multi_array([('', 7)], [9.0, k, 0.0, 0.0, 0.0, 0.0, 0.0])


def custom(k: int, time_ns: int) -> bytes:
    store = fresh_typestore('lab_msgs/msg/Board', DEFINED)
    sample, vector = store.types['lab_msgs/msg/Sample'], store.types['geometry_msgs/msg/Vector3']
    samples = [sample(vector(0.0, 0.0, 0.0)), sample(vector(float(k), 0.0, 0.0))]
    message = store.types['lab_msgs/msg/Board'](1.0, samples)
    return bytes(store.serialize_cdr(message, 'lab_msgs/msg/Board'))


@pytest.mark.parametrize('kind, wrench, definition, field', [
    (WRENCH, stamped, '', ''),
    ('geometry_msgs/msg/Wrench', unstamped, '', ''),
    (ARRAY, array, '', 'data[1:7]'),
    (ARRAY, array, '', 'data[1]'),
    ('lab_msgs/msg/Board', custom, DEFINED, 'samples[1].force'),
])
def test_wrenches_of_any_type_are_read_with_the_time_of_reception(
    tmp_path: Path, kind: str, wrench: Any, definition: str, field: str
) -> None:
    path = bag(tmp_path / 'a.mcap', kind, wrench, definition, joint_stamp_ns=5)
    found = ce.read_table(path, stamps='received', wrench_field=field)
    assert found['t_ns'].tolist() == [START_NS + k * PERIOD_NS for k in range(60)]
    assert found['wrench.force.x'].tolist() == list(range(60))
    np.testing.assert_allclose(found['joint.slide'], 0.1 * np.arange(60))


@pytest.mark.parametrize('kind, wrench, options, text', [
    ('geometry_msgs/msg/Wrench', unstamped, {}, 'Wrench, which has no stamp; .*--stamps received'),
    (ARRAY, array, {}, r'type std_msgs/msg/Float64MultiArray, .*--wrench-field .* data\[\] '),
    (ARRAY, array, {'wrench_field': 'data[0:6]'}, 'no stamp; .*--stamps received'),
    (ARRAY, array, {'wrench_field': 'force', 'stamps': 'received'}, 'it holds: .*data'),
    (ARRAY, array, {'wrench_field': 'data[', 'stamps': 'received'}, 'must be a path such as'),
    (WRENCH, stamped, {'topics': {'joint_states': '/wrench', 'wrench': '/joint_states'}},
     'has the type sensor_msgs/msg/JointState, expected geometry_msgs/msg/WrenchStamped'),
    ('lab_msgs/msg/Unknown', array, {}, 'has the type lab_msgs/msg/Unknown, expected'),
])
def test_other_types_are_named_with_what_they_hold(
    tmp_path: Path, kind: str, wrench: Any, options: Any, text: str
) -> None:
    with pytest.raises(ce.ContactEstimationError, match=text):
        ce.read_table(bag(tmp_path / 'a.mcap', kind, wrench), **options)


@pytest.mark.parametrize('period_ns, cutoff', [(PERIOD_NS, 0.0), (1_250_000, 50.0)])
def test_rate_is_measured_where_it_is_not_recorded(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, period_ns: int, cutoff: float
) -> None:
    monkeypatch.setitem(globals(), 'PERIOD_NS', period_ns)
    path = bag(tmp_path / 'a.mcap', WRENCH, stamped)
    source = RecordingSource()
    for given, rate in (({}, 1e9 / period_ns), ({'sample_rate': 400.0}, 400.0)):
        parameters = RecordingReplay(RecordingReader(path), source, given).session.parameters
        assert parameters.sample_rate == pytest.approx(rate)
    found = RecordingReplay(RecordingReader(path), source, {}).session.parameters
    assert found.conditioning.cutoff_frequency == cutoff
