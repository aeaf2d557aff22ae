# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Run time and memory of a command."""

from __future__ import annotations

import os
from pathlib import Path
import subprocess
from tempfile import TemporaryFile
import time
from typing import NamedTuple, Sequence

from ...exceptions import ContactEstimationError

_SAMPLING_S = 0.02


class Cost(NamedTuple):
    """Resources used by a command."""

    # wall_s, cpu_s: elapsed time, and user plus system time [s]
    wall_s: float
    cpu_s: float
    peak_mb: float  # peak resident memory [MB]
    text: str  # standard output


def run_timed(command: Sequence[str]) -> Cost:
    """
    Run a command and measure time and memory.

    The peak memory is VmHWM, since ru_maxrss of wait4 includes the memory of the forking
    process.
    """
    with TemporaryFile('w+') as output:
        begin = time.perf_counter()
        process = subprocess.Popen(command, stdout=output)
        peak_kb, pid = 0, 0
        try:
            while not pid:
                peak_kb = max(peak_kb, _peak_kb(process.pid))
                time.sleep(_SAMPLING_S)
                pid, status, used = os.wait4(process.pid, os.WNOHANG)
        except BaseException:
            process.kill()
            process.wait()
            raise
        wall_s = time.perf_counter() - begin
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode:
            raise ContactEstimationError(f'{" ".join(command)} ended with {process.returncode}')
        output.seek(0)
        return Cost(wall_s, used.ru_utime + used.ru_stime, peak_kb * 1e-3, output.read())


def _peak_kb(pid: int) -> int:
    try:
        lines = Path(f'/proc/{pid}/status').read_text().splitlines()
    except OSError:
        return 0
    return next((int(line.split()[1]) for line in lines if line.startswith('VmHWM')), 0)
