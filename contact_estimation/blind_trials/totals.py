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

"""All scores together: shares, medians, and the marks they are held against."""

from __future__ import annotations

from statistics import median
from typing import Callable, Iterable, NamedTuple, Sequence

from .scoring import Score

DEGREES = ((1.0, 1.6), (1.6, 2.1), (2.1, 2.9), (2.9, 4.2), (4.2, float('inf')))
"""Bins of concealment; the last holds what no magnitude conceals."""

_FORCE_RATIO, _FLOOR_ERROR, _HALF = 1.15, 10.0, 0.5


class Total(NamedTuple):
    """
    One number of a study.

    Attributes
    ----------
    name : str
        What it is.
    value : float or None
        None where no trial tells.
    told : int
        Trials (or parameters) that tell.
    mark : float or None
        To be reached, or not to be passed; None: for information.
    at_least : bool
        Whether the mark is a floor.

    """

    name: str
    value: float | None
    told: int
    mark: float | None
    at_least: bool

    @property
    def met(self) -> bool | None:
        """Whether the mark is met."""
        if self.value is None or self.mark is None:
            return None
        return self.value >= self.mark if self.at_least else self.value <= self.mark


class _Question(NamedTuple):
    """What is asked of every trial, and the mark."""

    name: str
    ask: Callable[[Score], Iterable[float]]
    summarise: Callable[[Sequence[float]], float]
    mark: float | None
    at_least: bool = True


def _share(values: Sequence[float]) -> float:
    return 100.0 * sum(values) / len(values)


def _known(*values: float | None) -> list[float]:
    return [float(value) for value in values if value is not None]


def _parameters(score: Score) -> list[float]:
    return list(score.parameter_errors.values())


def _stiffness(score: Score) -> list[float]:
    return [abs(value) for value in _known(score.stiffness_error)]


def _damping(score: Score) -> list[float]:
    return [abs(value) for value in _known(score.damping_error)]


def is_recognised(score: Score) -> bool:
    """
    Tell whether what is outside the library was called so, in the right place.

    Parameters
    ----------
    score : Score
        Of a report.

    Returns
    -------
    recognised : bool
        Unexplained, without a name, at the right port, half of the time that was told or is true.

    """
    overlap = score.overlap
    return bool(score.unnamed and score.port_right and overlap is not None and overlap >= _HALF)


_QUESTIONS = (
    _Question('true name first or among its rivals [%]', lambda s: _known(s.named), _share,
              90.0, True),
    _Question('true name first and alone [%]', lambda s: _known(s.alone), _share, 80.0, True),
    _Question('with surplus names [%]', lambda s: _known(s.surplus), _share, 5.0, False),
    _Question('clean worlds accused [%]', lambda s: _known(s.accused), _share, 2.0, False),
    _Question('median parameter error [% of the departure]', _parameters, median, 10.0, False),
    _Question('held-out force error within 1.15 of the noise [%]',
              lambda s: [value <= _FORCE_RATIO for value in _known(s.force_ratio)], _share,
              85.0, True),
    _Question('noise floor within 10 % [%]',
              lambda s: [abs(value) <= _FLOOR_ERROR for value in _known(s.floor_error)], _share,
              100.0, True),
    _Question('median error of K_e [%]', _stiffness, median, 1.0, False),
    _Question('median error of B_e [%]', _damping, median, 5.0, False),
    _Question('K_e, B_e given or withheld rightly [%]', lambda s: _known(s.base_right), _share,
              100.0, True),
    _Question('outside the library: unexplained, no name [%]', lambda s: _known(s.unnamed), _share,
              None),
    _Question('outside the library: right port [%]', lambda s: _known(s.port_right), _share,
              None),
    _Question('outside the library: intervals share half [%]',
              lambda s: [value >= _HALF for value in _known(s.overlap)], _share, None),
    _Question('outside the library: all three [%]',
              lambda s: [is_recognised(s)] if s.outside else [], _share, 80.0, True),
    _Question('verdict right [%]', lambda s: [s.verdict_right], _share, None),
)


def totals(scores: Sequence[Score]) -> list[Total]:
    """
    Sum up.

    Parameters
    ----------
    scores : sequence of Score
        All or some of a study.

    Returns
    -------
    totals : list of Total
        One a question.

    """
    result = []
    for question in _QUESTIONS:
        answers = [answer for score in scores for answer in question.ask(score)]
        value = question.summarise(answers) if answers else None
        result.append(Total(question.name, value, len(answers), question.mark, question.at_least))
    return result


def confusion(scores: Sequence[Score]) -> dict[str, dict[str, int]]:
    """
    Count what was said of what.

    Parameters
    ----------
    scores : sequence of Score
        All or some of a study.

    Returns
    -------
    counts : dict of str to dict of str to int
        True name to first name said; 'nothing' for none missing, 'unexplained' and 'failed'.

    """
    counts: dict[str, dict[str, int]] = {}
    for score in scores:
        row = counts.setdefault(score.effect or 'nothing', {})
        row[answer_of(score)] = row.get(answer_of(score), 0) + 1
    return counts


def answer_of(score: Score) -> str:
    """
    Say in one word what a report said.

    Parameters
    ----------
    score : Score
        Of the report.

    Returns
    -------
    answer : str
        First name, else 'unexplained', 'failed' or 'nothing'.

    """
    if not score.verdict:
        return 'failed'
    if score.said:
        return score.said[0]
    return 'unexplained' if score.verdict == 'unexplained' else 'nothing'


def groups(scores: Sequence[Score]) -> dict[str, dict[str, list[Score]]]:
    """
    Split a study by what may matter.

    Parameters
    ----------
    scores : sequence of Score
        Of the study.

    Returns
    -------
    groups : dict of str to dict of str to list of Score
        By effect, degree of concealment and every feature of the recording.

    """
    split: dict[str, dict[str, list[Score]]] = {'effect': {}, 'concealed': {}}
    for score in sorted(scores, key=lambda s: (s.effect, s.concealed)):
        _into(split, 'effect', score.effect or 'nothing missing', score)
    for low, high in DEGREES:
        label = f'{low:g} to {high:g} times' if high < float('inf') else f'beyond {low:g} times'
        for score in scores:
            if score.effect and low <= score.concealed < high:
                _into(split, 'concealed', label, score)
    for score in scores:
        for feature, value in score.features.items():
            _into(split, feature, value, score)
    return split


def _into(
    split: dict[str, dict[str, list[Score]]], kind: str, label: str, score: Score
) -> None:
    split.setdefault(kind, {}).setdefault(label, []).append(score)


def is_miss(score: Score) -> bool:
    """
    Tell whether a report deserves a look.

    Parameters
    ----------
    score : Score
        Of the report.

    Returns
    -------
    miss : bool
        Wrong or several names, an accusation, a rest unexplained though the effect is in the
        library, or no report.

    """
    return (bool(score.error) or score.named is False or bool(score.surplus)
            or bool(score.accused) or bool(score.effect and not score.verdict_right)
            or (score.outside and not is_recognised(score)))
