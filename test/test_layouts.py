# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The layouts of PlotJuggler and Foxglove; `test_loop_command` compares them with a recording."""

from __future__ import annotations


from contact_estimation.commands.write_config import config_files
from contact_estimation.watch.plots import PLOTS
from layout_fields import of_foxglove, of_plotjuggler

FILES = config_files()
SOURCES = {(f'/{curve.topic}', curve.field) for plot in PLOTS for curve in plot.curves}
SOURCES |= {(f'/{curve.std_topic}', curve.field) for plot in PLOTS for curve in plot.curves
            if curve.std_topic}


def test_plotjuggler_reads_what_the_view_shows() -> None:
    topics = sorted({topic for topic, _ in SOURCES}, key=len, reverse=True)
    expected = {(topic, field if topic != '/joint_states' else 'contact_x.position')
                for topic, field in SOURCES}
    assert of_plotjuggler(FILES['plotjuggler.xml'], topics) == expected


def test_foxglove_reads_what_the_view_shows_and_status_and_diagnostics() -> None:
    assert of_foxglove(FILES['foxglove.json']) == SOURCES | {
        ('/estimator_node/status', 'data'), ('/diagnostics', '')}
