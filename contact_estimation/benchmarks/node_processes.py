# Copyright 2026 contact_estimation authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""Nodes as processes in a ROS domain of their own."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from typing import Sequence

_TIMEOUT_S = 5.0


def start_node(
    module: str, parameters: list[str], remappings: Sequence[str] = ()
) -> subprocess.Popen[bytes]:
    """
    Start a node in the benchmark's own ROS domain, free of other traffic.

    Parameters
    ----------
    module : str
        Python module of the node.
    parameters : list of str
        ROS parameters as NAME:=VALUE.
    remappings : sequence of str
        Topics as FROM:=TO.

    Returns
    -------
    process : subprocess.Popen
        Running process.

    """
    options = [word for parameter in parameters for word in ('-p', parameter)]
    options += [word for remapping in remappings for word in ('-r', remapping)]
    environment = {
        **os.environ,
        'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST',
        'ROS_DOMAIN_ID': str(1 + os.getpid() % 100),
    }
    return subprocess.Popen(
        [sys.executable, '-m', module, '--ros-args', *options],
        env=environment, start_new_session=True, stdout=subprocess.DEVNULL,
    )


def end_node(process: subprocess.Popen[bytes]) -> None:
    """
    Interrupt a node and wait; kill it after a timeout.

    Parameters
    ----------
    process : subprocess.Popen
        Process, running or ended.

    """
    if process.poll() is None:
        process.send_signal(signal.SIGINT)
    try:
        process.wait(_TIMEOUT_S)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
