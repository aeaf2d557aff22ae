# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
The executables that need no ROS.

Each imports its command only when it is called: an interruption of the import, which takes most of
a second, ends without a traceback.
"""

from __future__ import annotations

from importlib import import_module
import os
import signal
from typing import Any, Callable


def _entry_point(name: str, module: str = '') -> Callable[[], int]:
    def interrupted(*_: Any) -> None:
        os.write(2, f'{name}: interrupted\n'.encode())
        os._exit(1)

    def entry_point() -> int:
        before = signal.getsignal(signal.SIGINT)
        if before is not signal.SIG_IGN:  # as of a job in the background
            signal.signal(signal.SIGINT, interrupted)  # no traceback out of an import
        command = import_module(module or f'.{name}', __package__)
        signal.signal(signal.SIGINT, before)
        return int(command.main())

    return entry_point


blind_trials = _entry_point('blind_trials', '..studies.blind_trials.command')
calibrate_tool = _entry_point('calibrate_tool')
convert = _entry_point('convert')
demonstrate = _entry_point('demonstrate')
diagnose = _entry_point('diagnose')
fleet = _entry_point('fleet')
loop = _entry_point('loop')
replay = _entry_point('replay')
reproduce = _entry_point('reproduce', '..studies.reproduce')
simulate = _entry_point('simulate')
watch = _entry_point('watch')
