# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Score and report of diagnoses on rigs: by family, since no name is exact there."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import AbstractSet, Any, Mapping, NamedTuple, Sequence

import numpy as np

from ...figures import BLUE, figure_style, GREY, MUTED, require_matplotlib
from ...physics import EFFECTS


NEUTRAL = ('force_bias', 'contact_offset')
"""Offsets beside other names, neither right nor wrong: every rig has small ones."""

RIGHT, WRONG, SILENT, FAILED = 'right', 'wrong', 'silent', 'failed'
"""Outcomes: an acceptable family first, another one first, no name, no report."""


@dataclass(frozen=True)
class NamedEffect:
    """One name of a report."""

    name: str  # key of EFFECTS
    probability: float  # as reported
    right: bool  # the name or one of its `indistinguishable_from` is of an acceptable family


@dataclass(frozen=True)
class FamilyScore:
    """Score of one report."""

    trial: str  # name of the trial
    law: str  # True law; '' in a clean world
    # acceptable families; empty for a clean world and for a law that no effect describes
    families: list[str]
    stage: str  # kind of experiment
    concealed: float  # degree by which the law stands out
    verdict: str  # verdict of the report; '' without a report
    names: list[NamedEffect]  # reported effects, in order, without neutral ones
    outcome: str  # RIGHT, WRONG, SILENT or FAILED; any name is wrong where no family is acceptable
    surplus: bool  # a name besides the first is not acceptable
    port_right: bool | None  # the port of the location is the true one; None in a clean world
    # intersection over union of true and reported intervals; None where a family is acceptable
    overlap: float | None
    error: str  # error message of the command; '' on success
    seconds: float  # run time of the diagnosis [s]

    @property
    def kind(self) -> str:
        """'foreign' (a family is acceptable), 'unknown' (none is) or 'clean'."""
        return 'foreign' if self.families else 'unknown' if self.law else 'clean'

    @property
    def is_miss(self) -> bool:
        """Whether the report is wrong in any respect."""
        wanted = RIGHT if self.families else SILENT
        return self.outcome != wanted or self.surplus


def family_score(trial: str, truth: Mapping[str, Any], answer: Mapping[str, Any]) -> FamilyScore:
    """Score a trial on a rig."""
    report: Mapping[str, Any] = answer['report'] or {}
    families, unknown = list(truth['families']), truth['unknown'] or {}
    acceptable = of_families(families)
    names = scored_names(report.get('effects', []), acceptable, set(NEUTRAL) - acceptable)
    location = report.get('location') or {}
    return FamilyScore(
        trial=trial, law=truth['law'], families=families, stage=truth['stage'],
        concealed=float(truth['concealed']), verdict=str(report.get('verdict', '')), names=names,
        outcome=outcome_of(bool(report), names),
        surplus=any(not named.right for named in names[1:]),
        port_right=location.get('port') == truth['port'] if truth['law'] else None,
        overlap=overlap_of(
            location.get('intervals_s', []), unknown['intervals_s']) if unknown else None,
        error=str(answer['error']), seconds=float(answer['seconds']),
    )


def of_families(families: Sequence[str]) -> set[str]:
    """Return the effects of families."""
    return {name for name, cls in EFFECTS.items() if cls.family in families}


def scored_names(
    effects: Sequence[Mapping[str, Any]], acceptable: AbstractSet[str], neutral: AbstractSet[str]
) -> list[NamedEffect]:
    """Score the names of a report."""
    return [
        NamedEffect(effect['name'], float(effect['probability']),
                    bool(acceptable & {effect['name'], *effect['indistinguishable_from']}))
        for effect in effects if effect['name'] not in neutral
    ]


def outcome_of(is_report: bool, names: Sequence[NamedEffect]) -> str:
    """Return the outcome of a trial."""
    if not is_report:
        return FAILED
    if not names:
        return SILENT
    return RIGHT if names[0].right else WRONG


def overlap_of(reported: Sequence[Sequence[float]], true: Sequence[Sequence[float]]) -> float:
    """Compute intersection over union of two lists of disjoint intervals [s]."""
    both = sum(max(0.0, min(b, d) - max(a, c)) for a, b in reported for c, d in true)
    each = sum(b - a for intervals in (reported, true) for a, b in intervals)
    return both / max(each - both, 1e-12)


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


_OUTCOMES = (RIGHT, WRONG, SILENT, FAILED)


def outcomes(scores: Sequence[FamilyScore]) -> dict[str, int]:
    """Count outcomes."""
    counts = {name: sum(s.outcome == name for s in scores) for name in _OUTCOMES}
    return {'trials': len(scores), **counts, 'surplus': sum(s.surplus for s in scores)}


def family_groups(scores: Sequence[FamilyScore]) -> dict[str, dict[str, list[FamilyScore]]]:
    """Group scores by law, by acceptable family and by kind of experiment."""
    split: dict[str, dict[str, list[FamilyScore]]] = {'law': {}, 'family': {}, 'experiment': {}}
    for score in sorted(scores, key=lambda s: (s.kind, s.law, s.concealed)):
        split['law'].setdefault(score.law or 'clean', []).append(score)
        for family in score.families or [score.kind]:
            split['family'].setdefault(family, []).append(score)
        split['experiment'].setdefault(score.stage, []).append(score)
    return split


def family_dict(scores: Sequence[FamilyScore]) -> dict[str, Any]:
    """Return the trials on rigs as JSON content."""
    return {
        'kinds': {kind: outcomes(part) for kind, part in _by_kind(scores).items()},
        'groups': {criterion: {label: outcomes(part) for label, part in parts.items()}
                   for criterion, parts in family_groups(scores).items()},
        'reliability': [row._asdict() for row in reliability(scores)],
        'trials': [{**asdict(score), 'kind': score.kind} for score in scores],
    }


def _by_kind(scores: Sequence[FamilyScore]) -> Mapping[str, list[FamilyScore]]:
    kinds: dict[str, list[FamilyScore]] = {'foreign': [], 'unknown': [], 'clean': []}
    for score in scores:
        kinds[score.kind].append(score)
    return {kind: part for kind, part in kinds.items() if part}


def family_text(scores: Sequence[FamilyScore], folder: str) -> str:
    """Format the trials on rigs as tables."""
    lines = [f'{len(scores)} trials on rigs, scored by family', '', *_summary(scores)]
    for criterion, parts in family_groups(scores).items():
        columns = ('trials', *_OUTCOMES, 'surplus')
        lines += ['', f'by {criterion}'.ljust(32) + ''.join(f'{name:>9}' for name in columns)]
        for label, part in parts.items():
            counts = outcomes(part)
            lines.append(f'  {label:<30}' + ''.join(f'{counts[name]:>9}' for name in columns))
    lines += ['', calibration_text(scores)]
    misses = [score for score in scores if score.is_miss]
    lines += ['', f'{len(misses)} misses; recordings in {folder}']
    lines += [_miss_line(score) for score in misses]
    return '\n'.join(lines)


def _summary(scores: Sequence[FamilyScore]) -> list[str]:
    kinds = _by_kind(scores)
    lines = []
    if 'foreign' in kinds:
        part, counts = kinds['foreign'], outcomes(kinds['foreign'])
        alone = sum(s.outcome == RIGHT and not s.surplus for s in part)
        numbers = {
            'right family first': counts[RIGHT], 'right family first, no surplus name': alone,
            'wrong family first': counts[WRONG], 'nothing named': counts[SILENT],
            'diagnosis failed': counts[FAILED],
        }
        lines += [_share_line(f'{name} [%]', n, len(part)) for name, n in numbers.items()]
    if 'unknown' in kinds:
        part = kinds['unknown']
        silent = [s for s in part if s.outcome == SILENT]
        located = sum(bool(s.port_right) for s in silent)
        lines += [_share_line('no family describes the law: nothing named [%]', len(silent),
                              len(part)),
                  _share_line('no family describes the law: ... and right port [%]', located,
                              len(part))]
    if 'clean' in kinds:
        counts = outcomes(kinds['clean'])
        lines.append(_share_line(
            'false alarms in clean worlds [%]', counts[WRONG], counts['trials']))
    return lines


def _share_line(name: str, count: int, total: int) -> str:
    return f'  {name:<58}{100.0 * count / total:>8.3g}  of {total}'


def _miss_line(score: FamilyScore) -> str:
    truth = f'{score.law} ({score.stage}), {score.concealed:.1f} times' if score.law else (
        f'clean ({score.stage})')
    if score.error:
        return f'  {score.trial}: {truth}; failed: {score.error}'
    names = ' + '.join(f'{n.name} {n.probability:.2f}' for n in score.names) or 'nothing'
    wanted = ' or '.join(score.families) or 'no name'
    return f'  {score.trial}: {truth}; expected {wanted}, diagnosed {names}, {score.verdict}'
