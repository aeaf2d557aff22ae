# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The processes of the loop: started together, stopped in order."""

from __future__ import annotations

import importlib.util
import os
from pathlib import Path
import signal
import subprocess
import sys
import time
from typing import Callable

from ..exceptions import MissingPackageError

_POLL_S = 0.05
_TIMEOUT_S = 10.0


class LoopProcesses:
    """
    Plant, estimator and recorder, each in its own process.

    Each process has its own session, so that Ctrl-C reaches only the loop, which then stops them
    in order: the recorder last, when no more messages arrive.
    """

    def __init__(self, parameters: Path) -> None:
        # Their matrices are small: a second thread of the linear algebra would only wait.
        environment = {'OMP_NUM_THREADS': '1', **os.environ,
                       'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST'}
        self._processes = {
            name: subprocess.Popen(
                [sys.executable, '-m', 'contact_estimation.ros.executables', name, '--ros-args',
                 '--log-level', 'error', '--params-file', str(parameters)],
                env=environment, start_new_session=True, stdout=subprocess.DEVNULL,
            )
            for name in ('recorder_node', 'estimator_node', 'plant_node')
        }

    def run(self, duration: float, report_progress: Callable[[float], None]) -> str:
        """
        Wait until the plant has finished, then stop the others.

        duration: expected length of the run [s]
        """
        signal.signal(signal.SIGTERM, signal.default_int_handler)
        try:
            failure = self._wait(duration, report_progress)
        except KeyboardInterrupt:
            failure = 'interrupted; the recording ends at the interruption'
        finally:
            # A second Ctrl-C must not orphan the nodes, which would interfere with the next run.
            for number in (signal.SIGINT, signal.SIGTERM):
                signal.signal(number, signal.SIG_IGN)
            killed = [name for name in ('plant_node', 'estimator_node', 'recorder_node')
                      if not end_process(self._processes[name], _TIMEOUT_S)]
        if killed and not failure:
            failure = f'{", ".join(killed)} did not end when interrupted and had to be killed'
        return failure

    def _wait(self, duration: float, report_progress: Callable[[float], None]) -> str:
        begin = time.monotonic()
        while True:
            for name, process in self._processes.items():
                code = process.poll()
                if name == 'plant_node' and code == 0:
                    return ''
                if code is not None:
                    return f'{name} ended with {_code_text(code)} before the experiment did'
            time.sleep(_POLL_S)
            report_progress(min((time.monotonic() - begin) / (duration + 2.0), 1.0))


def end_process(process: subprocess.Popen[bytes], timeout_s: float) -> bool:
    """
    Interrupt a process and wait for its end; kill it after a time-out.

    timeout_s: time from the interrupt to the kill [s]
    """
    if process.poll() is None:
        process.send_signal(signal.SIGINT)
    try:
        process.wait(timeout_s)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
        return False
    return True


def require_rclpy(command: str) -> None:
    """Check that rclpy is installed."""
    if importlib.util.find_spec('rclpy') is None:
        raise MissingPackageError(
            f'{command} needs ROS 2 (rclpy), which this Python does not have; source your ROS '
            "installation, or install its wheels, in this project's folder: pip install '.[ros]'"
        )


def _code_text(code: int) -> str:
    return f'signal {signal.Signals(-code).name}' if code < 0 else f'exit code {code}'
