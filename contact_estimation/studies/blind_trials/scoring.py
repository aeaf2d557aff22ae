# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
Scores of blind diagnoses: of each report, summed by kind, and as table and JSON.

A name is right if it, or one that its report calls indistinguishable from it, is acceptable: in a
world that obeys the library's laws the concealed effect alone, on a rig the effects of a family.
"""

from dataclasses import asdict, dataclass
from statistics import median
from typing import AbstractSet, Any, Mapping, Sequence

from ...exceptions import RecordingError
from ...physics import EFFECTS

NEUTRAL = ('force_bias', 'contact_offset')
"""Offsets beside other names on a rig, neither right nor wrong: every rig has small ones."""

RIGHT, WRONG, SILENT, FAILED = OUTCOMES = ('right', 'wrong', 'silent', 'failed')
"""Outcomes: an acceptable name first, another one first, no name, no report."""

LIBRARY, CLEAN, FOREIGN, UNKNOWN, CLEAN_RIG = 'library', 'clean', 'foreign', 'unknown', 'clean rig'
KINDS = {
    LIBRARY: 'effects of the library', CLEAN: 'nothing missing',
    FOREIGN: 'laws of the literature on rigs, scored by family',
    UNKNOWN: 'laws on rigs that no family describes', CLEAN_RIG: 'rigs without a law',
}
"""Kinds of trials, with their meaning."""

_ON_RIGS = (FOREIGN, UNKNOWN, CLEAN_RIG)
_NOT_SCORED = ('gamma', 'phase')  # parameters without a natural scale


@dataclass(frozen=True)
class NamedEffect:
    """One name of a report."""

    name: str  # key of EFFECTS
    probability: float  # as reported
    right: bool  # the name or one of its `indistinguishable_from` is acceptable


@dataclass(frozen=True)
class Score:
    """Score of one report."""

    trial: str  # name of the trial
    kind: str  # key of KINDS
    law: str  # True effect or law; '' in a clean world
    families: list[str]  # acceptable ones; empty where no name is
    stage: str  # kind of experiment
    concealed: float  # degree by which the law stands out
    verdict: str  # verdict of the report; '' without a report
    names: list[NamedEffect]  # reported effects, in order, without neutral ones
    outcome: str  # RIGHT, WRONG, SILENT or FAILED; any name is wrong where none is acceptable
    surplus: bool  # a name besides the first is not acceptable
    port_right: bool | None  # the port of the location is the true one; None in a clean world
    # intersection over union of true and reported intervals; None unless UNKNOWN
    overlap: float | None
    # of a library's effect that is the first name: |estimate - true| relative to the true
    # distance from "no effect" [%]
    parameter_errors: dict[str, float]
    # signed errors of the corrected model [%]; None where truth or model has no value
    stiffness_error: float | None
    damping_error: float | None
    error: str  # error message of the command; '' on success
    seconds: float  # run time of the diagnosis [s]

    @property
    def is_miss(self) -> bool:
        """Whether the report is wrong in any respect."""
        return self.outcome != (RIGHT if self.families else SILENT) or self.surplus


def score(trial: str, truth: Mapping[str, Any], answer: Mapping[str, Any]) -> Score:
    """Score a trial."""
    report: Mapping[str, Any] = answer['report'] or {}
    effects, verdict = report.get('effects', []), str(report.get('verdict', ''))
    kind, law, acceptable = truth['kind'], truth['law'], acceptable_names(truth)
    names, outcome = judged(
        answer['report'], acceptable, set(NEUTRAL) - acceptable if kind in _ON_RIGS else set())
    if kind == CLEAN and outcome == SILENT and verdict == 'unexplained':
        outcome = WRONG  # an accusation without a name
    location = report.get('location') or {}
    first = effects[0] if kind == LIBRARY and effects and effects[0]['name'] == law else None
    return Score(
        trial=trial, kind=kind, law=law, families=truth['families'], stage=truth['stage'],
        concealed=float(truth['concealed']), verdict=verdict, names=names, outcome=outcome,
        surplus=any(not named.right for named in names[1:]),
        port_right=location.get('port') == truth['port'] if law else None,
        overlap=overlap_of(
            location.get('intervals_s', []), truth['intervals_s']) if kind == UNKNOWN else None,
        parameter_errors=_parameter_errors(truth, first) if first else {},
        stiffness_error=_percent(report, 'stiffness', truth),
        damping_error=_percent(report, 'damping', truth),
        error=str(answer['error']), seconds=float(answer['seconds']))


def acceptable_names(truth: Mapping[str, Any]) -> set[str]:
    """Return the effects that a truth file asks for."""
    if 'acceptable_names' in truth:
        return set(truth['acceptable_names'])
    if 'families' in truth:
        return of_families(truth['families'])
    if 'effects' in truth:
        return {name for effect in truth['effects']
                for name in (effect['name'], *effect.get('also', []))}
    raise RecordingError(
        f'a truth file must have acceptable_names, effects or families, got '
        f'{", ".join(truth) or "nothing"}; add one of them')


def of_families(families: Sequence[str]) -> set[str]:
    """Return the effects of families."""
    return {name for name, cls in EFFECTS.items() if cls.family in families}


def judged(
    report: Mapping[str, Any] | None, acceptable: AbstractSet[str], neutral: AbstractSet[str]
) -> tuple[list[NamedEffect], str]:
    """Return the names of a report that are not neutral, and the outcome."""
    names = [NamedEffect(effect['name'], float(effect['probability']),
                         bool(acceptable & {effect['name'], *effect['indistinguishable_from']}))
             for effect in (report or {}).get('effects', []) if effect['name'] not in neutral]
    if report is None:
        return names, FAILED
    if not names:
        return names, SILENT
    return names, RIGHT if names[0].right else WRONG


def _percent(report: Mapping[str, Any], name: str, truth: Mapping[str, Any]) -> float | None:
    value = report.get('corrected', {}).get(name, {}).get('value')
    return 100.0 * (float(value) / truth[name] - 1.0) if value and truth.get(name) else None


def _parameter_errors(truth: Mapping[str, Any], found: Mapping[str, Any]) -> dict[str, float]:
    neutral = EFFECTS[truth['law']].neutral()
    errors = {}
    for name, value in truth['parameters'].items():
        distance = value - neutral.get(name, 0.0)
        estimate = found['parameters'].get(name, {}).get('value')
        if name not in _NOT_SCORED and distance != 0.0 and estimate is not None:
            errors[name] = 100.0 * abs((estimate - value) / distance)
    return errors


def overlap_of(reported: Sequence[Sequence[float]], true: Sequence[Sequence[float]]) -> float:
    """Compute intersection over union of two lists of disjoint intervals [s]."""
    both = sum(max(0.0, min(b, d) - max(a, c)) for a, b in reported for c, d in true)
    each = sum(b - a for intervals in (reported, true) for a, b in intervals)
    return both / max(each - both, 1e-12)


PROBABILITY_EDGES = (0.0, 0.5, 0.7, 0.8, 0.9, 1.0)
"""Edges of the five bins of the reliability table."""


def reliability(scores: Sequence[Score]) -> list[dict[str, Any]]:
    """
    Compare reported probabilities with the share of right names, on rigs.

    Returns by bin: ends of its probabilities, number of names, mean probability given and share of
    names of an acceptable family, None without names. The last bin includes its end.
    """
    given = [(named.probability, named.right) for score in scores for named in score.names
             if score.kind in _ON_RIGS]
    table = []
    for low, high in zip(PROBABILITY_EDGES[:-1], PROBABILITY_EDGES[1:]):
        part = [(p, right) for p, right in given
                if low <= p < high or p == high == PROBABILITY_EDGES[-1]]
        mean, right = [sum(column) / len(part) for column in zip(*part)] or [None, None]
        table.append({'low': low, 'high': high, 'names': len(part), 'mean': mean,
                      'share_right': right})
    return table


def outcomes(scores: Sequence[Score]) -> dict[str, int]:
    """Count outcomes."""
    counts = {name: sum(s.outcome == name for s in scores) for name in OUTCOMES}
    return {'trials': len(scores), **counts, 'surplus': sum(s.surplus for s in scores)}


def groups(scores: Sequence[Score]) -> dict[str, dict[str, list[Score]]]:
    """Group scores by law, by acceptable family and by kind of experiment."""
    split: dict[str, dict[str, list[Score]]] = {'law': {}, 'family': {}, 'experiment': {}}
    for score in sorted(scores, key=lambda s: (s.kind, s.law, s.concealed)):
        split['law'].setdefault(score.law or score.kind, []).append(score)
        for family in score.families or [score.kind]:
            split['family'].setdefault(family, []).append(score)
        split['experiment'].setdefault(score.stage, []).append(score)
    return split


def as_dict(scores: Sequence[Score], seeds: Sequence[int]) -> dict[str, Any]:
    """Return a study as JSON content."""
    return {
        'seed': seeds[0] if len(seeds) == 1 else list(seeds),
        'kinds': {kind: outcomes(part) for kind, part in _by_kind(scores).items()},
        'groups': {criterion: {label: outcomes(part) for label, part in parts.items()}
                   for criterion, parts in groups(scores).items()},
        'reliability': reliability(scores),
        'trials': [asdict(score) for score in scores],
    }


def _by_kind(scores: Sequence[Score]) -> Mapping[str, list[Score]]:
    parts = {kind: [score for score in scores if score.kind == kind] for kind in KINDS}
    return {kind: part for kind, part in parts.items() if part}


def as_text(scores: Sequence[Score], folder: str) -> str:
    """Format a study as tables."""
    lines = [f'{len(scores)} trials']
    for kind, part in _by_kind(scores).items():
        lines += ['', f'{kind}: {KINDS[kind]}', *_summary(kind, part)]
    for criterion, parts in groups(scores).items():
        columns = ('trials', *OUTCOMES, 'surplus')
        lines += ['', f'by {criterion}'.ljust(32) + ''.join(f'{name:>9}' for name in columns)]
        for label, part in parts.items():
            counts = outcomes(part)
            lines.append(f'  {label:<30}' + ''.join(f'{counts[name]:>9}' for name in columns))
    lines += ['', 'probability given       names     mean    right']
    for row in reliability(scores):
        mean, right = ('-' if row[name] is None else f'{row[name]:.2f}'
                       for name in ('mean', 'share_right'))
        lines.append(f'  {row["low"]:.1f} to {row["high"]:.1f}{row["names"]:>18}{mean:>8} '
                     f'{right:>8}')
    misses = [score for score in scores if score.is_miss]
    lines += ['', f'{len(misses)} misses; recordings in {folder}']
    lines += [_miss_line(score) for score in misses]
    return '\n'.join(lines)


def _summary(kind: str, part: Sequence[Score]) -> list[str]:
    """Return the lines of a kind of trials."""
    counts = outcomes(part)
    if kind in (CLEAN, CLEAN_RIG):
        shown = {'false alarms': counts[WRONG]}
    elif kind == UNKNOWN:
        located = sum(s.outcome == SILENT and bool(s.port_right) for s in part)
        shown = {'nothing named': counts[SILENT], 'nothing named, and right port': located}
    else:
        what = 'true name, or one listed with it,' if kind == LIBRARY else 'right family'
        alone = sum(s.outcome == RIGHT and not s.surplus for s in part)
        shown = {f'{what} first': counts[RIGHT], f'{what} first, no surplus name': alone,
                 'wrong name first': counts[WRONG], 'nothing named': counts[SILENT],
                 'diagnosis failed': counts[FAILED]}
    lines = [f'  {f"{name} [%]":<58}{100.0 * count / len(part):>8.3g}  of {len(part)}'
             for name, count in shown.items()]
    if kind != LIBRARY:
        return lines
    errors = {
        'median parameter error [% of the distance from no effect]':
            [error for s in part for error in s.parameter_errors.values()],
        'median error of K_e [%]':
            [abs(s.stiffness_error) for s in part if s.stiffness_error is not None],
        'median error of B_e [%]':
            [abs(s.damping_error) for s in part if s.damping_error is not None],
    }
    return lines + [f'  {name:<58}{median(values):>8.3g}  of {len(values)}'
                    for name, values in errors.items() if values]


def _miss_line(score: Score) -> str:
    truth = (f'{score.law or score.kind} ({score.stage})'
             + (f', {score.concealed:.1f} times' if score.law else ''))
    if score.error:
        return f'  {score.trial}: {truth}; failed: {score.error}'
    names = ' + '.join(f'{n.name} {n.probability:.2f}' for n in score.names) or 'nothing'
    wanted = score.law if score.kind == LIBRARY else ' or '.join(score.families) or 'no name'
    return f'  {score.trial}: {truth}; expected {wanted}, diagnosed {names}, {score.verdict}'
