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

"""One picture of a run of the loop: force, motion, stiffness and damping."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from .loop_run import LoopRun
from ..optional_packages import require_matplotlib

_INK, _MUTED, _ESTIMATE, _TRUE = '#1f2933', '#9aa5b1', '#0b6e99', '#c2410c'


def draw_picture(
    run: LoopRun, title: str, stiffness: float, damping: float, path: Path
) -> None:
    """
    Draw a run.

    Parameters
    ----------
    run : LoopRun
        What was recorded.
    title : str
        Above the picture.
    stiffness, damping : float
        The true K_e [N/m] and B_e [N s/m].
    path : Path
        PNG to write.

    """
    pyplot = require_matplotlib()
    figure, axes = pyplot.subplots(4, 1, figsize=(9.0, 10.0), sharex=True,
                                   layout='constrained')
    figure.suptitle(title, color=_INK, x=0.01, ha='left', fontsize=12)
    _draw_force(axes[0], run)
    _draw_motion(axes[1], run)
    _draw_estimate(axes[2], run, 'stiffness', stiffness, 'K_e [N/m]')
    _draw_estimate(axes[3], run, 'damping', damping, 'B_e [N s/m]')
    axes[3].set_xlabel('time [s]')
    for axis in axes:
        axis.spines[['top', 'right']].set_visible(False)
        axis.grid(color='#e4e7eb', linewidth=0.6)
        axis.legend(frameon=False, fontsize=8, loc='upper left', ncols=3)
    figure.savefig(path, dpi=130)
    pyplot.close(figure)


def _draw_force(axis: Any, run: LoopRun) -> None:
    force, wanted = run.series['force'], run.series['desired_force']
    axis.plot(force[:, 0], -force[:, 1], color=_INK, linewidth=0.7, label='measured, pressing')
    if len(wanted):
        axis.plot(wanted[:, 0], wanted[:, 1], color=_TRUE, linewidth=1.0, label='F_r wanted')
    axis.set_ylabel('force [N]')


def _draw_motion(axis: Any, run: LoopRun) -> None:
    for name, colour, width, label in (
        ('desired', _MUTED, 2.0, 'x_d desired'),
        ('reference', _TRUE, 1.0, 'x_r reference'),
        ('position', _INK, 1.0, 'x measured'),
    ):
        series = run.series[name]
        axis.plot(series[:, 0], 1e3 * series[:, 1], color=colour, linewidth=width, label=label)
    axis.set_ylabel('position [mm]')


def _draw_estimate(axis: Any, run: LoopRun, name: str, true: float, label: str) -> None:
    series, std = run.series[name], run.series[f'{name}_std']
    axis.axhline(true, color=_TRUE, linewidth=1.0, label=f'true {true:g}')
    if len(series):
        t, value = series[:, 0], series[:, 1]
        axis.plot(t, value, color=_ESTIMATE, linewidth=1.2, label='estimate')
        if len(std) and np.isfinite(std[:, 1]).any():
            band = 2.0 * np.interp(t, std[:, 0], std[:, 1])
            axis.fill_between(t, value - band, value + band, color=_ESTIMATE, alpha=0.2,
                              linewidth=0, label='+- 2 std')
        high = max(1.6 * true, 1.1 * float(np.nanpercentile(value, 99)))
        axis.set_ylim(0.0, high if high > 0.0 else 1.0)
    axis.set_ylabel(label)
