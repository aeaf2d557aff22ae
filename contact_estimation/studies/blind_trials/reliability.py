# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""How often names of a reported probability are right."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple, Sequence

import numpy as np

from .family_scoring import FamilyScore
from ...figures import BLUE, figure_style, GREY, MUTED, require_matplotlib

PROBABILITY_EDGES = (0.0, 0.5, 0.7, 0.8, 0.9, 1.0)
"""Edges of the five bins of the reliability table."""


class Reliability(NamedTuple):
    """One bin of the reliability table."""

    # low, high: range of the reported probability; the last bin includes its end
    low: float
    high: float
    names: int  # number of names given with such a probability
    mean: float | None  # mean probability given; None without names
    share_right: float | None  # share of the names of an acceptable family


def reliability(scores: Sequence[FamilyScore]) -> list[Reliability]:
    """Compare reported probabilities with the share of right names."""
    given = _given(scores)
    table = []
    for low, high in zip(PROBABILITY_EDGES[:-1], PROBABILITY_EDGES[1:]):
        part = [(p, right) for p, right in given
                if low <= p < high or p == high == PROBABILITY_EDGES[-1]]
        count = len(part)
        means = [sum(column) / count for column in zip(*part)] if part else [None, None]
        table.append(Reliability(low, high, count, *means))
    return table


def _given(scores: Sequence[FamilyScore]) -> list[tuple[float, bool]]:
    return [(named.probability, named.right) for score in scores for named in score.names]


def calibration_text(scores: Sequence[FamilyScore]) -> str:
    """Format the reliability table."""
    lines = ['probability given       names     mean    right']
    for row in reliability(scores):
        shown = ['       -' if value is None else f'{value:>8.2f}'
                 for value in (row.mean, row.share_right)]
        lines.append(f'  {row.low:.1f} to {row.high:.1f}{row.names:>18}{shown[0]} {shown[1]}')
    return '\n'.join(lines)


@figure_style()
def plot_reliability(scores: Sequence[FamilyScore], path: Path) -> Path:
    """Plot how often names of a reported probability are right."""
    figure, axis = require_matplotlib().subplots(figsize=(4.2, 4.0))
    axis.plot([0.0, 1.0], [0.0, 1.0], color=MUTED, lw=1.0)
    axis.fill_between([0.0, 1.0], [-0.1, 0.9], [0.1, 1.1], color=GREY, alpha=0.12, lw=0.0,
                      label='within 0.1')
    for row in reliability(scores):
        if row.mean is not None and row.share_right is not None:
            # The interval of a share of so few (Wilson 1927).
            low, high = _wilson(row.share_right, row.names)
            axis.plot([row.mean, row.mean], [low, high], color=BLUE, lw=1.5)
            axis.plot(row.mean, row.share_right, 'o', color=BLUE, ms=6.0)
            axis.annotate(str(row.names), (row.mean, high), (0.0, 3.0), ha='center', fontsize=8,
                          textcoords='offset points')
    axis.set(xlim=(0.0, 1.02), ylim=(0.0, 1.1), xlabel='probability reported (mean of the bin)',
             ylabel='share of names of a right family')
    axis.set_title('number of names above each interval of 95 %')
    axis.legend(loc='upper left')
    figure.savefig(path)
    require_matplotlib().close(figure)
    return path


def _wilson(share: float, count: int) -> tuple[float, float]:
    z = 1.96
    middle = (share + z**2 / (2 * count)) / (1.0 + z**2 / count)
    reach = z * np.sqrt(share * (1.0 - share) / count + (z / (2 * count)) ** 2) / (
        1.0 + z**2 / count)
    return float(middle - reach), float(middle + reach)
