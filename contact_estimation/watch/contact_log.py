# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Values and texts of a contact, collected until a view takes them."""

from __future__ import annotations

from math import isfinite, nan
from typing import Mapping, NamedTuple

INFO, WARNING = 'INFO', 'WARN'
STATUS, CHECKS = 'log/status', 'log/checks'
_AS_EXPECTED = ('free', 'estimating')


class LogText(NamedTuple):
    """A text with its level."""

    path: str  # `STATUS` or `CHECKS`
    stamp_ns: int  # when [ns]
    # text, level: what, and `INFO` or `WARNING`
    text: str
    level: str


class ContactLog:
    """
    Values and texts since the last time that they were taken.

    values: stamps [ns] and values by keys of plot and curve, as in 'force/measured'
    """

    def __init__(self) -> None:
        self.values: dict[str, tuple[list[int], list[float]]] = {}
        self.texts: list[LogText] = []
        self._status, self._checks = '', dict[str, str]()

    def add(self, path: str, stamp_ns: int, value: float) -> None:
        """
        Add one value of a curve.

        stamp_ns: when [ns]
        value: in the unit of the plot; what is not finite leaves a gap
        """
        stamps, values = self.values.setdefault(path, ([], []))
        stamps.append(stamp_ns)
        values.append(value if isfinite(value) else nan)

    def add_estimate(self, key: str, stamp_ns: int, value: float, std: float) -> None:
        """
        Add an estimate and its band of 2 standard deviations.

        stamp_ns: when [ns]
        value, std: estimate and standard deviation; NaN while unknown
        """
        self.add(f'{key}/estimate', stamp_ns, value)
        # A band wider than the value says that nothing is known yet, and would flatten the plot.
        band = 2.0 * std if 2.0 * std < abs(value) else nan
        self.add(f'{key}/upper', stamp_ns, value + band)
        self.add(f'{key}/lower', stamp_ns, value - band)

    def add_status(self, stamp_ns: int, text: str) -> None:
        """
        Add the state of the estimator where it has changed.

        stamp_ns: when [ns]
        """
        if text != self._status:
            self._status = text
            level = INFO if text.startswith(_AS_EXPECTED) else WARNING
            self.texts.append(LogText(STATUS, stamp_ns, text, level))

    def add_checks(self, stamp_ns: int, active: Mapping[str, str]) -> None:
        """
        Add which warnings have begun or ended.

        stamp_ns: when [ns]
        active: texts of the active warnings, by what stays the same while their numbers change
        """
        for key, text in active.items():
            if key not in self._checks:
                self.texts.append(LogText(CHECKS, stamp_ns, text, WARNING))
        for key, text in self._checks.items():
            if key not in active:
                self.texts.append(LogText(CHECKS, stamp_ns, f'over: {text}', INFO))
        self._checks = dict(active)

    def take(self) -> tuple[dict[str, tuple[list[int], list[float]]], list[LogText]]:
        """Return `values` and `texts`, and begin anew."""
        taken = self.values, self.texts
        self.values, self.texts = {}, []
        return taken
