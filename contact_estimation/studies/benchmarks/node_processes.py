# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Processes of nodes in a ROS domain of the benchmark's own."""

from __future__ import annotations

import os
import subprocess
import sys
from typing import Sequence

from ...ros.loop_processes import end_process

_TIMEOUT_S = 5.0


def own_domain() -> dict[str, str]:
    """Return the environment of processes in a ROS domain free of other traffic."""
    return {
        **os.environ,
        'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST',
        'ROS_DOMAIN_ID': str(1 + os.getpid() % 100),
    }


def start_node(
    module: str, parameters: list[str], remappings: Sequence[str] = ()
) -> subprocess.Popen[bytes]:
    """Start a node in the benchmark's own ROS domain, free of other traffic."""
    options = [word for parameter in parameters for word in ('-p', parameter)]
    options += [word for remapping in remappings for word in ('-r', remapping)]
    return subprocess.Popen(
        [sys.executable, '-m', module, '--ros-args', *options],
        env=own_domain(), start_new_session=True, stdout=subprocess.DEVNULL,
    )


def end_node(process: subprocess.Popen[bytes], timeout_s: float = _TIMEOUT_S) -> None:
    """
    Interrupt a node, or a loop of nodes, and wait; kill it after a time-out.

    timeout_s: time from the interrupt to the kill [s]
    """
    end_process(process, timeout_s)
