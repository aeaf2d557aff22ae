# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Metrics of a study: percentages and medians over its scores, each with its target."""

from __future__ import annotations

from statistics import median
from typing import Callable, Iterable, NamedTuple, Sequence

from .scoring import Score

DEGREES = ((1.0, 1.6), (1.6, 2.1), (2.1, 2.9), (2.9, 4.2), (4.2, float('inf')))
"""Bins of the degree of concealment; the last holds effects that cannot be concealed."""


class Metric(NamedTuple):
    """One number of a study."""

    name: str  # meaning and unit
    value: float | None  # None where the metric applies to no trial
    samples: int  # number of trials (or parameters) covered
    limit: float | None  # required value; None: for information
    at_least: bool  # whether `limit` is a minimum, else a maximum

    @property
    def met(self) -> bool | None:
        """Whether the target is met; None without value or target."""
        if self.value is None or self.limit is None:
            return None
        return self.value >= self.limit if self.at_least else self.value <= self.limit


class _Definition(NamedTuple):
    name: str
    values: Callable[[Score], Iterable[float | None]]  # of one score; None does not count
    summarise: Callable[[Sequence[float]], float]
    limit: float | None
    at_least: bool = True


def _percentage(values: Sequence[float]) -> float:
    return 100.0 * sum(values) / len(values)


def _magnitude(value: float | None) -> list[float]:
    return [] if value is None else [abs(value)]


_DEFINITIONS = (
    _Definition('true name first or among its alternatives [%]', lambda s: [s.found],
                _percentage, 90.0),
    _Definition('true name first and alone [%]', lambda s: [s.found_alone], _percentage, 80.0),
    _Definition('with extra names [%]', lambda s: [s.extra_names], _percentage, 5.0, False),
    _Definition('false alarms in clean worlds [%]', lambda s: [s.false_alarm], _percentage,
                2.0, False),
    _Definition('median parameter error [% of the distance from no effect]',
                lambda s: s.parameter_errors.values(), median, 10.0, False),
    _Definition('held-out force error within 1.15 of the noise [%]',
                lambda s: [value <= 1.15 for value in _magnitude(s.force_ratio)], _percentage,
                85.0),
    _Definition('noise floor within 10 % [%]',
                lambda s: [value <= 10.0 for value in _magnitude(s.floor_error)], _percentage,
                100.0),
    _Definition('median error of K_e [%]', lambda s: _magnitude(s.stiffness_error), median,
                1.0, False),
    _Definition('median error of B_e [%]', lambda s: _magnitude(s.damping_error), median,
                5.0, False),
    _Definition('K_e, B_e given exactly where defined [%]', lambda s: [s.base_right],
                _percentage, 100.0),
    _Definition('verdict right [%]', lambda s: [s.verdict_right], _percentage, None),
)


def metrics(scores: Sequence[Score]) -> list[Metric]:
    """Compute all metrics."""
    result = []
    for definition in _DEFINITIONS:
        values = [float(v) for s in scores for v in definition.values(s) if v is not None]
        value = definition.summarise(values) if values else None
        result.append(
            Metric(definition.name, value, len(values), definition.limit, definition.at_least))
    return result


def confusion(scores: Sequence[Score]) -> dict[str, dict[str, int]]:
    """Count the answers to each true effect."""
    counts: dict[str, dict[str, int]] = {}
    for score in scores:
        row = counts.setdefault(score.effect or 'nothing', {})
        row[score.answer] = row.get(score.answer, 0) + 1
    return counts


def groups(scores: Sequence[Score]) -> dict[str, dict[str, list[Score]]]:
    """Group scores by effect, degree of concealment and features of the recording."""
    split: dict[str, dict[str, list[Score]]] = {'effect': {}, 'concealed': {}}
    for score in sorted(scores, key=lambda s: (s.effect, s.concealed)):
        split['effect'].setdefault(score.effect or 'nothing missing', []).append(score)
    for low, high in DEGREES:
        label = f'{low:g} to {high:g} times' if high < float('inf') else f'beyond {low:g} times'
        part = [s for s in scores if s.effect and low <= s.concealed < high]
        if part:
            split['concealed'][label] = part
    for score in scores:
        for feature, value in score.features.items():
            split.setdefault(feature, {}).setdefault(value, []).append(score)
    return split
