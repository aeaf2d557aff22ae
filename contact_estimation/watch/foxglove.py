# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The layout of Foxglove: fields as they are, in the unit of the messages."""

from __future__ import annotations

import json
from typing import Any, Sequence

from .plots import Curve, Plot, PLOTS

_UNSTAMPED = 'estimator_node/model_fit'
_STATUS, _DIAGNOSTICS = '/estimator_node/status', '/diagnostics'
_STATES, _SUMMARY = 'StateTransitions!status', 'DiagnosticSummary!diagnostics'


def foxglove_layout() -> str:
    """Return the layout."""
    panels: dict[str, Any] = {}
    rows: list[Any] = []
    for plot in PLOTS:
        panels[f'Plot!{plot.key}'] = _plot_panel(plot)
        row: Any = f'Plot!{plot.key}'
        deviations = {curve.std_topic: curve for curve in plot.curves if curve.std_topic}
        for topic, curve in deviations.items():
            name = f'Plot!{plot.key}_std'
            panels[name] = _panel(
                f'standard deviation of {plot.quantity} [{plot.unit}]',
                [_series(topic, curve.field, 'std', curve.colour)])
            row = _split('row', row, name, 65)
        rows.append(row)
    panels[_STATES] = {
        'paths': [{'value': f'{_STATUS}.data', 'timestampMethod': 'receiveTime',
                   'label': 'status'}],
        'isSynced': True, 'foxglovePanelTitle': 'status of the estimator'}
    panels[_SUMMARY] = {
        'topicToRender': _DIAGNOSTICS, 'minLevel': 0, 'pinnedIds': [], 'hardwareIdFilter': '',
        'sortByLevel': True, 'foxglovePanelTitle': 'checks'}
    rows.append(_split('row', _STATES, _SUMMARY, 50))
    layout = {'configById': panels, 'globalVariables': {}, 'userNodes': {},
              'playbackConfig': {'speed': 1}, 'layout': _stacked(rows)}
    return json.dumps(layout, indent=1) + '\n'


def _plot_panel(plot: Plot) -> dict[str, Any]:
    unit = plot.unscaled_unit or plot.unit
    return _panel(f'{plot.quantity} [{unit}]', [
        _series(curve.topic, curve.field + _modifier(curve), curve.label, curve.colour)
        for curve in plot.curves if not curve.std_topic])


def _modifier(curve: Curve) -> str:
    return '.@negative' if curve.scale < 0.0 else ''


def _series(topic: str, path: str, label: str, colour: str) -> dict[str, Any]:
    method = 'receiveTime' if topic == _UNSTAMPED else 'headerStamp'
    return {'value': f'/{topic}.{path}', 'label': label, 'color': colour, 'enabled': True,
            'timestampMethod': method}


def _panel(title: str, paths: list[dict[str, Any]]) -> dict[str, Any]:
    return {'paths': paths, 'foxglovePanelTitle': title, 'xAxisVal': 'timestamp',
            'isSynced': True, 'showLegend': True, 'legendDisplay': 'floating',
            'showPlotValuesInLegend': True, 'showXAxisLabels': True, 'showYAxisLabels': True,
            'followingViewWidth': 20, 'sidebarDimension': 240}


def _stacked(rows: Sequence[Any]) -> Any:
    if len(rows) == 1:
        return rows[0]
    return _split('column', rows[0], _stacked(rows[1:]), 100 / len(rows))


def _split(direction: str, first: Any, second: Any, percentage: float) -> dict[str, Any]:
    return {'direction': direction, 'first': first, 'second': second,
            'splitPercentage': percentage}
