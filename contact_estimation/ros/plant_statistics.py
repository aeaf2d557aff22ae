# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Samples sent, and the latency of the references received."""

import time
from typing import Any, Sequence

import numpy as np


def percentiles(values: Sequence[float]) -> dict[str, float | None]:
    """Return median, 99th percentile and maximum."""
    names = 'p50', 'p99', 'max'
    if not values:
        return dict.fromkeys(names)
    return dict(zip(names, np.percentile(values, (50, 99, 100), method='higher').tolist()))


class PlantStatistics:
    """Count samples, and the references with the stamps after theirs, by latency from sending."""

    def __init__(self, period_ns: int) -> None:
        self._period_ns = period_ns
        self.begin_ns = 0
        self.unusable = 0
        self._sent: list[int] = []
        self._delays: dict[int, int] = {}
        self._newest = -1
        self._last_contact: int | None = None

    def sent(self, k: int, true_force: float) -> None:
        """Note that a sample is being sent; true_force: F_e before the sensor [N]."""
        self._sent.append(time.perf_counter_ns())
        if true_force < 0.0:
            self._last_contact = k

    def answered(self, reference_stamp_ns: int) -> None:
        """Note the arrival of a reference, which is to be followed from its stamp on [ns]."""
        now = time.perf_counter_ns()
        k = round((reference_stamp_ns - self.begin_ns) / self._period_ns) - 1
        if 0 <= k < len(self._sent) and k not in self._delays:
            self._delays[k] = now - self._sent[k]
            self._newest = max(self._newest, k)

    def has_answer(self, k: int) -> bool:
        """Return whether sample k, or a later one, has been answered."""
        return k <= self._newest

    def summary(self) -> dict[str, Any]:
        """Return the statistics."""
        count = len(self._sent)
        spent = (self._sent[-1] - self._sent[0]) * 1e-9 if count > 1 else 0.0
        last = self._last_contact
        return {
            'samples_sent': count,
            'samples_lost': count - len(self._delays),
            'samples_late': sum(d > 2 * self._period_ns for d in self._delays.values()),
            'rate_hz': (count - 1) / spent if spent > 0.0 else None,
            'latency_ms': percentiles([d * 1e-6 for d in self._delays.values()]),
            'references_unusable': self.unusable,
            'begin_stamp_ns': self.begin_ns,
            'last_contact_stamp_ns':
                None if last is None else self.begin_ns + last * self._period_ns,
        }
