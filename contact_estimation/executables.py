# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
The executables, also as `python -m contact_estimation NAME`.

Each imports its module only when it is called: an interruption of the import, which takes a second
or two, ends without a traceback; nodes, which have opened nothing yet, end without a word.
"""

from importlib import import_module
import os
import signal
from typing import Any, Callable

COMMANDS = {
    **{name: f'.commands.{name}' for name in (
        'calibrate_tool', 'convert', 'demonstrate', 'diagnose', 'fleet', 'loop', 'replay',
        'simulate', 'watch')},
    'blind_trials': '.studies.blind_trials.command', 'reproduce': '.studies.reproduce',
}
NODES = {name: f'.ros.{name}' for name in (
    'estimator_node', 'managed_estimator_node', 'plant_node', 'recorder_node', 'watch_node')}


def __getattr__(name: str) -> Callable[[], int]:
    """Return the function that runs an executable."""
    if name not in COMMANDS and name not in NODES:
        raise AttributeError(f'no executable {name}')

    def interrupted(*_: Any) -> None:
        if name in COMMANDS:
            os.write(2, f'{name}: interrupted\n'.encode())
        os._exit(int(name in COMMANDS))

    def main() -> int:
        if name in NODES:
            for number in (signal.SIGINT, signal.SIGTERM):
                signal.signal(number, interrupted)
            return int(import_module(NODES[name], __package__).main())
        before = signal.getsignal(signal.SIGINT)
        if before is not signal.SIG_IGN:  # as of a job in the background
            signal.signal(signal.SIGINT, interrupted)
        import_module('.commands', __package__)  # chooses the threads of numpy
        command = import_module(COMMANDS[name], __package__)
        signal.signal(signal.SIGINT, before)
        return int(command.main())

    return main
