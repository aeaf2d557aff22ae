# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The summary of a replay: as JSON, text or picture, or as the error that nothing is estimated."""

from collections import Counter
from math import isfinite
import sys
from typing import Any, Callable, Mapping, Sequence

import numpy as np

from .command_line import new_file
from ..diagnosis.observe.signals import LEAST_SAMPLES
from ..estimators.estimate import AxesEstimates, Estimate, EstimateStatus
from ..exceptions import RecordingError
from ..figures import as_png, require_matplotlib
from ..pipeline.axis_pipeline import EstimationPipeline
from ..pipeline.estimate_files import EstimateTrace, plot_contact, signal_series, stamp_text
from ..pipeline.parameters import EstimationParameters
from ..pipeline.recorded_arm import read_contact_signals
from ..pipeline.replay import no_usable_sample, RecordingReplay
from ..pipeline.wall_law import ModelFitMonitor
from ..recordings import RecordingReader
from ..recordings.recorded_signals import Tare
from ..recordings.source import RecordingSource
from ..texts import printable


def picture_trace(path: str | None) -> EstimateTrace | None:
    """Return what collects the estimates for a picture."""
    if path is None:
        return None
    require_matplotlib()
    if new_file(path).suffix.lower() != '.png':
        raise RecordingError(f'--picture writes a PNG file, got {path}; let its name end in .png')
    return EstimateTrace()


def write_picture(
    path: str, reader: RecordingReader, source: RecordingSource, parameters: EstimationParameters,
    trace: EstimateTrace, true: Mapping[str, float] | None = None,
) -> None:
    """Write the picture of a recording."""
    signals = read_contact_signals(reader, source, parameters, parameters.axis, parameters.joint)
    series = {**signal_series(signals), **trace.series(int(signals.wrench.stamp_ns[0]))}
    estimator = f', {parameters.estimator}' if 'stiffness' in series else ''
    figure = plot_contact(series, reader.path.name + estimator, true)
    new_file(path).write_bytes(as_png(figure))


_SAID_OTHERWISE = ('model_fit',)  # warnings that the summary states anyway
_OF_SURFACE = ('surface', 'surface_shifted')  # the later one counts
_NO_CAUSE = 'surface_unchecked'  # warns that there is no estimate, not why


class Replayed:
    """
    What the summary needs of all estimates.

    first, last: of the first and the last sample; empty before any
    samples: their number
    statuses: that occurred on any axis
    reasons: for which samples, on any axis, changed no estimate
    """

    def __init__(self) -> None:
        self.first: AxesEstimates = ()
        self.last: AxesEstimates = ()
        self.samples = 0
        self.statuses: set[EstimateStatus] = set()
        self.reasons: Counter[str] = Counter()

    def add(self, estimates: Sequence[AxesEstimates]) -> None:
        """Add the estimates of consecutive samples."""
        self.first, self.last = self.first or estimates[0], estimates[-1]
        self.samples += len(estimates)
        self.statuses.update([own.status for axes in estimates for own in axes])
        if EstimateStatus.ESTIMATING not in self.statuses:  # they are asked for only then
            self.reasons.update([own.reason or 'no reason given' for axes in estimates
                                 for own in axes if own.reason
                                 or own.status is EstimateStatus.FROZEN])


def refuse_empty(
    reader: RecordingReader, replay: RecordingReplay, replayed: Replayed, cause: Callable[[], str]
) -> None:
    """Refuse a replay that never updated the first guess."""
    if replayed.samples < LEAST_SAMPLES and (found := cause()):
        raise RecordingError(found)
    if not replayed.samples:
        raise no_usable_sample(str(reader.path), replay.session)
    if EstimateStatus.ESTIMATING not in replayed.statuses:
        raise RecordingError(_nothing_estimated(reader, replay, replayed, cause))


def summary_of(
    replay: RecordingReplay, reader: RecordingReader, replayed: Replayed, wall_s: float
) -> dict[str, Any]:
    """Return the summary of a replay at its end, which has estimates and took `wall_s` [s]."""
    session, last = replay.session, replayed.last
    summary: dict[str, Any] = {
        'estimator': session.parameters.estimator,
        'samples': replayed.samples,
        **_state_of(last[0], session.pipeline),
        'warnings': [  # the most important first
            {'name': found.warned.name, 'axis': found.warned.axis, 'text': found.warned.text,
             'first_stamp': stamp_text(found.first_ns), 'last_stamp': stamp_text(found.last_ns)}
            for found in replay.session.checks.ordered_warnings()],
        **({'tare': {axis: tare._asdict() for axis, tare in replay.tares.items()}}
           if replay.tares else {}),
        'recorded_s': (last[0].stamp_ns - replayed.first[0].stamp_ns) * 1e-9,
        'wall_s': wall_s,
        'rejected': dict(session.rejected),
        'missing': session.pipeline.missing,
        'truncated': reader.truncated,
        'damaged_chunks': reader.damaged_chunks,
    }
    if len(last) > 1:
        summary['axes'] = {axis: _state_of(estimate, own) for (axis, own), estimate
                           in zip(session.pipelines.items(), last)}
    if session.matrix.last:
        summary['stiffness_matrix'] = {
            name: value.tolist() if isinstance(value, np.ndarray) else value
            for name, value in session.matrix.last._asdict().items()}
    return summary


def _nothing_estimated(
    reader: RecordingReader, replay: RecordingReplay, replayed: Replayed, ask: Callable[[], str]
) -> str:
    """Return why the first guess was never updated."""
    axis = next(iter(replay.session.pipelines))
    warned = [found.warned for found in replay.session.checks.ordered_warnings()]
    free = replayed.statuses == {EstimateStatus.FREE}
    causes = [one.text for one in warned if one.invalidates]
    others = [one.text for one in warned if one.name != _NO_CAUSE]
    if not causes and (free or not others):
        # A contact that was not seen looks like an offset, unless the whole recording is known.
        causes = [ask()]
    cause = next(filter(None, causes + others), '')
    if reader.columns and 'force_sign' in cause:
        cause += f' (a minus changes a sign: --columns wrench.force.{axis}=-COLUMN)'
    said = '; '.join(filter(None, (
        cause, replay.session.checks.explain_no_contact(axis) if free else '')))
    withheld = any(one.invalidates for one in warned)  # the reasons repeat its text
    held = '; '.join(f'{count}: {reason}' for reason, count in replayed.reasons.most_common(3)
                     if not withheld and reason not in said)
    if free:
        return (f'no contact seen in {reader.path}: {said}'
                + f' (of {replayed.samples} samples {held})' * bool(held))
    unused = f'no sample in contact could be used ({held})' if held else ''
    return f'nothing could be estimated in {reader.path}: ' + '; '.join(
        filter(None, (cause, unused)))


def _state_of(estimate: Estimate, pipeline: EstimationPipeline) -> dict[str, Any]:
    """Return the estimate of an axis, NaN as None, its status and the fit of the model."""
    names = ('stiffness', 'damping', 'stiffness_std', 'damping_std', 'location', 'inertia')
    values = {name: getattr(estimate, name) for name in names}
    finite = {name: value if isfinite(value) else None for name, value in values.items()}
    return {**finite, 'status': estimate.status.value,
            'reason': estimate.reason or pipeline.publication.invalid,
            'model_fit': _fit_of(pipeline.model_fit)}


def _fit_of(monitor: ModelFitMonitor) -> dict[str, Any]:
    """Return how the model fits the last contact, and the worst mismatch of the recording."""
    now, worst = monitor.now.ratio, monitor.worst
    return {
        'ratio': now if isfinite(now) else None,
        'mismatches': monitor.count,
        'worst_ratio': worst.ratio if worst.text else None,
        'worst_stamp': stamp_text(worst.stamp_ns) if worst.text else None,
        'text': worst.text,
    }


def print_summary(summary: dict[str, Any]) -> None:
    """Print a summary; warnings and losses go to stderr."""
    speed = summary['recorded_s'] / max(summary['wall_s'], 1e-9)
    print(f'{summary["estimator"]}: {summary["samples"]} samples, {summary["recorded_s"]:.1f} s '
          f'recorded, replayed in {summary["wall_s"]:.1f} s ({speed:.0f} times real time)')
    for name, unit in (('stiffness', 'N/m'), ('damping', 'N s/m'), ('location', 'm'),
                       ('inertia', 'kg')):
        value, std = summary[name], summary.get(f'{name}_std')
        if value is not None:
            band = f' +- {std:.3g}' if std is not None else ''
            print(f'  {name:<10}{value:12.6g}{band} {unit}')
    for axis, tare in summary.get('tare', {}).items():
        print(f'  {axis}: {Tare(**tare)}')
    warned = {found['text'] for found in summary['warnings']}
    reason = printable(summary['reason'])
    if summary['reason'] in warned:
        reason = '' if summary['stiffness_std'] else 'the estimate is withheld, see the warnings'
    print(f'  status    {summary["status"]:>12}{": " * bool(reason)}{reason}')
    if summary['model_fit']['text']:
        print(f'  model     {summary["model_fit"]["text"]} '
              f'(until {summary["model_fit"]["worst_stamp"]} s)')
    surfaces = {found['axis']: found for found in sorted(
        summary['warnings'], key=lambda found: float(found['last_stamp']))
        if found['name'] in _OF_SURFACE}
    for found in summary['warnings']:
        superseded = found['name'] in _OF_SURFACE and found is not surfaces[found['axis']]
        if found['name'] not in _SAID_OTHERWISE and not superseded:
            print(f'  warning: {printable(found["text"])} (until {found["last_stamp"]} s)',
                  file=sys.stderr)
    if 'stiffness_matrix' in summary:
        _print_matrix(summary['stiffness_matrix'])
    for axis, own in list(summary.get('axes', {}).items())[1:]:
        print(f'  axis {axis}: stiffness {own["stiffness"]:.6g} N/m, damping {own["damping"]:.6g} '
              f'N s/m, {own["status"]}' + (f': {own["reason"]}' if own['reason'] else ''))
    _print_losses(summary)


def _print_losses(summary: dict[str, Any]) -> None:
    for name, count in {**summary['rejected'], 'missing': summary['missing']}.items():
        if count:
            print(f'  {count} samples {name}', file=sys.stderr)
    if summary['truncated'] or summary['damaged_chunks']:
        print(f'  the recording is cut short or damaged ({summary["damaged_chunks"]} damaged '
              'chunks); all intact data were used', file=sys.stderr)


def _print_matrix(found: dict[str, Any]) -> None:
    for value, std, direction in zip(
        found['principal'], found['principal_std'], found['directions']
    ):
        along = ', '.join(f'{part:.3f}' for part in direction)
        print(f'  principal stiffness {value:.6g} +- {std:.3g} N/m along ({along})')
    normal = ', '.join(f'{part:.3f}' for part in found['normal'])
    print(f'  normal into the wall ({normal}) +- {found["normal_std"]:.2g} rad')
    if found['reason']:
        print(f'  {found["reason"]}')
