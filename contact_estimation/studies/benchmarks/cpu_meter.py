# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""CPU load of a running process and of the machine."""

from __future__ import annotations

import os
from pathlib import Path
import time
from typing import Callable

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
        """
        Compute the mean load.

        begin_ns, end_ns: interval on the clock of `time.time_ns`, within the samples [ns]
        """
        zero = self._at_ns[0]
        at = np.array([t - zero for t in self._at_ns], float)
        before, after = np.interp([begin_ns - zero, end_ns - zero], at, self._used_s)
        return float(100.0 * (after - before) / ((end_ns - begin_ns) * 1e-9))


def process_cpu_s(pid: int) -> float:
    """
    Read the CPU time of a process.

    Returns used: user and system time of all its threads [s]
    """
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
