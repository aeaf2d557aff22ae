# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The plant node: exact stamps, its reference followed in time, seeded noise, patience."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, Iterator

import pytest
from ros_listener import Listener
from ros_messages import JointState, JointTrajectory, trajectory, WrenchStamped
from ros_peer import PERIOD_NS
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
