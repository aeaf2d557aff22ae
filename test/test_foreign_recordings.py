# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Recordings of others: foreign types, hostile files, ordinary bags."""

from functools import lru_cache
import os
from pathlib import Path
from typing import Any, Callable

from concealed_worlds import diagnosed, named, nominal, prepared_from, recorded
import contact_estimation as ce
from contact_estimation.diagnosis.fit.surfaces import Surfaces, surfaces_of
from contact_estimation.diagnosis.observe.observed import observe
from contact_estimation.diagnosis.observe.parts import continuous_parts
from contact_estimation.diagnosis.observe.signals import read_recording, Recording, Signals
from contact_estimation.diagnosis.result import Diagnosis
from contact_estimation.exceptions import ContactEstimationError, RecordingError
from contact_estimation.kinematics.description import read_description
from contact_estimation.parameter_files import read_parameter_file
from contact_estimation.pipeline.events import EstimationEvent
from contact_estimation.pipeline.replay import RecordingReplay
from contact_estimation.plant.plant_parameters import PlantParameters
from contact_estimation.recordings import chunk_reader, RecordingReader
from contact_estimation.recordings.encoding import (
    encode_multi_array, fresh_typestore, JointStateEncoder, WrenchEncoder)
from contact_estimation.recordings.source import RecordingSource
from contact_estimation.texts import printable
import diagnosed_worlds as touches
from mcap.writer import CompressionType, Writer
from mcap_files import numbers, plain_file
import numpy as np
from numpy.typing import NDArray
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
    ('lab_msgs/msg/Board', custom, DEFINED, 'samples[1].force')])
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
    ('lab_msgs/msg/Board', custom, {}, r'such as samples\[0\].force; .* samples\[0:2\].force.x'),
    (ARRAY, array, {'wrench_field': 'data[0:6]'}, 'no stamp; .*--stamps received'),
    (ARRAY, array, {'wrench_field': 'force', 'stamps': 'received'}, 'it holds: .*data'),
    (ARRAY, array, {'wrench_field': 'data[', 'stamps': 'received'}, 'must be a path such as'),
    (WRENCH, stamped, {'topics': {'joint_states': '/wrench', 'wrench': '/joint_states'}},
     'has the type sensor_msgs/msg/JointState, expected geometry_msgs/msg/WrenchStamped'),
    ('lab_msgs/msg/Unknown', array, {}, 'has the type lab_msgs/msg/Unknown, expected')])
def test_other_types_are_named_with_what_they_hold(
    tmp_path: Path, kind: str, wrench: Any, options: Any, text: str
) -> None:
    definition = DEFINED if wrench is custom else ''
    with pytest.raises(ce.ContactEstimationError, match=text):
        ce.read_table(bag(tmp_path / 'a.mcap', kind, wrench, definition), **options)


@pytest.mark.parametrize('frame_id, first, left_out', [('', 0, 60), ('b', 1, 60), ('c', 0, 120)])
def test_wrenches_of_another_frame_are_left_out_and_told(
    tmp_path: Path, frame_id: str, first: int, left_out: int
) -> None:
    def wrench(k: int, time_ns: int) -> bytes:
        return WrenchEncoder('ab'[k % 2]).encode(time_ns, k, 0.0, 0.0)

    path = bag(tmp_path / 'a.mcap', WRENCH, wrench, count=120)
    if left_out == 120:
        with pytest.raises(RecordingError, match="expected frame 'c', got 'b'; set frame_id"):
            read_recording(path, parameters={'frame_id': frame_id})
        return
    recording = read_recording(path, parameters={'frame_id': frame_id})
    assert recording.signals.force.tolist() == list(range(first, 120, 2))
    assert recording.damage.startswith(f'{left_out} wrenches are not in the frame')


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


@pytest.mark.parametrize('content, text', [
    ('a: !!bool foo', "'foo' is no bool"),
    ('a: !!int abc', "'abc' is no int of 64 bits"),
    ('a: 2001-99-99', "'2001-99-99' is no timestamp"),
    (f'a: {"9" * 5000}', 'is no int of 64 bits'),
    ('[' * 100_000, 'more than 50 levels deep'),
    ('a: &a [*a]', r'alias \*a is part of itself'),
    ('a: &a [1, 1, 1]\n' + ''.join(
        f'{y}: &{y} [*{x}, *{x}, *{x}, *{x}, *{x}]\n' for x, y in zip('abcdefgh', 'bcdefghi')),
     'more than 100000 values'),
    ('#' * (1 << 21), 'at most 1048576 bytes'),
    ('version https://git-lfs.github.com/spec/v1', 'git lfs pull')])
def test_yaml_that_python_cannot_hold_is_named(tmp_path: Path, content: str, text: str) -> None:
    (tmp_path / 'a.yaml').write_text(content)
    with pytest.raises(ContactEstimationError, match=f'a.yaml cannot be read: .*{text}'):
        read_parameter_file(tmp_path / 'a.yaml', 'estimator_node')


@pytest.mark.parametrize('event, parameters', [
    ('tare', '{}'), ('tare', '{"force_bias": "abc"}'), ('tare', '{"force_bias": NaN}'),
    ('robot_description', '{}'), ('arm_ready', '{"wrench_ns": 1}'),
    ('static_transforms', '{"transforms": [["a", "b", 1]]}'), ('reset', '[' * 100_000)])
def test_recorded_event_that_cannot_be_repeated_is_refused(event: str, parameters: str) -> None:
    text = (f'{{"event": "{event}", "after_stamp_ns": 0, "time_jumps": 0, '
            f'"parameters": {parameters}}}')
    with pytest.raises(RecordingError, match='expected an estimation event'):
        EstimationEvent.from_text(text)


def test_texts_of_files_are_printed_escaped_and_in_bounds() -> None:
    assert str(RecordingError('a\x1b[2J\nb\u202ec')) == r'a\x1b[2J\nb\u202ec'
    assert printable('\udcff') == r'\xff'
    assert len(str(RecordingError('a' * 10**6))) < 5000
    assert printable('schräg 力') == 'schräg 力'


@pytest.mark.parametrize('compression', [CompressionType.ZSTD, CompressionType.LZ4])
def test_chunk_beyond_the_limit_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, compression: Any
) -> None:
    path = plain_file(tmp_path / 'a.mcap', compression=compression)
    monkeypatch.setattr(chunk_reader, 'LARGEST_CHUNK', 100)
    with pytest.raises(RecordingError, match='MiB decompressed, expected at most'):
        numbers(RecordingReader(path))


@pytest.mark.parametrize('compression', [CompressionType.ZSTD, CompressionType.LZ4])
def test_chunk_that_holds_more_than_it_states_is_damage(tmp_path: Path, compression: Any) -> None:
    content = bytearray(plain_file(
        tmp_path / 'a.mcap', compression=compression, finish=False).read_bytes())
    name = content.rindex(compression.name.lower().encode())
    content[name - 16:name - 8] = (10).to_bytes(8, 'little')  # uncompressed_size
    (tmp_path / 'a.mcap').write_bytes(content)
    reader = RecordingReader(tmp_path / 'a.mcap')
    assert numbers(reader)[0] == 0
    assert reader.damaged_chunks == 1


@pytest.mark.parametrize('name', ['a.mcap', 'a.csv', 'a.parquet', 'a.mat', 'a.db3', 'a.urdf'])
def test_file_that_holds_no_data_itself_is_named(tmp_path: Path, name: str) -> None:
    read = read_description if name == 'a.urdf' else RecordingReader
    for start, text in ((b'version https://git-lfs.github.com/spec/v1\n', 'git lfs pull'),
                        (b'\x1f\x8b\x08', r'compressed \(gzip\); decompress'),
                        (b'PK\3\4', r'spreadsheet \(.xlsx\); unpack it, or save')):
        (tmp_path / name).write_bytes(start)
        with pytest.raises(ContactEstimationError, match=text):
            read(tmp_path / name)
    (tmp_path / 'pipe').mkdir()
    os.mkfifo(tmp_path / 'pipe' / name)
    with pytest.raises(ContactEstimationError, match='got a folder, pipe or device'):
        read(tmp_path / 'pipe' / name)


Array = NDArray[np.float64]
NO_REFERENCE = (np.empty(0), np.empty((4, 0)))


def attached(**wall: float) -> PlantParameters:
    """Describe a permanently attached specimen."""
    parameters: dict[str, Any] = {f'environment__{name}': value for name, value in wall.items()}
    return nominal(environment__unilateral=False, **parameters)


def signals_of(t: Array, force: Array, x: Array) -> Signals:
    """Sample force and position of a specimen together."""
    return Signals(t, force, t, x, *NO_REFERENCE)


def relaxing(t: Array, x: Array, K: float, K_1: float, tau: float) -> Array:
    """Compute the force of a standard linear solid, v constant between samples."""
    branch, share = np.zeros(len(t)), np.exp(-(t[1] - t[0]) / tau)
    gain = K_1 * tau / (t[1] - t[0]) * (1.0 - share)
    for k in range(1, len(t)):
        branch[k] = share * branch[k - 1] + gain * (x[k] - x[k - 1])
    return -K * x - branch


def test_a_pause_of_all_topics_makes_two_parts() -> None:
    s = touches.recorded()
    kept = (s.wrench_t < 2.0) | (s.wrench_t > 4.2)
    t = s.wrench_t[kept]
    cut = Signals(t, s.force[kept], t, s.position[kept], t, s.reference[:, kept])
    parts = continuous_parts(Recording('file', cut), touches.nominal())
    assert [one.name for one in parts] == ['file, 0.0 to 2.0 s', 'file, 4.2 to 6.7 s']
    assert observe(parts[1].signals, touches.nominal()).t[0] == parts[1].signals.wrench_t[0] > 4.0


@pytest.mark.slow
def test_relaxation_of_minutes_is_named_at_1_hz() -> None:
    t = np.arange(1800.0)
    x = np.interp(t, (30.0, 40.0, 1200.0, 1230.0), (0.0, 1e-3, 1e-3, 5e-4))
    noise = np.random.default_rng(1).normal(size=(2, len(t)))
    force = relaxing(t, x, 5000.0, 4000.0, 200.0) + 0.01 * noise[0]
    found = diagnosed(signals_of(t, force, x + 5e-7 * noise[1]),
                      attached(stiffness=6000.0, damping=1000.0))
    assert named(found) == ['viscoelastic_relaxation']
    assert found.effects[0].parameters['tau'].value == pytest.approx(200.0, rel=0.05)


@pytest.mark.slow
def test_creep_of_a_sensor_is_named_though_relaxation_would_need_a_force_that_decays() -> None:
    t = np.arange(0.0, 200.0, 0.5)
    x = np.interp(t, (5.0, 7.0, 50.0, 52.0, 90.0, 92.0, 150.0, 152.0),
                  (0.0, 4e-3, 4e-3, 8e-3, 8e-3, 2.8e-3, 2.8e-3, 0.0))
    noise = np.random.default_rng(4).normal(size=(2, len(t)))
    # tau y' + y = F_e, F_e straight between samples; the sensor adds a share of y
    y = relaxing(t, x, 0.0, -50.0, 4.0) - 50.0 * x
    found = diagnosed(signals_of(t, -50.0 * x + 0.17 * y + 2e-3 * noise[0], x + 4e-7 * noise[1]),
                      attached(stiffness=50.0, damping=1.5))
    assert named(found) == ['force_creep']
    assert found.effects[0].parameters['tau'].value == pytest.approx(4.0, rel=0.1)


APART = (1e-3, -1.3e-3, 0.2e-3)
TURNS = ((2.85, 3.2), (5.0, 5.35))
"""Between the contacts, while the tool is away."""


def shift_of(t: Array, places: tuple[float, ...]) -> Array:
    """Return the place of the object: it is moved by a smooth step between two contacts."""
    shift = np.full(len(t), places[0])
    for before, after, (begin, end) in zip(places, places[1:], TURNS):
        shift += (after - before) * 0.5 * (1.0 + np.tanh(
            (t - 0.5 * (begin + end)) / (0.1 * (end - begin))))
    return shift


def moved(places: tuple[float, ...], **changes: Any) -> Signals:
    """Touch an object that lies at another place in each contact, where the robot follows it."""
    s = recorded(**changes)
    reference, t, h = s.reference.copy(), s.reference_t, 1e-4
    before, now, after = (shift_of(t + by, places) for by in (-h, 0.0, h))
    reference[0] += now
    reference[1] += (after - before) / (2.0 * h)
    reference[2] += (after - 2.0 * now + before) / h**2
    return s._replace(position=s.position + shift_of(s.joint_t, places), reference=reference)


def surfaces(signals: Signals) -> Surfaces:
    """Measure the surfaces of a recording."""
    return surfaces_of([prepared_from(signals)[0]])


@lru_cache(maxsize=None)
def of_moved(*changes: tuple[str, float]) -> Diagnosis:
    """Diagnose a world whose object is moved."""
    return diagnosed(moved(APART, **dict(changes)))


def test_each_contact_tells_its_place_and_all_together_the_wall() -> None:
    found = surfaces(moved(APART))
    assert found.are_apart
    assert found.fitted == pytest.approx(APART, abs=3e-5)
    assert found.touched == pytest.approx(APART, abs=found.blur)
    assert found.stiffness == pytest.approx(5000.0, rel=2e-3)
    assert found.damping == pytest.approx(120.0, rel=0.02)


@pytest.mark.slow
def test_an_object_that_is_moved_is_told_and_its_wall_found() -> None:
    found = of_moved()
    assert found.verdict == 'recalibrate' and not found.effects
    assert found.recalibrated.stiffness == pytest.approx(5000.0, rel=3e-3)
    check, = (one for one in found.checks if one.name == 'wall_location')
    assert not check.ok and not check.fatal
    assert 'in 3 contacts, expected at one place' in check.text
