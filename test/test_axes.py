# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Several axes: estimated beside each other, as full matrices, and replayed."""

from itertools import chain
import json
from math import nan
from pathlib import Path
from typing import Any, Iterable, Sequence

from axes_runs import (
    AXES, feed_axes, feed_axis, Instant, instants, JOINTS, LOCATIONS, PARAMETERS, session_of_axes,
    session_of_axis)
from contact_estimation.commands import replay
from contact_estimation.estimators import ESTIMATORS
from contact_estimation.estimators.stiffness_matrix import (
    matrices, principal_table, StiffnessMatrix, StiffnessMatrixParameters)
from contact_estimation.exceptions import ContactEstimationError
from contact_estimation.parameters import build
from contact_estimation.pipeline.axes import Result
from contact_estimation.pipeline.events import (
    apply_event, biases, EstimationEvent, event_now, TARE)
from contact_estimation.pipeline.parameters import EstimationParameters
from contact_estimation.pipeline.replay import RecordingReplay
from contact_estimation.recordings import RecordingReader, RecordingWriter
from contact_estimation.recordings.decoding import Vector3StampedDecoder
from contact_estimation.recordings.encoding import JointStateEncoder, WrenchEncoder
from contact_estimation.recordings.source import RECORD, RecordingSource, to_metadata
from contact_estimation.signals.contact_sample import AxesSample, ContactSample
from core_runs import contact_samples
import numpy as np
import pytest
from reference_messages import joint_state_bytes, JOINTS as JOINTS_TYPE

SAMPLES = instants()


def estimates_by_axis(results: list[Result]) -> dict[str, list[Any]]:
    """Sort estimates by axis."""
    columns = zip(*(r.estimates for r in results))
    return dict(zip(AXES, map(list, columns)))


@pytest.mark.slow
@pytest.mark.parametrize('estimator', ESTIMATORS)
def test_every_axis_is_estimated_as_if_it_were_alone(estimator: str) -> None:
    together = estimates_by_axis(feed_axes(session_of_axes(False, estimator=estimator), SAMPLES))
    for axis in AXES:
        session = session_of_axis(axis, False, estimator=estimator)
        single = feed_axis(session, [s.of_axis(axis) for s in SAMPLES])
        assert repr(together[axis]) == repr([r.estimate for r in single])


def test_reference_is_that_of_the_contact_axis_alone() -> None:
    together = feed_axes(session_of_axes(force_reference=20.0), SAMPLES)
    session = session_of_axis('x', force_reference=20.0)
    single = feed_axis(session, [s.of_axis('x') for s in SAMPLES])
    assert repr([r.reference for r in together]) == repr([r.reference for r in single])


def biased(samples: list[Instant], count: int) -> list[Instant]:
    """Rest in free flight under a bias."""
    first = samples[0]
    return [first._replace(stamp_ns=k * 2_000_000, forces=(1.0, -2.0, 3.0)) for k in range(count)]


def test_tare_acts_on_every_axis_and_is_repeated_by_its_event() -> None:
    session, other = session_of_axes(), session_of_axes()
    feed_axes(session, biased(SAMPLES, 300))
    done, message = session.tare()
    assert done and message.startswith('x: force bias is now')
    event = event_now(session, TARE, biases(session))
    apply_event(other, EstimationEvent.from_text(event.to_text()))
    assert [p.bias for p in other.pipelines.values()] == pytest.approx([1.0, -2.0, 3.0])
    assert biases(other) == biases(session)


def test_tare_is_refused_for_all_while_one_axis_is_in_contact() -> None:
    session = session_of_axes()
    feed_axes(session, biased(SAMPLES, 300))
    touching = SAMPLES[0]._replace(forces=(0.0, -50.0, 0.0))
    y = touching.positions[1] + 0.02
    touching = touching._replace(positions=(touching.positions[0], y, touching.positions[2]))
    feed_axes(session, [touching._replace(stamp_ns=(300 + k) * 2_000_000) for k in range(3)])
    assert session.tare() == (False, 'y: in contact; move away from the wall and try again')
    assert set(biases(session).values()) == {0.0}


@pytest.mark.parametrize('wrong, text', [
    ({'further_axes.x.joint': 'a'}, 'further_axes.x.joint must be empty, since x is the contact'),
    ({'joint': ''}, 'joint must name the joint of axis x .* got an empty text'),
    ({'further_axes.y.joint': 'contact_z'}, 'must name different joints')])
def test_axes_that_do_not_fit_together_are_refused(wrong: dict[str, str], text: str) -> None:
    with pytest.raises(ContactEstimationError, match=text):
        build(EstimationParameters, {**PARAMETERS, **wrong})


STIFFNESSES = np.array([8000.0, 3000.0, 500.0])
T = 0.002 * np.arange(1500)
MATRIX = {'matrix_estimator': 'stiffness_matrix'}


def samples_of(
    K: np.ndarray, B: np.ndarray, seed: int, noise: float = 0.3, with_velocity: bool = True
) -> list[AxesSample]:
    """Move 1 mm along every axis about a point off the origin; press with K x + B v + c."""
    draw = np.random.default_rng(seed)
    omega, phase = 2.0 * np.pi * draw.uniform(1.0, 6.0, (3, 3, 1)), draw.uniform(0, 6, (3, 3, 1))
    x = 1e-3 * np.sin(omega * T + phase).sum(axis=0).T + np.array([0.4, -0.2, 0.1])
    v = 1e-3 * (omega * np.cos(omega * T + phase)).sum(axis=0).T
    F = -((x - [0.39, -0.2, 0.1]) @ K.T + v @ B.T) + noise * draw.standard_normal(x.shape)
    rates = v if with_velocity else np.full_like(v, nan)
    return [
        tuple(ContactSample(round(2e6 * k), *map(float, (x[k, i], rates[k, i], F[k, i])))
              for i in range(3))
        for k in range(len(T))]


def test_estimates_agree_with_batch_least_squares_of_the_samples() -> None:
    samples = samples_of(np.diag(STIFFNESSES), 10.0 * np.eye(3), 3)
    table = np.array([[[s.position, s.velocity, s.force] for s in axes] for axes in samples])
    weight = np.sqrt(np.exp(0.002 / 5.0 * np.arange(len(T))))[:, None]
    columns = np.column_stack([table[:, :, 0] - table[0, :, 0], table[:, :, 1], np.ones(len(T))])
    theta = np.linalg.lstsq(weight * columns, -weight * table[:, :, 2], rcond=None)[0]
    estimator = StiffnessMatrix(StiffnessMatrixParameters(), 1e-6)  # as here, no lag
    found = estimator.process(samples, [True] * len(samples))[-1]
    assert (np.abs(found.stiffness - theta[:3].T) < 0.7 * found.stiffness_std).all()
    assert (np.abs(found.damping - theta[3:6].T) < 0.7 * found.damping_std).all()


def test_replay_gives_the_matrices_of_the_session(tmp_path: Path) -> None:
    samples, wrenches = instants(0.6), WrenchEncoder('tool')
    with RecordingWriter.file(tmp_path / 'a.mcap') as writer:
        for stamp_ns, positions, velocities, forces in samples:
            raw = joint_state_bytes(list(JOINTS.values()), positions, velocities,
                                    stamp_ns=stamp_ns)
            writer.write('/joint_states', JOINTS_TYPE, raw, stamp_ns)
            raw = wrenches.encode(stamp_ns, *forces)
            writer.write('/wrench', 'geometry_msgs/msg/WrenchStamped', raw, stamp_ns)
        writer.write_metadata(RECORD, to_metadata({**PARAMETERS, **MATRIX}))
    session = session_of_axes(False, **MATRIX)
    feed_axes(session, samples)
    every, last = session.matrix.take(), session.matrix.last
    out, summary = tmp_path / 'out.mcap', tmp_path / 'out.json'
    assert last is not None
    assert replay.main([str(tmp_path / 'a.mcap'), '--json', str(summary), '--output',
                        str(out)]) == 0
    found = json.loads(summary.read_text())['stiffness_matrix']
    assert found['stiffness'] == last.stiffness.tolist()
    assert found['status'] == 'estimating'
    assert session.matrix.status == f'estimating: {found["reason"]}'
    messages = list(RecordingReader(out).messages(['/estimator_node/stiffness_matrix']))
    assert len(messages) == len(every)
    assert messages[-1].data[-36 * 8:] == matrices(last).tobytes()
    assert principal_table(last).shape == (3, 6)


RECORDED = instants(0.3)
COLUMNS = ('stiffness', 'damping', 'stiffness_std', 'damping_std')


@pytest.fixture(scope='module')
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp('axes') / 'a.mcap'
    wrenches = WrenchEncoder('tool')
    with RecordingWriter.file(path) as writer:
        for stamp_ns, positions, velocities, forces in RECORDED:
            raw = joint_state_bytes(
                ['elbow', *reversed(JOINTS.values())], [9.0, *reversed(positions)],
                [9.0, *reversed(velocities)], stamp_ns=stamp_ns)
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
    results = feed_axes(session_of_axes(False), RECORDED)
    for row, result in zip(rows, results, strict=True):
        own = [[*(repr(getattr(e, n)) for n in COLUMNS), e.status.value] for e in result.estimates]
        assert row.split(',')[1:] == sum(own, [])


def test_json_has_an_entry_for_every_axis(recording: Path, tmp_path: Path) -> None:
    assert run(recording, '--json', tmp_path / 'a.json') == 0
    summary = json.loads((tmp_path / 'a.json').read_text())
    last = feed_axes(session_of_axes(False), RECORDED)[-1]
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
    results = feed_axes(session_of_axes(False), RECORDED)
    assert vectors == [tuple(e.damping for e in r.estimates) for r in results]


@pytest.mark.parametrize('given, text', [
    ('y=contact_y', 'AXIS:=JOINT'), ('y:=', 'AXIS:=JOINT'), ('w:=a', 'unknown axis'),
    ('x:=contact_x', 'x is the contact axis')])
def test_wrong_further_axis_is_refused(
    recording: Path, capfd: pytest.CaptureFixture[str], given: str, text: str
) -> None:
    assert run(recording, '--further', given) == 1
    lines = capfd.readouterr().err.strip().splitlines()
    assert len(lines) == 1 and text in lines[0]


TYPES = {'/wrench': 'geometry_msgs/msg/WrenchStamped',
         '/joint_states': 'sensor_msgs/msg/JointState'}
BEGIN_NS, PERIOD_NS = 1_750_000_000_000_000_000, 2_000_000
TOUCH = [sample._replace(stamp_ns=BEGIN_NS + sample.stamp_ns)
         for sample in contact_samples(3.0, force_noise=0.5)]
CHUNK = 200  # messages
Sent = tuple[int, str, bytes]
Replayed = dict[str, tuple[list[str], dict[str, int]]]


def sent(samples: Sequence[ContactSample]) -> list[Sent]:
    """Encode samples: number of the sample, topic and message."""
    wrenches, joints = WrenchEncoder('tool'), JointStateEncoder('tool', 'contact_x', True)
    return list(chain.from_iterable(
        [(k, '/joint_states', joints.encode(stamp_ns, x, v)),
         (k, '/wrench', wrenches.encode(stamp_ns, force, 0.0, 0.0))]
        for k, (stamp_ns, x, v, force) in enumerate(samples)))


def late(messages: Iterable[Sent], topic: str, first: int, until: int) -> list[Sent]:
    """Let a topic from one sample on not be received before another."""
    def received(message: Sent) -> int:
        number = message[0]
        return max(until, number) if message[1] == topic and number >= first else number

    return sorted(messages, key=received)


def replayed(path: Path, messages: Iterable[Sent]) -> tuple[list[str], dict[str, int]]:
    """Record messages in this order and replay them; return estimates and rejections."""
    with RecordingWriter.file(path) as writer:
        for k, (_, topic, raw) in enumerate(messages):
            writer.write(topic, TYPES[topic], raw, BEGIN_NS + k * PERIOD_NS // 2)
            if k % CHUNK == CHUNK - 1:
                writer.flush()
    replay = RecordingReplay(RecordingReader(path), RecordingSource(), {})
    estimates = [repr(axes) for batch in replay.estimates() for axes in batch]
    return estimates, dict(replay.session.rejected)


IN_TIME = sent(TOUCH)
BAD = sent([sample._replace(force=nan) if k % 400 == 300 else sample
            for k, sample in enumerate(TOUCH)])
BACK = sent([*TOUCH, *(sample._replace(stamp_ns=sample.stamp_ns - PERIOD_NS // 2)
                       for sample in TOUCH)])

LIES = (lambda ns: 0, lambda ns: ns + 6 * 10**8, lambda ns: ns - 3 * 10**9)
FALSE = sent([sample._replace(stamp_ns=LIES[k % 3](sample.stamp_ns)) if k % 100 == 50 else sample
              for k, sample in enumerate(TOUCH)])

KINDS = {'regular': IN_TIME, 'with NaN': BAD, 'set back': BACK, 'false stamps': FALSE}


@pytest.fixture(scope='module')
def in_time(tmp_path_factory: pytest.TempPathFactory) -> Replayed:
    """Replay each kind of recording without a late topic."""
    folder = tmp_path_factory.mktemp('in_time')
    return {kind: replayed(folder / f'{kind}.mcap', messages) for kind, messages in KINDS.items()}


@pytest.mark.parametrize('kind', KINDS)
@pytest.mark.parametrize('topic, span', [('/wrench', (310, 380)), ('/joint_states', (0, 110))])
def test_replay_is_that_of_the_topic_in_time(
    in_time: Replayed, tmp_path: Path, topic: str, kind: str, span: tuple[int, int]
) -> None:
    delayed = late(KINDS[kind], topic, *span)
    assert delayed != KINDS[kind]
    assert replayed(tmp_path / 'a.mcap', delayed) == in_time[kind]
    assert len(in_time[kind][0]) > 1700 and not in_time[kind][1].get('joint_missing')
