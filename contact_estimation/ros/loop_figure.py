# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0


"""The figure of one run of the loop: force, motion, stiffness and damping."""

from __future__ import annotations

from typing import Any

from .loop_run import RecordedRun
from ..estimation.contact_figure import plot_contact
from ..plant.plant_parameters import WallParameters


def plot_run(
    run: RecordedRun, title: str, wall: WallParameters, force_note: str = '', warning: str = ''
) -> Any:
    """
    Plot a run.

    Parameters
    ----------
    run : RecordedRun
        What was recorded.
    title : str
        Above the figure.
    wall : WallParameters
        The true K_e and B_e.
    force_note, warning : str
        Under the force and below the title; '' for none.

    Returns
    -------
    figure : matplotlib.figure.Figure
        Four axes with a common time.

    """
    true = {'stiffness': wall.stiffness, 'damping': wall.damping}
    return plot_contact(run.series, title, true, force_note, warning)
