# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Scores of diagnoses in worlds that obey the library's laws: metrics, JSON, table, confusion."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from statistics import median
from typing import Any, Callable, Iterable, Mapping, NamedTuple, Sequence

import numpy as np

from ...figures import require_matplotlib
from ...physics import EFFECTS

_NOT_SCORED = ('gamma', 'phase')  # parameters without a natural scale
_CLEAN_VERDICTS = ('consistent', 'recalibrate')


@dataclass(frozen=True)
class Score:
    """Score of one report; None where a criterion does not apply."""

    trial: str  # name of the trial
    effect: str  # True effect; '' in a clean world
    concealed: float  # degree of concealment
    verdict: str  # verdict of the report; '' without a report
    verdict_right: bool  # the verdict equals that of the truth
    names: list[str]  # names of the reported effects, in order
    alternatives: list[str]  # `indistinguishable_from` of the first reported effect
    # True positive: the true effect is the first name or among its alternatives
    found: bool | None
    found_alone: bool | None  # the true effect is the only name, without alternatives
    extra_names: bool | None  # more effects are reported than the world has
    false_alarm: bool | None  # an effect or missing physics is reported in a clean world
    # |estimate - true| relative to the true distance from "no effect" [%]
    parameter_errors: dict[str, float]
    # held-out force error of the corrected model over the true noise floor
    force_ratio: float | None
    floor_error: float | None  # error of the reported noise floor, signed [%]
    # stiffness_error, damping_error: errors of the corrected model, signed [%]; None where truth
    # or model has no value
    stiffness_error: float | None
    damping_error: float | None
    base_right: bool  # the corrected model has K_e and B_e exactly where the truth has them
    features: dict[str, str]  # properties of experiment and sensors, for grouping
    error: str  # error message of the command; '' on success
    seconds: float  # run time of the diagnosis [s]

    @property
    def answer(self) -> str:
        """First reported name, else 'failed', 'unexplained' or 'nothing'."""
        if not self.verdict:
            return 'failed'
        if self.names:
            return self.names[0]
        return 'unexplained' if self.verdict == 'unexplained' else 'nothing'

    @property
    def is_miss(self) -> bool:
        """Whether the report is wrong in any respect."""
        return (bool(self.error) or self.found is False or bool(self.extra_names)
                or bool(self.false_alarm) or bool(self.effect and not self.verdict_right))


def score(trial: str, truth: Mapping[str, Any], answer: Mapping[str, Any]) -> Score:
    """Score a trial."""
    report: Mapping[str, Any] = answer['report'] or {}
    true = truth['effects'][0] if truth['effects'] else None
    effects = report.get('effects', [])
    names = [effect['name'] for effect in effects]
    alternatives = list(effects[0]['indistinguishable_from']) if effects else []
    name = true['name'] if true else ''
    verdict = str(report.get('verdict', ''))
    fit, corrected = report.get('fit', {}), report.get('corrected', {})
    stiffness, damping = (_value(corrected, each) for each in ('stiffness', 'damping'))
    floor = float(truth['force_floor_n'])
    held_out = fit.get('force_rmse_n', {}).get('corrected')
    return Score(
        trial=trial, effect=name, concealed=float(truth['concealed']),
        verdict=verdict, verdict_right=verdict == truth['verdict'],
        names=names, alternatives=alternatives,
        found=name in names[:1] + alternatives if true else None,
        found_alone=names == [name] and not alternatives if true else None,
        extra_names=len(names) > 1 if true else None,
        false_alarm=None if name else bool(names) or verdict not in _CLEAN_VERDICTS,
        parameter_errors=(
            _parameter_errors(true, effects[0]) if true and names[:1] == [name] else {}),
        force_ratio=None if held_out is None else float(held_out) / floor,
        floor_error=_percent(fit.get('noise_floor_n'), floor),
        stiffness_error=_percent(stiffness, truth['stiffness']),
        damping_error=_percent(damping, truth['damping']),
        base_right=bool(report) and (
            (stiffness is None) == (truth['stiffness'] is None)
            and (not damping) == (not truth['damping'])),
        features=_features(truth), error=str(answer['error']), seconds=float(answer['seconds']),
    )


def _value(corrected: Mapping[str, Any], name: str) -> float | None:
    value = corrected.get(name, {}).get('value')
    return None if value is None else float(value)


def _percent(estimate: float | None, true: float | None) -> float | None:
    if estimate is None or not true:
        return None
    return 100.0 * (float(estimate) / true - 1.0)


def _parameter_errors(true: Mapping[str, Any], found: Mapping[str, Any]) -> dict[str, float]:
    neutral = EFFECTS[true['name']].neutral()
    errors = {}
    for name, value in true['parameters'].items():
        distance = value - neutral.get(name, 0.0)
        estimate = found['parameters'].get(name, {}).get('value')
        if name in _NOT_SCORED or distance == 0.0 or estimate is None:
            continue
        errors[name] = 100.0 * abs((estimate - value) / distance)
    return errors


def _features(truth: Mapping[str, Any]) -> dict[str, str]:
    sensors = truth['sensing']
    return {
        'experiment': truth['experiment'],
        'rate': f'{sensors["rate"]:g} Hz',
        'velocity': 'not sent' if sensors['velocity_noise'] is None else 'sent',
        'dropped samples': 'some' if sensors['dropped'] else 'none',
        'force filter': 'low-pass' if sensors['low_pass'] else 'none',
        'stamps': 'jitter' if sensors['jitter'] else 'exact',
        'joint samples': 'between' if sensors['joint_phase'] else 'with the force',
        'force noise': sensors['distribution'],
    }


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


# The keys of the JSON file are those of earlier versions, which scripts read.
_SCORE_KEYS = {
    'names': 'said', 'alternatives': 'rivals', 'found': 'named', 'found_alone': 'alone',
    'extra_names': 'surplus', 'false_alarm': 'accused',
}
_METRIC_KEYS = {'samples': 'told', 'limit': 'mark'}
_COLUMNS = ('trials', 'found', 'alone', 'extra', 'alarms', 'param.', 'force', 'floor', 'K_e',
            'B_e')  # trials, then the first metrics


def as_dict(scores: Sequence[Score], seeds: Sequence[int]) -> dict[str, Any]:
    """Return a study as JSON content."""
    return {
        'count': sum(bool(s.effect) for s in scores),
        'clean': sum(not s.effect for s in scores),
        'seed': seeds[0] if len(seeds) == 1 else list(seeds),
        'totals': _metric_dicts(scores),
        'groups': {kind: {label: _metric_dicts(part) for label, part in parts.items()}
                   for kind, parts in groups(scores).items()},
        'confusion': confusion(scores),
        'trials': [_renamed(asdict(s), _SCORE_KEYS) for s in scores],
    }


def _metric_dicts(scores: Sequence[Score]) -> list[dict[str, Any]]:
    return [{**_renamed(m._asdict(), _METRIC_KEYS), 'met': m.met} for m in metrics(scores)]


def _renamed(values: Mapping[str, Any], keys: Mapping[str, str]) -> dict[str, Any]:
    return {keys.get(name, name): value for name, value in values.items()}


def as_text(scores: Sequence[Score], folder: str) -> str:
    """Format a study as a table."""
    clean = sum(not s.effect for s in scores)
    lines = [f'{len(scores)} trials, {clean} of them clean', '']
    lines += [_metric_line(metric) for metric in metrics(scores) if metric.samples]
    for kind, parts in groups(scores).items():
        lines += ['', f'by {kind}'.ljust(26) + ''.join(f'{name:>9}' for name in _COLUMNS)]
        lines += [_group_line(label, part) for label, part in parts.items()]
    misses = [score for score in scores if score.is_miss]
    lines += ['', f'{len(misses)} misses; recordings in {folder}']
    lines += [_miss_line(score) for score in misses]
    return '\n'.join(lines)


def _metric_line(metric: Metric) -> str:
    line = f'  {metric.name:<62}{_number(metric.value):>8}  of {metric.samples:<5}'
    if metric.limit is None:
        return line.rstrip()
    outcome = {True: 'met', False: 'MISSED', None: ''}[metric.met]
    return f'{line}{"at least" if metric.at_least else "at most"} {metric.limit:g}  {outcome}'


def _group_line(label: str, scores: Sequence[Score]) -> str:
    values = [metric.value for metric in metrics(scores)][:len(_COLUMNS) - 1]
    return f'  {label:<24}{len(scores):>9}' + ''.join(f'{_number(v):>9}' for v in values)


def _miss_line(score: Score) -> str:
    truth = f'{score.effect} concealed {score.concealed:.2f} times' if score.effect else 'clean'
    if score.error:
        return f'  {score.trial}: {truth}; failed: {score.error}'
    answer = ' + '.join(score.names) or score.answer
    alternatives = f' (or {", ".join(score.alternatives)})' if score.alternatives else ''
    return (f'  {score.trial}: {truth}, {score.features["experiment"]}; diagnosed {answer}'
            f'{alternatives}, {score.verdict}')


def _number(value: float | None) -> str:
    return '-' if value is None else f'{value:.3g}'


def plot_confusion(scores: Sequence[Score], path: Path) -> Path:
    """Plot the confusion matrix."""
    pyplot = require_matplotlib()
    counts = confusion(scores)
    rows, columns = [*EFFECTS, 'nothing'], [*EFFECTS, 'nothing', 'unexplained', 'failed']
    table = np.array([[counts.get(row, {}).get(column, 0) for column in columns]
                      for row in rows], float)
    shares = table / np.maximum(table.sum(axis=1, keepdims=True), 1.0)
    figure, axis = pyplot.subplots(figsize=(12.0, 11.0), layout='constrained')
    axis.imshow(shares, cmap='Blues', vmin=0.0, vmax=1.0)
    for k, j in zip(*np.nonzero(table)):
        axis.text(j, k, f'{table[k, j]:.0f}', ha='center', va='center', fontsize=8,
                  color='white' if shares[k, j] > 0.5 else '#1f2933')
    axis.set_xticks(range(len(columns)), columns, rotation=90)
    axis.set_yticks(range(len(rows)), rows)
    axis.set(xlabel='first reported name', ylabel='truth', title=f'{len(scores)} blind trials')
    figure.savefig(path, dpi=110)
    pyplot.close(figure)
    return path
