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

"""Counterparts of the paper's experimental figures, 10 to 17, from the testbed."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from .testbed_cases import LONG_HOLD_S, online_cases, TestbedCase
from .testbed_runs import B_E, K_E, record_step, simulate_testbed
from ..estimators.signal_processing import FFT_POINTS, SETTLED, step_response
from ..plant.closed_loop import ClosedLoopRun

_COLOURS = ('#0b6e99', '#c2410c', '#7c3aed')
_TRUE = '#9aa5b1'
_BEFORE, _AFTER = 0.4, 0.3  # shown around the contact [s]

Runs = list[tuple[TestbedCase, ClosedLoopRun]]


def draw_testbed_figures(pyplot: Any, folder: Path) -> list[Path]:
    """
    Draw figures 10 to 17 with seed 0, and the step response behind signal processing.

    Parameters
    ----------
    pyplot : module
        matplotlib.pyplot.
    folder : Path
        Exists.

    Returns
    -------
    paths : list of Path
        The PNG files.

    """
    sine, sine_long = _run('sine'), _run('sine', LONG_HOLD_S)
    prbs, prbs_long = _run('prbs'), _run('prbs', LONG_HOLD_S)
    return [
        _trajectories(pyplot, sine, folder / 'figure_10_testbed_trajectories.png'),
        _profiles(pyplot, 11, sine, folder / 'figure_11_testbed_sine_profiles.png'),
        _estimates(pyplot, 12, sine, folder / 'figure_12_testbed_sine.png'),
        _profiles(pyplot, 13, sine_long, folder / 'figure_13_testbed_long_profiles.png'),
        _estimates(pyplot, 14, sine_long, folder / 'figure_14_testbed_long.png'),
        _estimates(pyplot, 15, prbs, folder / 'figure_15_testbed_prbs.png'),
        _estimates(pyplot, 16, prbs_long, folder / 'figure_16_testbed_prbs_long.png'),
        _estimates(pyplot, 17, _run('none'), folder / 'figure_17_testbed_none.png'),
        _step_response(pyplot, folder / 'testbed_signal_processing.png'),
    ]


def _run(excitation: str, hold_s: float = 2.0) -> Runs:
    name = f'testbed_{excitation}' + ('_long' if hold_s == LONG_HOLD_S else '')
    return [(case, simulate_testbed(case, 0)) for case in online_cases(name, excitation, hold_s)]


def _times(run: ClosedLoopRun) -> list[float]:
    return [truth.t for truth in run.truths]


def _contact(run: ClosedLoopRun) -> tuple[float, float]:
    touching = [truth.t for truth in run.truths if truth.force < 0.0]
    return touching[0] - _BEFORE, touching[-1] + _AFTER


def _save(pyplot: Any, figure: Any, path: Path) -> Path:
    for axis in figure.axes:
        axis.spines[['top', 'right']].set_visible(False)
        axis.grid(color='#e4e7eb', linewidth=0.6)
    figure.savefig(path, dpi=130)
    pyplot.close(figure)
    return path


def _trajectories(pyplot: Any, runs: Runs, path: Path) -> Path:
    figure, axis = pyplot.subplots(figsize=(8.0, 4.0), layout='constrained')
    for (case, run), colour in zip(runs[:2], _COLOURS):
        # The reference made of a sample is followed one sample later.
        x_r = [r.reference.position if r.reference else np.nan for r in run.results]
        axis.plot(_times(run), x_r, color=colour, label=f'x_r, {case.estimator} ({case.law})')
    run = runs[0][1]
    axis.plot(_times(run), [truth.position for truth in run.truths], color=_TRUE,
              label=f'wall, {runs[0][0].estimator}')
    axis.set(xlabel='time [s]', ylabel='position [m]', xlim=_contact(run), ylim=(-0.01, 0.03),
             title='Fig. 10: reference trajectories on the testbed, sine excitation')
    axis.legend(frameon=False, fontsize=8)
    return _save(pyplot, figure, path)


def _profiles(pyplot: Any, number: int, runs: Runs, path: Path) -> Path:
    case, run = runs[0]
    figure, axes = pyplot.subplots(2, 1, figsize=(8.0, 6.0), sharex=True, layout='constrained')
    axes[0].plot(_times(run), [-r.sample.force for r in run.results], color=_COLOURS[0])
    axes[1].plot(_times(run), [1e3 * r.sample.position for r in run.results], color=_COLOURS[0])
    axes[0].set(ylabel='contact force [N]', xlim=_contact(run),
                title=f'Fig. {number}: {case.case}, {case.estimator}, as processed, seed 0')
    axes[1].set(xlabel='time [s]', ylabel='wall deflection [mm]')
    return _save(pyplot, figure, path)


def _estimates(pyplot: Any, number: int, runs: Runs, path: Path) -> Path:
    figure, axes = pyplot.subplots(2, 1, figsize=(8.0, 7.0), sharex=True, layout='constrained')
    for (case, run), colour in zip(runs, _COLOURS):
        look = {'color': colour, 'label': f'{case.estimator} ({case.law})'}
        axes[0].plot(_times(run), [r.estimate.stiffness for r in run.results], **look)
        axes[1].plot(_times(run), [r.estimate.damping for r in run.results], **look)
    for axis, true, top, name in zip(
        axes, (K_E, B_E), (1.6, 2.5), ('stiffness [N/m]', 'damping [kg/s]')
    ):
        axis.axhline(true, color=_TRUE, zorder=0)
        axis.set(ylabel=name, ylim=(0.0, top * true), xlim=_contact(runs[0][1]))
    axes[0].set_title(f'Fig. {number}: {runs[0][0].case}, seed 0')
    axes[0].legend(frameon=False, fontsize=8)
    axes[1].set_xlabel('time [s]')
    return _save(pyplot, figure, path)


def _step_response(pyplot: Any, path: Path) -> Path:
    t, force = step_response(record_step(0, as_paper=True))
    steady = float(np.mean(force[len(force) // 2:]))
    figure, axes = pyplot.subplots(2, 1, figsize=(8.0, 6.0), layout='constrained')
    axes[0].plot(t, force, color=_COLOURS[0], label='force, as processed')
    for bound in (1.0 - SETTLED, 1.0 + SETTLED):
        axes[0].axhline(bound * steady, color=_COLOURS[1], linestyle='--', linewidth=0.8,
                        label='5 % bounds' if bound < 1.0 else None)
    axes[0].set(xlabel='time since the step [s]', ylabel='force [N]',
                title='Step response on the testbed for signal processing')
    axes[0].legend(frameon=False)
    part = force[:FFT_POINTS]
    magnitude = np.abs(np.fft.rfft(part - np.mean(part)))
    frequency = np.fft.rfftfreq(FFT_POINTS, float(t[1] - t[0]))
    axes[1].stem(frequency[:31], magnitude[:31], basefmt=' ')
    axes[1].set(xlabel='frequency [Hz]', ylabel='magnitude')
    return _save(pyplot, figure, path)
