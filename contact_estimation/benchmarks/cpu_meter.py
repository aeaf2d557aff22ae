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

"""CPU time of a running process and of the machine, against the wall clock."""

from __future__ import annotations

import os
from pathlib import Path
import time
from typing import Callable

import numpy as np

_TICKS_PER_S = os.sysconf('SC_CLK_TCK')


class CpuMeter:
    """
    Note now and then how much was used, and tell the share of any interval afterwards.

    Parameters
    ----------
    used_s : callable
        CPU time up to now [s].

    """

    def __init__(self, used_s: Callable[[], float]) -> None:
        self._read = used_s
        self._at_ns: list[int] = []
        self._used_s: list[float] = []

    def sample(self) -> None:
        """Note what was used up to now; no news of a process that has ended."""
        try:
            used_s = self._read()
        except OSError:
            return
        self._at_ns.append(time.time_ns())
        self._used_s.append(used_s)

    def percent(self, begin_ns: int, end_ns: int) -> float:
        """
        Compute the share of one core.

        Parameters
        ----------
        begin_ns, end_ns : int
            Interval on the clock of `time.time_ns`, within the samples [ns].

        Returns
        -------
        share : float
            Mean over the interval [%].

        """
        zero = self._at_ns[0]
        at = np.array([t - zero for t in self._at_ns], float)
        before, after = np.interp([begin_ns - zero, end_ns - zero], at, self._used_s)
        return float(100.0 * (after - before) / ((end_ns - begin_ns) * 1e-9))


def process_cpu_s(pid: int) -> float:
    """
    Read what a process has used.

    Parameters
    ----------
    pid : int
        Of the process.

    Returns
    -------
    used : float
        User and system time of all its threads [s].

    """
    fields = Path(f'/proc/{pid}/stat').read_text().rpartition(')')[2].split()
    return (int(fields[11]) + int(fields[12])) / _TICKS_PER_S


def machine_cpu_s() -> float:
    """
    Read what all processes, the kernel and other guests have used of the cores.

    Told by the idle time, which is exact: the busy times of /proc/stat are counted at clock
    ticks, with which a node that wakes every 2 ms keeps step.

    Returns
    -------
    used : float
        Time of all cores since an arbitrary instant [s].

    """
    with open('/proc/stat') as stat:
        idle, waiting = stat.readline().split()[4:6]
    return (os.cpu_count() or 1) * time.monotonic() - (int(idle) + int(waiting)) / _TICKS_PER_S
