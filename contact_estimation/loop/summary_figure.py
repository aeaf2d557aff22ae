# Copyright 2026 contact_estimation authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.


"""The figure of one run of the loop: force, motion, stiffness and damping."""

from __future__ import annotations

from typing import Any

import numpy as np

from .recorded_run import RecordedRun
from ..figures import BLUE, figure_style, INK, MUTED, new_figure, ORANGE
from ..plant.plant_parameters import WallParameters


@figure_style()
def plot_run(run: RecordedRun, title: str, wall: WallParameters) -> Any:
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

    Returns
    -------
    figure : matplotlib.figure.Figure
        Four axes with a common time.

    """
    figure, axes = new_figure((9.0, 10.0), 4, sharex=True)
    figure.suptitle(title, x=0.01, ha='left', fontsize=12)
    _plot_force(axes[0], run)
    _plot_motion(axes[1], run)
    _plot_estimate(axes[2], run, 'stiffness', wall.stiffness, 'K_e [N/m]')
    _plot_estimate(axes[3], run, 'damping', wall.damping, 'B_e [N s/m]')
    axes[3].set_xlabel('time [s]')
    for axis in axes:
        axis.legend(loc='upper left', ncols=3)
    return figure


def _plot_force(axis: Any, run: RecordedRun) -> None:
    force, desired = run.series['force'], run.series['desired_force']
    axis.plot(force[:, 0], -force[:, 1], color=INK, linewidth=0.7, label='-F_e measured')
    if len(desired):
        axis.plot(desired[:, 0], desired[:, 1], color=ORANGE, linewidth=1.0, label='F_r desired')
    axis.set_ylabel('pressing force [N]')


def _plot_motion(axis: Any, run: RecordedRun) -> None:
    for name, colour, width, label in (
        ('desired', MUTED, 2.0, 'x_d desired'),
        ('reference', ORANGE, 1.0, 'x_r reference'),
        ('position', INK, 1.0, 'x measured'),
    ):
        series = run.series[name]
        axis.plot(series[:, 0], 1e3 * series[:, 1], color=colour, linewidth=width, label=label)
    axis.set_ylabel('position [mm]')


def _plot_estimate(axis: Any, run: RecordedRun, name: str, true: float, label: str) -> None:
    series, std = run.series[name], run.series[f'{name}_std']
    axis.axhline(true, color=ORANGE, linewidth=1.0, label=f'true {true:g}')
    if len(series):
        t, value = series[:, 0], series[:, 1]
        axis.plot(t, value, color=BLUE, linewidth=1.2, label='estimate')
        if len(std) and np.isfinite(std[:, 1]).any():
            band = 2.0 * np.interp(t, std[:, 0], std[:, 1])
            axis.fill_between(t, value - band, value + band, color=BLUE, alpha=0.2,
                              linewidth=0, label='± 2 std')
        high = max(1.6 * true, 1.1 * float(np.nanpercentile(value, 99)))
        axis.set_ylim(0.0, high if high > 0.0 else 1.0)
    axis.set_ylabel(label)
