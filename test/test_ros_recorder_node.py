# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The recorder node: what it keeps, also when it is killed."""

from __future__ import annotations

import json
from pathlib import Path
import signal

from contact_estimation.exceptions import RecordingError
from contact_estimation.recordings import RecordingReader
from contact_estimation.recordings.plain_decoding import decode_string, WrenchDecoder
import pytest
from rclpy.qos import QoSProfile, ReliabilityPolicy as Reliability
from ros_listener import Listener
from ros_messages import wrench, WrenchStamped
from ros_peer import estimator_and_peer, PERIOD_NS, WINDOW
from ros_processes import node_process, wait_until

pytestmark = pytest.mark.slow


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
        self._wrenches = self.node.create_publisher(WrenchStamped, 'wrench', qos)
        self.number = number

    def measure(self) -> None:
        """Publish the next one."""
        self.number += 1
        self._wrenches.publish(wrench(self.number * PERIOD_NS, -1.0))

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
        for m in RecordingReader(folder).messages(['estimator_node/events'])
    ]
    assert [json.loads(text)['event'] for text in texts] == ['start', 'set_parameters']
    status, = RecordingReader(folder).messages(['estimator_node/status'])
    assert decode_string(status.data) == 'free'
