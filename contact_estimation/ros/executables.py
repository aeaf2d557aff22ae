# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
The executables of the nodes, also as `python -m contact_estimation.ros.executables NAME`.

Importing ROS takes a second or two; until the node handles signals itself, an interrupt ends the
process at once, without a traceback out of an import.
"""

from __future__ import annotations

from importlib import import_module
import os
import signal
import sys
from typing import Any, Callable, Sequence

NODES = ('estimator_node', 'managed_estimator_node', 'plant_node', 'recorder_node', 'watch_node')


def end_quietly(*_: Any) -> None:
    """End the process from a signal handler: nothing has been opened yet."""
    os._exit(0)


def _executable(name: str) -> Callable[[Sequence[str] | None], int]:
    def main(args: Sequence[str] | None = None) -> int:
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, end_quietly)
        return int(import_module(f'{__package__}.{name}').main(args))

    return main


estimator_node = _executable('estimator_node')
managed_estimator_node = _executable('managed_estimator_node')
plant_node = _executable('plant_node')
recorder_node = _executable('recorder_node')
watch_node = _executable('watch_node')

if __name__ == '__main__':
    if len(sys.argv) < 2 or sys.argv[1] not in NODES:
        print(f'expected one of {", ".join(NODES)}, got {sys.argv[1:2]}', file=sys.stderr)
        raise SystemExit(1)
    raise SystemExit(globals()[sys.argv[1]](sys.argv[2:]))
