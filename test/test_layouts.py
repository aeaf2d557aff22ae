# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The layouts of PlotJuggler and Foxglove; `test_loop_command` compares them with a recording."""

from __future__ import annotations

import json
from typing import Any, Iterator
from xml.etree import ElementTree

from contact_estimation.commands.write_config import config_files
from contact_estimation.watch.layouts import PLOTS
from layout_fields import of_foxglove, of_plotjuggler

FILES = config_files()
SOURCES = {(f'/{curve.topic}', curve.field) for plot in PLOTS for curve in plot.curves}
SOURCES |= {(f'/{curve.std_topic}', curve.field) for plot in PLOTS for curve in plot.curves
            if curve.std_topic}


def leaves(layout: Any) -> Iterator[str]:
    """Yield the panels of a layout of Foxglove."""
    if isinstance(layout, str):
        yield layout
    else:
        assert layout['direction'] in ('row', 'column') and 0 < layout['splitPercentage'] < 100
        yield from leaves(layout['first'])
        yield from leaves(layout['second'])


def test_plotjuggler_plots_every_curve_with_its_equation() -> None:
    root = ElementTree.fromstring(FILES['plotjuggler.xml'].encode())
    curves = [curve.get('name') for curve in root.iter('curve')]
    equations = [snippet.get('name') for snippet in root.iter('snippet')]
    assert curves == equations and len(set(curves)) == sum(len(plot.curves) for plot in PLOTS)
    functions = {s.get('name'): s.findtext('function') for s in root.iter('snippet')}
    assert functions['pressing force/-F_e measured'] == 'return -1 * value'
    assert functions['stiffness/K_e - 2 std'] == 'return value - 2 * v1'


def test_plotjuggler_reads_what_the_view_shows() -> None:
    topics = sorted({topic for topic, _ in SOURCES}, key=len, reverse=True)
    expected = {(topic, field if topic != '/joint_states' else 'contact_x.position')
                for topic, field in SOURCES}
    assert of_plotjuggler(FILES['plotjuggler.xml'], topics) == expected


def test_foxglove_reads_what_the_view_shows_and_status_and_diagnostics() -> None:
    assert of_foxglove(FILES['foxglove.json']) == SOURCES | {
        ('/estimator_node/status', 'data'), ('/diagnostics', '')}


def test_foxglove_shows_every_panel_once() -> None:
    content = json.loads(FILES['foxglove.json'])
    panels = list(leaves(content['layout']))
    assert sorted(panels) == sorted(content['configById'])


def test_axes_of_foxglove_have_the_units_of_the_messages() -> None:
    titles = {key: panel['foxglovePanelTitle']
              for key, panel in json.loads(FILES['foxglove.json'])['configById'].items()}
    assert titles['Plot!motion'] == 'position [m]'
    assert titles['Plot!stiffness_std'] == 'standard deviation of stiffness [N/m]'
