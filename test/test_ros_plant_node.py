# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The plant node: exact stamps, its reference followed in time, seeded noise, patience."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, Iterator, NamedTuple

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

    def forces(self) -> list[float]:
        """Measured forces in order."""
        return [message.wrench.force.x for message in self.heard['wrench'].values()]

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


class NoisyRun(NamedTuple):
    """What a listener has heard of a whole run, and what the plant says of it."""

    heard: dict[str, dict[int, Any]]
    summary: dict[str, Any]

    @property
    def forces(self) -> list[float]:
        """Measured forces in order."""
        return [message.wrench.force.x for message in self.heard['wrench'].values()]


def noisy_run(folder: Path, seed: int) -> NoisyRun:
    """Run the plant with noise and names of its own for 0.2 s."""
    user, experiment, summary = RobotUser(), folder / 'still.yaml', folder / 'summary.json'
    experiment.write_text(STILL)
    with node_process(
        folder, 'plant_node', experiment=experiment, duration=0.2, seed=seed,
        sensors__force_noise=1.0, summary_file=summary, joint='slider', frame_id='probe',
    ) as process:
        user.hear_to_the_end(process, 100)
        user.spin_until(lambda: all(len(kept) >= 100 for kept in user.heard.values()), 'the rest')
    user.close()
    return NoisyRun(user.heard, json.loads(summary.read_text()))


@pytest.fixture(scope='module')
def run(tmp_path_factory: pytest.TempPathFactory) -> NoisyRun:
    return noisy_run(tmp_path_factory.mktemp('plant'), seed=7)


def test_samples_are_stamped_exactly_with_the_period(run: NoisyRun) -> None:
    stamps = [run.summary['begin_stamp_ns'] + k * PERIOD_NS for k in range(100)]
    assert list(run.heard['wrench']) == list(run.heard['joints']) == stamps
    assert list(run.heard['wishes']) == [stamp + PERIOD_NS for stamp in stamps]


@pytest.mark.parametrize('seed, same', [(7, True), (8, False)])
def test_noise_is_that_of_the_seed(
    run: NoisyRun, tmp_path: Path, seed: int, same: bool
) -> None:
    forces = noisy_run(tmp_path, seed).forces
    assert (forces == run.forces) is same
    assert bool(set(forces) & set(run.forces)) is same


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
