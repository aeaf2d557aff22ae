# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""CPU load, run time and memory of processes, and results as text tables."""

from __future__ import annotations

import os
from pathlib import Path
import subprocess
from tempfile import TemporaryFile
import time
from typing import Any, Callable, Mapping, NamedTuple, Sequence

import numpy as np

_TICKS_PER_S = os.sysconf('SC_CLK_TCK')


class CpuMeter:
    """
    Record samples of a CPU time, and compute the mean load over any interval.

    used_s: returns the CPU time used so far [s]
    """

    def __init__(self, used_s: Callable[[], float]) -> None:
        self._read = used_s
        self._at_ns: list[int] = []
        self._used_s: list[float] = []

    def sample(self) -> None:
        """Record a sample; a process that has ended gives none."""
        try:
            used_s = self._read()
        except OSError:
            return
        self._at_ns.append(time.time_ns())
        self._used_s.append(used_s)

    def percent(self, begin_ns: int, end_ns: int) -> float:
        """Compute the mean load in an interval on the clock of `time.time_ns`."""
        zero = self._at_ns[0]
        at = np.array([t - zero for t in self._at_ns], float)
        before, after = np.interp([begin_ns - zero, end_ns - zero], at, self._used_s)
        return float(100.0 * (after - before) / ((end_ns - begin_ns) * 1e-9))


def process_cpu_s(pid: int) -> float:
    """Read the user and system time of all threads of a process [s]."""
    fields = Path(f'/proc/{pid}/stat').read_text().rpartition(')')[2].split()
    return (int(fields[11]) + int(fields[12])) / _TICKS_PER_S


def machine_cpu_s() -> float:
    """
    Read the busy time of all cores: processes, kernel and other guests.

    Computed from the idle time, which is exact. The busy times of /proc/stat are sampled at
    clock ticks, to which a node that wakes every 2 ms is synchronised.

    Returns used: busy time since an arbitrary instant [s]
    """
    with open('/proc/stat') as stat:
        idle, waiting = stat.readline().split()[4:6]
    return (os.cpu_count() or 1) * time.monotonic() - (int(idle) + int(waiting)) / _TICKS_PER_S


_SAMPLING_S = 0.02


class Cost(NamedTuple):
    """Resources used by a command."""

    # wall_s, cpu_s: elapsed time, and user plus system time [s]
    wall_s: float
    cpu_s: float
    peak_mb: float  # peak resident memory [MB]
    text: str  # standard output
    error: str  # last line on stderr of a command that failed; '' on success


def run_timed(command: Sequence[str]) -> Cost:
    """
    Run a command and measure time and memory.

    The peak memory is VmHWM, since ru_maxrss of wait4 includes the memory of the forking
    process.
    """
    with TemporaryFile('w+') as output, TemporaryFile('w+') as errors:
        begin = time.perf_counter()
        process = subprocess.Popen(
            command, stdin=subprocess.DEVNULL, stdout=output, stderr=errors)
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
        for stream in (output, errors):
            stream.seek(0)
        lines = errors.read().strip().splitlines() or [f'exit code {process.returncode}']
        return Cost(wall_s, used.ru_utime + used.ru_stime, peak_kb * 1e-3, output.read(),
                    lines[-1] if process.returncode else '')


def _peak_kb(pid: int) -> int:
    try:
        lines = Path(f'/proc/{pid}/status').read_text().splitlines()
    except OSError:
        return 0
    return next((int(line.split()[1]) for line in lines if line.startswith('VmHWM')), 0)


def print_table(title: str, rows: Sequence[Mapping[str, Any]]) -> None:
    """Print rows that share their columns."""
    names = list(rows[0])
    lines = [names, *([_text(row[name]) for name in names] for row in rows)]
    widths = [max(map(len, column)) for column in zip(*lines)]
    print(f'\n{title}')
    for line in lines:
        print('  ' + '  '.join(f'{text:>{width}}' for text, width in zip(line, widths)))


def _text(value: Any) -> str:
    if value is None:
        return '-'
    return f'{value:.4g}' if isinstance(value, float) else str(value)
