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

"""The processes of the loop: started together, ended in order."""

from __future__ import annotations

import os
from pathlib import Path
import signal
import subprocess
import sys
import time

from .progress import Progress

_POLL_S = 0.05
_PATIENCE_S = 10.0


class LoopProcesses:
    """
    Plant, estimator and recorder, each a process of its own.

    Each has a session of its own, so that Ctrl-C reaches only the loop, which then ends them in
    the right order: the recorder last, when nothing comes any more.

    Parameters
    ----------
    parameters : Path
        ROS 2 parameter file for all of them.

    """

    def __init__(self, parameters: Path) -> None:
        arguments = {
            'recorder_node': ['--params-file', str(parameters)],
            'estimator_node': ['--params-file', str(parameters)],
            'plant_node': ['--params-file', str(parameters)],
        }
        environment = {**os.environ, 'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST'}
        self._processes = {
            name: subprocess.Popen(
                [sys.executable, '-m', f'contact_estimation.ros.{name}', '--ros-args', *given],
                env=environment, start_new_session=True, stdout=subprocess.DEVNULL,
            )
            for name, given in arguments.items()
        }

    def run(self, duration: float) -> str:
        """
        Wait until the plant has finished, then end the others.

        Parameters
        ----------
        duration : float
            Expected time, for the progress [s].

        Returns
        -------
        failure : str
            What went wrong; '' where nothing did.

        """
        signal.signal(signal.SIGTERM, signal.default_int_handler)
        try:
            failure = self._wait(duration)
        except KeyboardInterrupt:
            failure = 'interrupted; the recording holds what was run until then'
        finally:
            # Impatience must not orphan the nodes, which would answer the next run.
            for number in (signal.SIGINT, signal.SIGTERM):
                signal.signal(number, signal.SIG_IGN)
            stubborn = [name for name in ('plant_node', 'estimator_node', 'recorder_node')
                        if not self._end(name)]
        if stubborn and not failure:
            failure = f'{", ".join(stubborn)} did not end by itself and was killed'
        return failure

    def _wait(self, duration: float) -> str:
        progress, begin = Progress('loop'), time.monotonic()
        try:
            while True:
                for name, process in self._processes.items():
                    code = process.poll()
                    if name == 'plant_node' and code == 0:
                        return ''
                    if code is not None:
                        return f'{name} ended with {_code_text(code)} before the experiment did'
                time.sleep(_POLL_S)
                progress.show(min((time.monotonic() - begin) / (duration + 2.0), 1.0))
        finally:
            progress.done()

    def _end(self, name: str) -> bool:
        """Interrupt a process and wait; kill it where that does not help."""
        process = self._processes[name]
        if process.poll() is None:
            process.send_signal(signal.SIGINT)
        try:
            process.wait(_PATIENCE_S)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
            return False
        return True


def _code_text(code: int) -> str:
    return f'signal {signal.Signals(-code).name}' if code < 0 else f'exit code {code}'
