# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
How the tests run: arithmetic on one thread, the whole suite on every core, ROS in a queue besides.

`pytest` without paths uses pytest-xdist where it is installed; `-n 0` keeps one process. With
paths, and without pytest-xdist, everything runs in this process.

"""

import os
from pathlib import Path, PurePath
import runpy
import signal
from typing import Any

import pytest

# As in contact_estimation.commands: a second thread for small matrices costs eight times the CPU.
os.environ.setdefault('OMP_NUM_THREADS', '1')
# A shell script's background jobs, and all that they start, ignore SIGINT unless it is restored.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

ROOT = Path(__file__).resolve().parent.parent
STARTS_ROS = ('test_ros_', 'test_replay_node', 'test_loop_command')
NICENESS = 5


def starts_ros(nodeid: str) -> bool:
    """Return whether a test belongs to a module that starts ROS processes."""
    return PurePath(nodeid.partition('::')[0]).name.startswith(STARTS_ROS)


def in_worker() -> bool:
    """Return whether this process is one of several that share the tests."""
    return 'PYTEST_XDIST_WORKER' in os.environ


@pytest.hookimpl(tryfirst=True)
def pytest_cmdline_main(config: pytest.Config) -> None:
    """Run the whole suite on every core; one process more, since the tests of ROS mostly wait."""
    whole = config.args_source is not config.ArgsSource.ARGS
    if config.pluginmanager.hasplugin('xdist') and whole and not in_worker():
        if config.option.numprocesses is None and config.option.dist == 'no':
            config.option.numprocesses = (os.cpu_count() or 1) + 1


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Any:
    """Keep a module, whose tests share fixtures, on one worker, and all ROS modules together."""
    from xdist.scheduler import LoadScopeScheduling

    class QueueScheduling(LoadScopeScheduling):
        """One queue for each module, and one for all that start ROS processes."""

        def _split_scope(self, nodeid: str) -> str:
            return 'ROS' if starts_ros(nodeid) else nodeid.partition('::')[0]

    config.option.loadscopereorder = False
    return QueueScheduling(config, log)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Let the longest queues start first where several processes share the tests."""
    if in_worker():
        items.sort(key=lambda item: (
            not starts_ros(item.nodeid), item.get_closest_marker('slow') is None))


def pytest_runtest_setup(item: pytest.Item) -> None:
    """Let computations give way to the ROS processes of another worker."""
    if in_worker() and not starts_ros(item.nodeid):
        os.setpriority(os.PRIO_PROCESS, 0, max(NICENESS, os.getpriority(os.PRIO_PROCESS, 0)))


@pytest.fixture
def setup_arguments(monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """Return what setup.py hands to setuptools."""
    arguments: dict[str, Any] = {}
    monkeypatch.setattr(pytest.importorskip('setuptools'), 'setup', arguments.update)
    monkeypatch.chdir(ROOT)
    runpy.run_path('setup.py')
    return arguments


@pytest.fixture
def peer(shared: Any) -> Any:
    """Return the peer that the tests of a module share, and its node, as new."""
    shared.start_afresh()
    return shared
