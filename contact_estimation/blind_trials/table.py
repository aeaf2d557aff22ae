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

"""A study as text."""

from __future__ import annotations

from typing import Sequence

from .scoring import Score
from .totals import answer_of, groups, is_miss, Total, totals

_COLUMNS = ('trials', 'named', 'alone', 'surplus', 'accused', 'param.', 'force', 'floor', 'K_e',
            'B_e')


def as_text(scores: Sequence[Score], where: str) -> str:
    """
    Write the table.

    Parameters
    ----------
    scores : sequence of Score
        Of the study.
    where : str
        Folder of the recordings.

    Returns
    -------
    text : str
        Totals with their marks, groups, misses.

    """
    clean, outside = sum(not s.effect for s in scores), sum(s.outside for s in scores)
    lines = [f'{len(scores)} trials, {clean} of them clean, {outside} outside the library', '']
    lines += [_total_line(total) for total in totals(scores) if total.told]
    for kind, parts in groups(scores).items():
        lines += ['', f'by {kind}'.ljust(26) + ''.join(f'{name:>9}' for name in _COLUMNS)]
        lines += [_group_line(label, part) for label, part in parts.items()]
    misses = [score for score in scores if is_miss(score)]
    lines += ['', f'{len(misses)} to look at, in {where}']
    lines += [_miss_line(score) for score in misses]
    return '\n'.join(lines)


def _total_line(total: Total) -> str:
    verdict = {True: 'met', False: 'MISSED', None: ''}[total.met]
    line = f'  {total.name:<52}{_number(total.value):>8}  of {total.told:<5}'
    if total.mark is None:
        return line.rstrip()
    return f'{line}{"at least" if total.at_least else "at most"} {total.mark:g}  {verdict}'


def _group_line(label: str, scores: Sequence[Score]) -> str:
    values = [total.value for total in totals(scores)][:len(_COLUMNS) - 1]
    return f'  {label:<24}{len(scores):>9}' + ''.join(f'{_number(v):>9}' for v in values)


def _miss_line(score: Score) -> str:
    truth = f'{score.effect} concealed {score.concealed:.2f} times' if score.effect else 'clean'
    if score.error:
        return f'  {score.trial}: {truth}; failed: {score.error}'
    said = ' + '.join(score.said) or answer_of(score)
    if score.overlap is not None:
        truth = f'{score.effect} (outside), {"right" if score.port_right else "wrong"} port, ' \
                f'overlap {score.overlap:.2f}'
    rivals = f' (or {", ".join(score.rivals)})' if score.rivals else ''
    return f'  {score.trial}: {truth}, {score.features["experiment"]}; said {said}{rivals}, ' \
           f'{score.verdict}'


def _number(value: float | None) -> str:
    return '-' if value is None else f'{value:.3g}'
