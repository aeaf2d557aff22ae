# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The plant node, and the recorder."""

import json
from pathlib import Path
import signal
from typing import Any, Iterator

from contact_estimation.exceptions import RecordingError
from contact_estimation.recordings import RecordingReader
from contact_estimation.recordings.decoding import decode_string, WrenchDecoder
import pytest
from rclpy.qos import QoSProfile, ReliabilityPolicy as Reliability
from ros_listener import Listener
from ros_messages import JointState, JointTrajectory, trajectory, wrench, WrenchStamped
from ros_peer import estimator_and_peer, PERIOD_NS, WINDOW
from ros_processes import node_process, wait_until

pytestmark = pytest.mark.slow

START = -0.1
STILL = f'start: {START}\nsegments: [{{duration: 5.0, position: {START}}}]\n'


class RobotUser(Listener):
    """Hears the plant and tells the robot where to go."""

    def __init__(self) -> None:
        super().__init__()
        self.listen('wrench', WrenchStamped, 'wrench')
        self.listen('joints', JointState, 'joint_states')
        self.listen('wishes', JointTrajectory, 'desired_trajectory')
        self.follow = self.node.create_publisher(JointTrajectory, 'reference_trajectory', 10)

    def hear_to_the_end(self, process: Any, last: int) -> None:
        """Wait until the plant has ended and its last sample is here."""
        self.spin_until(lambda: not process.running, 'the end of the plant')
        self.spin_until(lambda: len(self.heard['wrench']) >= last, f'{last} samples')

    def soon(self) -> int:
        """Return a stamp 0.6 s ahead, once the plant listens and is heard [ns]."""
        self.spin_until(self.follow.get_subscription_count, 'the plant to listen')
        before = len(self.heard['wrench'])
        self.spin_until(lambda: len(self.heard['wrench']) > before, 'a sample')
        return max(self.heard['wrench']) + 300 * PERIOD_NS

    def hear_until(self, stamp_ns: int) -> None:
        """Listen to samples of both topics up to a stamp."""
        self.spin_until(
            lambda: all(max(self.heard[name]) > stamp_ns for name in ('wrench', 'joints')),
            f'samples up to {stamp_ns}')

    def positions(self) -> dict[int, float]:
        """Measured positions by their stamps."""
        return {stamp: message.position[0] for stamp, message in self.heard['joints'].items()}


@pytest.fixture
def user() -> Iterator[RobotUser]:
    listener = RobotUser()
    yield listener
    listener.close()


@pytest.fixture
def still(tmp_path: Path) -> str:
    """Write an experiment in which the planner wants the robot to stay."""
    file = tmp_path / 'still.yaml'
    file.write_text(STILL)
    return str(file)


def test_samples_are_stamped_exactly_with_the_period(
    tmp_path: Path, user: RobotUser, still: str
) -> None:
    file = tmp_path / 'summary.json'
    with node_process(
        tmp_path, 'plant_node', experiment=still, duration=0.2, seed=7, sensors__force_noise=1.0,
        summary_file=file, joint='slider', frame_id='probe',
    ) as process:
        user.hear_to_the_end(process, 100)
        user.spin_until(lambda: all(len(kept) >= 100 for kept in user.heard.values()), 'the rest')
    begin_ns = json.loads(file.read_text())['begin_stamp_ns']
    stamps = [begin_ns + k * PERIOD_NS for k in range(100)]
    assert list(user.heard['wrench']) == list(user.heard['joints']) == stamps
    assert list(user.heard['wishes']) == [stamp + PERIOD_NS for stamp in stamps]
    assert {message.header.frame_id for message in user.heard['wrench'].values()} == {'probe'}


def test_reference_is_followed_from_its_stamp_on_and_not_before(
    tmp_path: Path, user: RobotUser, still: str
) -> None:
    with node_process(tmp_path, 'plant_node', experiment=still, repeat=True):
        later = user.soon()
        user.follow.publish(trajectory(later, -0.05, 0.0))
        user.hear_until(later + 700 * PERIOD_NS)
    positions = user.positions()
    assert {x for stamp, x in positions.items() if stamp <= later} == {START}
    assert list(positions.values())[-1] == pytest.approx(-0.05, abs=1e-3)


def test_interrupt_ends_the_plant_and_keeps_its_summary(
    tmp_path: Path, user: RobotUser, still: str
) -> None:
    file = tmp_path / 'summary.json'
    with node_process(
        tmp_path, 'plant_node', experiment=still, repeat=True, summary_file=file
    ) as process:
        user.spin_until(lambda: user.heard['wrench'], 'the first sample')
        process.signal(2)
        finished = process.end()
    wait_until(file.exists, 'the summary')
    assert (finished.code, finished.stderr) == (0, '')
    assert json.loads(file.read_text())['samples_sent'] >= len(user.heard['wrench']) > 0


def recorded_stamps(folder: Path) -> set[int]:
    """Read the stamps of all wrenches that a recording holds so far."""
    decode = WrenchDecoder().decode
    try:
        return {decode(m.data).stamp_ns for m in RecordingReader(folder).messages(['wrench'])}
    except RecordingError:  # not there yet
        return set()


def recorded_parameters(folder: Path) -> dict[str, str]:
    """Read the parameters of the estimator node that a recording holds so far."""
    try:
        return RecordingReader(folder).metadata().get('estimator_node', {})
    except RecordingError:  # the file is made before its first bytes are written
        return {}


class Sensor(Listener):
    """Publishes numbered wrenches."""

    def __init__(self, reliability: Reliability = Reliability.RELIABLE, number: int = 0) -> None:
        super().__init__()
        qos = QoSProfile(depth=100, reliability=reliability)
        self.wrenches = self.node.create_publisher(WrenchStamped, 'wrench', qos)
        self.number = number

    def measure(self) -> None:
        """Publish the next one."""
        self.number += 1
        self.wrenches.publish(wrench(self.number * PERIOD_NS, -1.0))

    def measure_until_recorded(self, folder: Path, number: int = 1) -> None:
        """Publish until the file holds the wrench of that number or a later one."""
        def measured() -> bool:
            """Publish once more and look."""
            self.measure()
            return max(recorded_stamps(folder), default=0) >= number * PERIOD_NS

        wait_until(measured, 'a recorded wrench', every_s=0.02)


def test_killed_recorder_leaves_all_that_was_flushed(tmp_path: Path) -> None:
    folder, sensor = tmp_path / 'recording', Sensor()
    with node_process(tmp_path / 'recorder', 'recorder_node', output=folder) as process:
        sensor.measure_until_recorded(folder)
        first = sensor.number
        for _ in range(WINDOW):
            sensor.measure()
        last = sensor.number
        sensor.measure_until_recorded(folder, last)
        process.signal(signal.SIGKILL)
        assert process.end().code == -signal.SIGKILL
    sensor.close()
    flushed = {number * PERIOD_NS for number in range(first, last + 1)}
    assert flushed <= recorded_stamps(folder)
    assert RecordingReader(folder).truncated


def test_recorder_with_patience_takes_the_wrench_once_it_can_hear_the_estimates(
    tmp_path: Path
) -> None:
    sensor = Sensor()
    joints = sensor.node.create_publisher(JointState, 'joint_states', 10)
    with node_process(tmp_path / 'recorder', 'recorder_node', output=tmp_path / 'recording',
                      patience_s=1e3):
        wait_until(joints.get_subscription_count, 'the recorder')
        assert sensor.wrenches.get_subscription_count() == 0
        with node_process(tmp_path / 'estimator', 'estimator_node'):
            wait_until(lambda: sensor.wrenches.get_subscription_count() == 2, 'both')
    sensor.close()


def test_late_recorder_still_gets_parameters_at_start_and_status(tmp_path: Path) -> None:
    folder = tmp_path / 'recording'
    for peer in estimator_and_peer(
        tmp_path / 'estimator', environment__initial_stiffness=1234.0, estimator='rls'
    ):
        peer.change(environment__initial_stiffness=4321.0)
        with node_process(tmp_path / 'recorder', 'recorder_node', output=folder) as process:
            wait_until(lambda: recorded_parameters(folder), 'recorded parameters')
            process.signal(signal.SIGINT)
            assert process.end().code == 0
    recorded = recorded_parameters(folder)
    assert json.loads(recorded['environment.initial_stiffness']) == 1234.0
    assert json.loads(recorded['estimator']) == 'rls'
    texts = [
        decode_string(m.data)
        for m in RecordingReader(folder).messages(['estimator_node/events'])]
    assert [json.loads(text)['event'] for text in texts] == ['start', 'set_parameters']
    status, = RecordingReader(folder).messages(['estimator_node/status'])
    assert decode_string(status.data) == 'free'
