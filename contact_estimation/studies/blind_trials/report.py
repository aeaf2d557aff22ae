# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Report of a study: JSON, table and confusion matrix."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Any, Mapping, Sequence

import numpy as np

from .metrics import confusion, groups, Metric, metrics
from .scoring import Score
from ...figures import require_matplotlib
from ...physics import EFFECTS

# The keys of the JSON file are those of earlier versions, which scripts read.
_SCORE_KEYS = {
    'names': 'said', 'alternatives': 'rivals', 'found': 'named', 'found_alone': 'alone',
    'extra_names': 'surplus', 'false_alarm': 'accused',
}
_METRIC_KEYS = {'samples': 'told', 'limit': 'mark'}
_COLUMNS = ('trials', 'found', 'alone', 'extra', 'alarms', 'param.', 'force', 'floor', 'K_e',
            'B_e')  # trials, then the first metrics


def as_dict(scores: Sequence[Score], seed: int) -> dict[str, Any]:
    """Return a study as JSON content."""
    return {
        'count': sum(bool(s.effect) for s in scores),
        'clean': sum(not s.effect for s in scores),
        'seed': seed,
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
