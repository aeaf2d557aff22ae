# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The layout of PlotJuggler: every curve as a custom series, with the unit of its plot."""

from __future__ import annotations

import re
from xml.etree import ElementTree

from .plots import Curve, Plot, PLOTS

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
    """
    Return how PlotJuggler names a field.

    field: as in 'points[0].positions[0]'
    """
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
