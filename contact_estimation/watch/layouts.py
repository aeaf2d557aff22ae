# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""What is plotted, and the layouts of Foxglove and PlotJuggler."""

from __future__ import annotations

import json
import re
from typing import Any, NamedTuple, Sequence
from xml.etree import ElementTree

from ..figures import BLUE, MUTED, ORANGE

BAND = '#8cc8e0'
"""Of the bounds of an estimate, on a light and on a dark ground."""


class Curve(NamedTuple):
    """One curve of a plot."""

    key: str  # name in the view's tree
    label: str  # in the legend
    topic: str  # where the value comes from, without the leading slash
    field: str  # of the message, as in 'points[0].positions[0]'
    scale: float = 1.0  # factor of the field
    colour: str = MUTED  # as '#rrggbb'
    width: float = 1.0  # of the line, in points
    # topic of the standard deviation whose multiple `stds` is added; '' for none
    std_topic: str = ''
    stds: float = 0.0  # that multiple


class Plot(NamedTuple):
    """Curves with a common axis."""

    key: str  # name in the view's tree
    # quantity, unit: what is plotted
    quantity: str
    unit: str
    curves: tuple[Curve, ...]  # from the lowest to the uppermost
    unscaled_unit: str = ''  # unit of the fields without the factors of the curves

    @property
    def title(self) -> str:
        """Quantity and unit."""
        return f'{self.quantity} [{self.unit}]'


def _estimate(key: str, unit: str, symbol: str) -> Plot:
    own, std = f'estimator_node/{key}', f'estimator_node/{key}_std'
    return Plot(key, key, unit, (
        Curve('upper', f'{symbol} + 2 std', own, 'vector.x', 1.0, BAND, 0.8, std, 2.0),
        Curve('lower', f'{symbol} - 2 std', own, 'vector.x', 1.0, BAND, 0.8, std, -2.0),
        Curve('estimate', symbol, own, 'vector.x', 1.0, BLUE, 1.8),
    ))


_POSITION = 'points[0].positions[0]'
PLOTS = (
    Plot('force', 'pressing force', 'N', (
        Curve('measured', '-F_e measured', 'wrench', 'wrench.force.x', -1.0, MUTED),
        Curve('desired', 'F_r desired', 'reference_trajectory', 'points[0].effort[0]', 1.0,
              ORANGE, 1.5),
    )),
    Plot('motion', 'position', 'mm', (
        Curve('desired', 'x_d desired', 'desired_trajectory', _POSITION, 1e3, BAND, 2.5),
        Curve('reference', 'x_r reference', 'reference_trajectory', _POSITION, 1e3, ORANGE, 1.5),
        Curve('measured', 'x measured', 'joint_states', 'position[0]', 1e3, MUTED, 1.5),
    ), 'm'),
    _estimate('stiffness', 'N/m', 'K_e'),
    _estimate('damping', 'N s/m', 'B_e'),
    Plot('model_fit', 'residual', 'std of the noise', (
        Curve('ratio', 'model fit', 'estimator_node/model_fit', 'data', 1.0, BLUE, 1.5),
    )),
)
"""All plots, from top to bottom; topics as the loop records them."""

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
                [_foxglove_series(topic, curve.field, 'std', curve.colour)])
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
        _foxglove_series(curve.topic, curve.field + _modifier(curve), curve.label, curve.colour)
        for curve in plot.curves if not curve.std_topic])


def _modifier(curve: Curve) -> str:
    return '.@negative' if curve.scale < 0.0 else ''


def _foxglove_series(topic: str, path: str, label: str, colour: str) -> dict[str, Any]:
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


_JOINT = 'contact_x'  # of the loop: PlotJuggler names the series of a joint by the joint
_MODE = {'mode': 'TimeSeries', 'style': 'Lines', 'flip_x': 'false', 'flip_y': 'false'}


def plotjuggler_layout() -> str:
    """Return the layout."""
    root = ElementTree.Element('root')
    widget = _child(root, 'tabbed_widget', parent='main_window', name='Main Window')
    tab = _child(widget, 'Tab', tab_name='contact', containers='1')
    count = len(PLOTS)
    splitter = _child(
        _child(tab, 'Container'), 'DockSplitter', orientation='-', count=str(count),
        sizes=';'.join([f'{1.0 / count:.6f}'] * count))
    for plot in PLOTS:
        _add_plot(splitter, plot)
    _child(widget, 'currentTabIndex', index='0')
    _child(root, 'use_relative_time_offset', enabled='1')
    equations = _child(root, 'customMathEquations')
    for plot in PLOTS:
        for curve in plot.curves:
            _add_equation(equations, plot, curve)
    ElementTree.indent(root)
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{_text(root)}\n'


def series_name(topic: str, field: str) -> str:
    """Return how PlotJuggler names a field; field: as in 'points[0].positions[0]'."""
    if topic == 'joint_states':
        quantity = re.sub(r'\[\d+\]', '', field)
        return f'/{topic}/{_JOINT}/{quantity}'
    return f'/{topic}/{field.replace(".", "/")}'


def _add_plot(splitter: ElementTree.Element, plot: Plot) -> None:
    area = _child(splitter, 'DockArea', name=plot.title)
    element = _child(area, 'plot', **_MODE)
    _child(element, 'limitY')
    for curve in plot.curves:
        _child(element, 'curve', name=_name(plot, curve), color=curve.colour)


def _add_equation(equations: ElementTree.Element, plot: Plot, curve: Curve) -> None:
    snippet = _child(equations, 'snippet', name=_name(plot, curve))
    _child(snippet, 'global')
    factor = '' if curve.scale == 1.0 else f'{curve.scale:g} * '
    band = f' + {curve.stds:g} * v1' if curve.std_topic else ''
    _child(snippet, 'function').text = f'return {factor}value{band}'.replace('+ -', '- ')
    _child(snippet, 'linked_source').text = series_name(curve.topic, curve.field)
    if curve.std_topic:
        sources = _child(snippet, 'additional_sources')
        _child(sources, 'v1').text = series_name(curve.std_topic, curve.field)


def _name(plot: Plot, curve: Curve) -> str:
    return f'{plot.quantity}/{curve.label}'


def _child(above: ElementTree.Element, tag: str, /, **attributes: str) -> ElementTree.Element:
    return ElementTree.SubElement(above, tag, attributes)


def _text(root: ElementTree.Element) -> str:
    return ElementTree.tostring(root, encoding='unicode')
