# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0


"""The figure of one run of the loop: force, motion, stiffness and damping."""

from __future__ import annotations

from typing import Any

from .loop_run import RecordedRun
from ..pipeline.estimate_files import plot_contact
from ..plant.plant_parameters import WallParameters


def plot_run(
    run: RecordedRun, title: str, wall: WallParameters, force_note: str = '', warning: str = ''
) -> Any:
    """Plot a run."""
    true = {'stiffness': wall.stiffness, 'damping': wall.damping}
    return plot_contact(run.series, title, true, force_note, warning)
