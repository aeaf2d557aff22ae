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

"""Calibration of the probabilities that `diagnose` reports, on worlds of foreign laws."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from .family_scoring import FamilyScore
from ..diagnosis.conclude.probability import evidence_of
from ..figures import BLUE, figure_style, GREY, MUTED, require_matplotlib

Array = NDArray[np.float64]

PROBABILITY_EDGES = (0.0, 0.5, 0.7, 0.8, 0.9, 1.0)
"""Edges of the five bins of the reliability table."""

_PRIOR = 1.0  # right and wrong names added, so that names that are all right have a finite fit


class Reliability(NamedTuple):
    """
    One bin of the reliability table.

    Attributes
    ----------
    low, high : float
        Range of the reported probability; the last bin includes its end.
    names : int
        Number of names given with such a probability.
    mean : float or None
        Mean probability given; None without names.
    share_right : float or None
        Share of the names of an acceptable family.

    """

    low: float
    high: float
    names: int
    mean: float | None
    share_right: float | None


def reliability(scores: Sequence[FamilyScore]) -> list[Reliability]:
    """
    Compare reported probabilities with the share of right names.

    Parameters
    ----------
    scores : sequence of FamilyScore
        Scores of a study. All names count, those of clean and unknown worlds as wrong.

    Returns
    -------
    table : list of Reliability
        One row for each bin.

    """
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


def fit_curve(scores: Sequence[FamilyScore]) -> tuple[float, float]:
    """
    Fit the curve of `diagnosis.conclude.probability` to the names of a study.

    Parameters
    ----------
    scores : sequence of FamilyScore
        With at least one name.

    Returns
    -------
    even, slope : float
        Of the logistic curve that makes the outcomes likeliest (Platt 1999). The evidence is what
        the present curve made the reported probabilities of; where that is cut off, so is this.

    """
    evidence, right = (np.array(column, float) for column in zip(*_given(scores)))
    evidence = evidence_of(evidence)

    def unlikelihood(values: Array) -> float:
        argument = values[1] * (evidence - values[0])
        losses = np.where(right > 0.5, np.logaddexp(0.0, -argument), np.logaddexp(0.0, argument))
        ends = values[1] * (np.array([0.0, 1.0]) - values[0])
        prior = np.logaddexp(0.0, ends[0]) + np.logaddexp(0.0, -ends[1])
        return float(losses.sum() + _PRIOR * prior)

    even, slope = minimize(unlikelihood, [0.3, 5.0], method='Nelder-Mead').x.tolist()
    return even, slope


def calibration_text(scores: Sequence[FamilyScore]) -> str:
    """
    Format the reliability table, and the curve that would fit these names.

    Parameters
    ----------
    scores : sequence of FamilyScore
        Scores of a study.

    Returns
    -------
    text : str
        A line for each bin.

    """
    lines = ['probability given       names     mean    right']
    for row in reliability(scores):
        shown = ['       -' if value is None else f'{value:>8.2f}'
                 for value in (row.mean, row.share_right)]
        lines.append(f'  {row.low:.1f} to {row.high:.1f}{row.names:>18}{shown[0]} {shown[1]}')
    if _given(scores):
        even, slope = fit_curve(scores)
        lines.append(f'  likeliest curve: EVEN, SLOPE = {even:.2f}, {slope:.1f}')
    return '\n'.join(lines)


@figure_style()
def plot_reliability(scores: Sequence[FamilyScore], path: Path) -> Path:
    """
    Plot how often names of a reported probability are right.

    Parameters
    ----------
    scores : sequence of FamilyScore
        Scores of a study.
    path : Path
        PNG file to write.

    Returns
    -------
    path : Path
        The same.

    """
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
