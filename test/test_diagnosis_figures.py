# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The figures of a diagnosis: what their axes show."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from contact_estimation.diagnosis.report.figures import COLOURS, plot_comparison, plot_evidence
from contact_estimation.diagnosis.report.plot_data import plot_data
from diagnosed_worlds import diagnosed
import numpy as np
import pytest

pytestmark = pytest.mark.slow

pytest.importorskip('matplotlib')


def line(axis: Any, label: str) -> Any:
    """Return the line with a label."""
    (found,) = (line for line in axis.lines if line.get_label() == label)
    return found


def test_comparison_shows_recording_and_all_models() -> None:
    data = plot_data(diagnosed('friction'))
    whole, close = plot_comparison(data, data.force).axes
    assert [one.get_label() for one in whole.lines] == [
        'recorded', 'nominal', 'recalibrated', 'corrected']
    assert whole.get_ylabel() == 'force [N]' and close.get_xlabel() == 'time [s]'
    np.testing.assert_array_equal(line(close, 'recorded').get_ydata(),
                                  data.force.recorded[data.close_up])
    assert line(whole, 'corrected').get_color() == COLOURS['corrected']


def test_evidence_ranks_candidates_and_colours_named_effects() -> None:
    evidence = {'robot_friction': 0.3, 'coulomb_friction': 0.98, 'force_lag': 0.1}
    d = replace(diagnosed('friction'), evidence=evidence)
    (axis,) = plot_evidence(d).axes
    widths = [bar.get_width() for bar in axis.patches]
    assert widths == sorted(widths, reverse=True)
    assert widths[0] == pytest.approx(98.0)
    names = [label.get_text() for label in axis.get_yticklabels()]
    colours = {bar.get_facecolor() for bar in axis.patches}
    assert 'coulomb friction' in names and len(colours) == 2
