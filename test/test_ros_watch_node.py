# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Watching a running estimator, and the loop with a view."""

from __future__ import annotations

from itertools import count
from pathlib import Path
import signal
import subprocess
import sys

import pytest
from ros_messages import joint_state, wrench
from ros_peer import Peer
from ros_processes import node_process, wait_until

pytest.importorskip('rerun')
pytestmark = pytest.mark.slow


def paths_in(file: Path) -> str:
    """Print what a file of Rerun holds."""
    return subprocess.run([sys.executable, '-m', 'rerun', 'rrd', 'print', '-v', str(file)],
                          capture_output=True, text=True, check=True).stdout


def test_watch_node_shows_what_is_published(tmp_path: Path) -> None:
    file = tmp_path / 'view.rrd'
    peer = Peer()
    try:
        with node_process(tmp_path / 'log', 'watch_node', show=str(file)) as node:
            wait_until(file.exists, 'the view')
            before, numbers = file.stat().st_size, count(1)

            def seen() -> bool:
                stamp_ns = peer.begin_ns + 2_000_000 * next(numbers)
                peer.joints.publish(joint_state(stamp_ns, 0.001, 0.0))
                peer.wrenches.publish(wrench(stamp_ns, -5.0))
                return file.stat().st_size > before + 20_000

            wait_until(seen, 'a shown wrench')
            node.signal(signal.SIGINT)
            assert node.end().code == 0
    finally:
        peer.close()
    held = paths_in(file)
    assert '/force/measured' in held and '/motion/measured' in held
