# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""A signal ends the threads of a node first and its ROS context last."""

from __future__ import annotations

from pathlib import Path
import subprocess
import sys

import pytest
from ros_processes import environment

pytestmark = pytest.mark.slow

NODE = """
import os, signal, sys
from contact_estimation.ros.running import run_node
from rclpy.node import Node
from std_msgs.msg import String

class Interrupted(Node):
    finished = False

    def __init__(self):
        super().__init__('interrupted')
        self.publisher = self.create_publisher(String, 'word', 1)

    def start(self):
        os.kill(os.getpid(), signal.{name})

    def stop(self):
        self.publisher.publish(String(data='last'))
        print('stopped')

sys.exit(run_node(Interrupted, 'a node', [], []))
"""


@pytest.mark.parametrize('name', ['SIGINT', 'SIGTERM'])
def test_interrupted_node_can_publish_until_it_has_stopped(tmp_path: Path, name: str) -> None:
    finished = subprocess.run(
        [sys.executable, '-c', NODE.replace('{name}', name)],
        env=environment(tmp_path), capture_output=True, text=True,
    )
    assert (finished.returncode, finished.stdout, finished.stderr) == (0, 'stopped\n', '')
