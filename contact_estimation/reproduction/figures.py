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

"""Counterparts of the paper's figures: 5 to 9 here, 10 to 17 in `testbed_figures`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from .cases import CASES, OnlineCase
from .runs import B_E, K_E, simulate, step_recording
from .testbed_figures import draw_testbed_figures
from ..estimators.signal_processing import FFT_POINTS, SETTLED, step_response
from ..optional_packages import require_matplotlib

_COLOURS = ('#0b6e99', '#c2410c', '#d4a017', '#4d7c0f', '#7c3aed')
_TRUE = '#9aa5b1'


def draw_figures(folder: Path) -> list[Path]:
    """
    Draw all figures with seed 0.

    Parameters
    ----------
    folder : Path
        Made where it does not exist.

    Returns
    -------
    paths : list of Path
        The PNG files.

    """
    pyplot = require_matplotlib()
    folder.mkdir(parents=True, exist_ok=True)
    return [
        _trajectory(pyplot, folder / 'figure_05_trajectory.png'),
        _estimates(pyplot, 6, 'simulation_sine', folder / 'figure_06_with_excitation.png'),
        *_signal_processing(pyplot, folder),
        _estimates(pyplot, 9, 'simulation_none', folder / 'figure_09_without_excitation.png'),
        *draw_testbed_figures(pyplot, folder),
    ]


def _online(case: str) -> list[OnlineCase]:
    return [c for c in CASES if isinstance(c, OnlineCase) and c.case == case]


def _save(pyplot: Any, figure: Any, path: Path) -> Path:
    for axis in figure.axes:
        axis.spines[['top', 'right']].set_visible(False)
        axis.grid(color='#e4e7eb', linewidth=0.6)
    figure.savefig(path, dpi=130)
    pyplot.close(figure)
    return path


def _trajectory(pyplot: Any, path: Path) -> Path:
    experiment = _online('simulation_none')[0].experiment()
    t = np.arange(0.0, experiment.duration, 0.01)
    figure, axis = pyplot.subplots(figsize=(8.0, 3.5), layout='constrained')
    axis.plot(t, [experiment.desired(s).position for s in t.tolist()], color=_COLOURS[0],
              label='reference trajectory x_d')
    axis.axhline(0.0, color=_TRUE, label='wall x_e')
    axis.set(xlabel='time [s]', ylabel='position [m]',
             title='Fig. 5: trajectory of the manipulator')
    axis.legend(frameon=False)
    return _save(pyplot, figure, path)


def _estimates(pyplot: Any, number: int, case: str, path: Path) -> Path:
    figure, axes = pyplot.subplots(2, 1, figsize=(8.0, 7.0), sharex=True, layout='constrained')
    for online, colour in zip(_online(case), _COLOURS, strict=True):
        run = simulate(online, 0)
        t = [truth.t for truth in run.truths]
        name = online.estimator + online.variant
        look: dict[str, Any] = {'color': colour, 'label': f'{name}, {online.law}'}
        axes[0].plot(t, [r.estimate.stiffness for r in run.results], **look)
        axes[1].plot(t, [r.estimate.damping for r in run.results], **look)
    for axis, true, name in zip(axes, (K_E, B_E), ('stiffness [N/m]', 'damping [kg/s]')):
        axis.axhline(true, color=_TRUE, zorder=0)
        axis.set(ylabel=name, ylim=(0.0, 1.6 * true), xlim=(5.5, 9.6))
    axes[0].set_title(f'Fig. {number}: {case}, seed 0')
    axes[0].legend(frameon=False, fontsize=8)
    axes[1].set_xlabel('time [s]')
    return _save(pyplot, figure, path)


def _signal_processing(pyplot: Any, folder: Path) -> list[Path]:
    t, force = step_response(step_recording(0))
    steady = float(np.mean(force[len(force) // 2:]))
    figure, axis = pyplot.subplots(figsize=(8.0, 3.5), layout='constrained')
    axis.plot(t, force, color=_COLOURS[0], label='measured force')
    for bound in (1.0 - SETTLED, 1.0 + SETTLED):
        axis.axhline(bound * steady, color=_COLOURS[1], linestyle='--', linewidth=0.8,
                     label='5 % bounds' if bound < 1.0 else None)
    axis.set(xlabel='time since the step [s]', ylabel='force [N]',
             title='Fig. 7: force response for signal processing')
    axis.legend(frameon=False)
    first = _save(pyplot, figure, folder / 'figure_07_step_response.png')
    part = force[:FFT_POINTS]
    magnitude = np.abs(np.fft.rfft(part - np.mean(part)))
    frequency = np.fft.rfftfreq(FFT_POINTS, float(t[1] - t[0]))
    figure, axis = pyplot.subplots(figsize=(8.0, 3.5), layout='constrained')
    axis.stem(frequency[:31], magnitude[:31], basefmt=' ')
    axis.set(xlabel='frequency [Hz]', ylabel='magnitude',
             title='Fig. 8: frequency response of the contact force')
    return [first, _save(pyplot, figure, folder / 'figure_08_spectrum.png')]
