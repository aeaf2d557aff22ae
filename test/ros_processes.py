# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
Modules of the package as processes of their own, in a ROS domain of the test session.

Importing this module skips a test module where there is no ROS. Parallel sessions do not hear each
other. Nothing here sleeps for luck: every wait is for a condition, with a time limit that a busy
machine does not reach.

"""

from contextlib import suppress
import os
from pathlib import Path
import signal
import socket
import subprocess
import sys
import time
from typing import Any, Callable, Collection, Mapping, NamedTuple

import contact_estimation
from contact_estimation.recordings import RecordingReader
from contact_estimation.recordings.cdr import header_stamp_ns
import pytest

pytest.importorskip('rclpy')


def _own_domain() -> tuple[int, socket.socket | None]:
    """
    Return a ROS domain that no other test session of this machine uses, and what reserves it.

    All sessions use the same stamps: a node of another one would answer in place of ours. Names
    of abstract sockets are as local as the ports of DDS, and end with the last process that has
    them: a node that outlives its session keeps its domain.

    """
    chosen = os.environ.get('CONTACT_ESTIMATION_TEST_DOMAIN')
    if chosen:
        return int(chosen), None
    # Beyond 101 the ports of a domain lie among those that Linux hands out for other purposes.
    for number in range(100):
        domain = 1 + (os.getpid() + number) % 100
        reservation = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        try:
            reservation.bind(f'\0contact_estimation_test_domain_{domain}')
            return domain, reservation
        except OSError:
            reservation.close()
    raise RuntimeError('all 100 ROS domains for tests are in use; end other test sessions')


DOMAIN, _reservation = _own_domain()
PATIENCE_S = 240.0
RELIABLE = {f'qos_overrides./{topic}.subscription.reliability': 'reliable'
            for topic in ('wrench', 'joint_states', 'desired_trajectory', 'reference_trajectory')}


def environment(log_folder: Path) -> dict[str, str]:
    """Make the environment of a process that shares this session's ROS domain."""
    source = str(Path(contact_estimation.__file__).resolve().parents[1])
    paths = [source, *filter(None, [os.environ.get('PYTHONPATH')])]
    return {
        **os.environ,
        'PYTHONPATH': os.pathsep.join(paths),
        'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST',
        'ROS_DOMAIN_ID': str(DOMAIN),
        'ROS_LOG_DIR': str(log_folder),
        'MPLCONFIGDIR': str(log_folder),
    }


def parameter_arguments(parameters: Mapping[str, Any]) -> list[str]:
    """Write parameters as the command line of a node takes them."""
    words = ['--ros-args']
    for name, value in parameters.items():
        text = str(value).lower() if isinstance(value, bool) else str(value)
        words += ['-p', f'{name}:={text}']
    return words


def wait_until(condition: Callable[[], Any], what: str, every_s: float = 0.02) -> None:
    """Wait for something that happens outside of this process."""
    give_up = time.monotonic() + PATIENCE_S
    while not condition():
        assert time.monotonic() < give_up, f'waited in vain for {what}'
        time.sleep(every_s)


def wait_until_recorded(folder: Path, topics: Collection[str], stamp_ns: int) -> None:
    """Wait until all is in, up to a stamp; each topic comes in order, some of them late."""
    def recorded() -> bool:
        messages = RecordingReader(folder).messages(topics)
        return set(topics) == {m.topic for m in messages if header_stamp_ns(m.data) == stamp_ns}

    wait_until(recorded, 'the whole recording', 0.2)


def descendants(pid: int) -> list[int]:
    """Return the processes that a process has started, and theirs."""
    children = Path(f'/proc/{pid}/task/{pid}/children').read_text().split()
    return [p for child in map(int, children) for p in (child, *descendants(child))]


class Finished(NamedTuple):
    """How a process has ended and what it has said."""

    code: int
    stdout: str
    stderr: str


class Executable:
    """An executable of the package in a process of its own."""

    def __init__(self, folder: Path, name: str, *arguments: str) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        self._out, self._err = folder / 'stdout.txt', folder / 'stderr.txt'
        with open(self._out, 'w') as out, open(self._err, 'w') as err:
            self._process = subprocess.Popen(
                [sys.executable, '-m', 'contact_estimation', name, *arguments],
                env=environment(folder), cwd=folder, stdout=out, stderr=err,
                pass_fds=() if _reservation is None else (_reservation.fileno(),))
        self.pid = self._process.pid

    def __enter__(self) -> 'Executable':
        return self

    def __exit__(self, *trouble: object) -> None:
        if self.running:
            family = [self.pid, *descendants(self.pid)]
            self._process.send_signal(signal.SIGINT)
            try:
                self._process.wait(PATIENCE_S)
            except subprocess.TimeoutExpired:
                # A child left behind would answer the tests that follow.
                for pid in family:
                    with suppress(ProcessLookupError):
                        os.kill(pid, signal.SIGKILL)
                self._process.wait()

    @property
    def running(self) -> bool:
        """Whether it has not ended yet."""
        return self._process.poll() is None

    def signal(self, number: int) -> None:
        """Send a signal to this process alone."""
        self._process.send_signal(number)

    def end(self) -> Finished:
        """Wait until it ends by itself."""
        code = self._process.wait(PATIENCE_S)
        return Finished(code, self._out.read_text(), self._err.read_text())


def run_executable(folder: Path, name: str, *arguments: str) -> Finished:
    """Run an executable of the package to its end."""
    with Executable(folder, name, *arguments) as process:
        return process.end()


def node_process(folder: Path, node: str, **parameters: Any) -> Executable:
    """
    Start a node; double underscores stand for the dots of parameter names.

    It subscribes reliably, as the recorder does by itself: a busy machine loses samples of best
    effort, and tests compare all.
    """
    named = {name.replace('__', '.'): value for name, value in parameters.items()}
    by_itself = node in ('plant_node', 'recorder_node')
    named = {**({} if by_itself else RELIABLE), **named}
    return Executable(folder, node, *parameter_arguments(named))
