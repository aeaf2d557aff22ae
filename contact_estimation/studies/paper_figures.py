# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Counterparts of the paper's figures: 5 to 9 simulated, 10 to 17 on the testbed."""

from pathlib import Path
from typing import Any, Sequence

import numpy as np

from .paper_cases import ALL_CASES, Case, PRBS_LONG, record_testbed_step, STEP, step_recording
from .testbed_arm import B_E, K_E
from ..estimators.signal_processing import FFT_POINTS, SETTLED, step_response
from ..figures import require_matplotlib
from ..physics.numeric import Array
from ..plant.closed_loop import ClosedLoopRun

_COLOURS = ('#0b6e99', '#c2410c', '#d4a017', '#4d7c0f', '#7c3aed')
_TESTBED_COLOURS = (_COLOURS[0], _COLOURS[1], _COLOURS[4])  # of the same estimators
_TRUE = '#9aa5b1'
_BEFORE, _AFTER = 0.4, 0.3  # shown around the contact [s]

Runs = list[tuple[Case, ClosedLoopRun]]


def plot_figures(folder: Path) -> list[Path]:
    """Plot all figures with seed 0."""
    folder.mkdir(parents=True, exist_ok=True)
    sine, long = _runs('testbed_sine'), _runs('testbed_sine_long')
    return [
        _trajectory(folder / 'figure_05_trajectory.png'),
        _simulated(6, 'simulation_sine', folder / 'figure_06_with_excitation.png'),
        *_signal_processing(folder),
        _simulated(9, 'simulation_none', folder / 'figure_09_without_excitation.png'),
        _trajectories(sine, folder / 'figure_10_testbed_trajectories.png'),
        _profiles(11, sine, folder / 'figure_11_testbed_sine_profiles.png'),
        _measured(12, sine, folder / 'figure_12_testbed_sine.png'),
        _profiles(13, long, folder / 'figure_13_testbed_long_profiles.png'),
        _measured(14, long, folder / 'figure_14_testbed_long.png'),
        *(_measured(n, _runs(name), folder / f'figure_{n}_{name}.png') for n, name in (
            (15, 'testbed_prbs'), (16, 'testbed_prbs_long'), (17, 'testbed_none'))),
        _testbed_signal_processing(folder / 'testbed_signal_processing.png'),
    ]


def _cases(name: str) -> list[Case]:
    return [c for c in (*ALL_CASES, *PRBS_LONG) if c.case == name and c.law != STEP]


def _runs(name: str) -> Runs:
    return [(case, case.simulate(0)) for case in _cases(name)]


def _times(run: ClosedLoopRun) -> list[float]:
    return [truth.t for truth in run.truths]


def _contact(run: ClosedLoopRun) -> tuple[float, float]:
    touching = [truth.t for truth in run.truths if truth.force < 0.0]
    return touching[0] - _BEFORE, touching[-1] + _AFTER


def _panels(height: float, rows: int = 1, **options: Any) -> tuple[Any, Any]:
    return require_matplotlib().subplots(  # type: ignore[no-any-return]
        rows, 1, figsize=(8.0, height), layout='constrained', **options)


def _save(figure: Any, path: Path) -> Path:
    for axis in figure.axes:
        axis.spines[['top', 'right']].set_visible(False)
        axis.grid(color='#e4e7eb', linewidth=0.6)
    figure.savefig(path, dpi=130)
    require_matplotlib().close(figure)
    return path


def _trajectory(path: Path) -> Path:
    experiment = _cases('simulation_none')[0].experiment()
    t = np.arange(0.0, experiment.duration, 0.01)
    figure, axis = _panels(3.5)
    axis.plot(t, [experiment.desired(s).position for s in t.tolist()], color=_COLOURS[0],
              label='reference trajectory x_d')
    axis.axhline(0.0, color=_TRUE, label='wall x_e')
    axis.set(xlabel='time [s]', ylabel='position [m]',
             title='Fig. 5: trajectory of the manipulator')
    axis.legend(frameon=False)
    return _save(figure, path)


def _trajectories(runs: Runs, path: Path) -> Path:
    figure, axis = _panels(4.0)
    for (case, run), colour in zip(runs[:2], _TESTBED_COLOURS):
        # The reference made of a sample is followed one sample later.
        x_r = [r.reference.position if r.reference else np.nan for r in run.results]
        axis.plot(_times(run), x_r, color=colour, label=f'x_r, {case.estimator} ({case.law})')
    case, run = runs[0]
    axis.plot(_times(run), [truth.position for truth in run.truths], color=_TRUE,
              label=f'wall, {case.estimator}')
    axis.set(xlabel='time [s]', ylabel='position [m]', xlim=_contact(run), ylim=(-0.01, 0.03),
             title='Fig. 10: reference trajectories on the testbed, sine excitation')
    axis.legend(frameon=False, fontsize=8)
    return _save(figure, path)


def _profiles(number: int, runs: Runs, path: Path) -> Path:
    case, run = runs[0]
    figure, axes = _panels(6.0, 2, sharex=True)
    axes[0].plot(_times(run), [-r.sample.force for r in run.results], color=_COLOURS[0])
    axes[1].plot(_times(run), [1e3 * r.sample.position for r in run.results], color=_COLOURS[0])
    axes[0].set(ylabel='contact force [N]', xlim=_contact(run),
                title=f'Fig. {number}: {case.case}, {case.estimator}, as processed, seed 0')
    axes[1].set(xlabel='time [s]', ylabel='wall deflection [mm]')
    return _save(figure, path)


def _simulated(number: int, name: str, path: Path) -> Path:
    runs = _runs(name)
    labels = [f'{case.estimator}{case.variant}, {case.law}' for case, _ in runs]
    return _estimates(number, runs, labels, _COLOURS, 1.6 * B_E, (5.5, 9.6), path)


def _measured(number: int, runs: Runs, path: Path) -> Path:
    labels = [f'{case.estimator} ({case.law})' for case, _ in runs]
    return _estimates(
        number, runs, labels, _TESTBED_COLOURS, 2.5 * B_E, _contact(runs[0][1]), path)


def _estimates(
    number: int, runs: Runs, labels: Sequence[str], colours: Sequence[str], greatest_B: float,
    shown: tuple[float, float], path: Path,
) -> Path:
    """Plot K_e and B_e of all runs over time."""
    figure, axes = _panels(7.0, 2, sharex=True)
    for (_, run), label, colour in zip(runs, labels, colours, strict=True):
        look: dict[str, Any] = {'color': colour, 'label': label}
        axes[0].plot(_times(run), [r.estimate.stiffness for r in run.results], **look)
        axes[1].plot(_times(run), [r.estimate.damping for r in run.results], **look)
    for axis, true, top, name in (
        (axes[0], K_E, 1.6 * K_E, 'stiffness [N/m]'), (axes[1], B_E, greatest_B, 'damping [kg/s]'),
    ):
        axis.axhline(true, color=_TRUE, zorder=0)
        axis.set(ylabel=name, ylim=(0.0, top), xlim=shown)
    axes[0].set_title(f'Fig. {number}: {runs[0][0].case}, seed 0')
    axes[0].legend(frameon=False, fontsize=8)
    axes[1].set_xlabel('time [s]')
    return _save(figure, path)


def _signal_processing(folder: Path) -> list[Path]:
    t, force = step_response(step_recording(0))
    paths = []
    for plot, title, name in (
        (_step_force, 'Fig. 7: force response for signal processing', '07_step_response'),
        (_spectrum, 'Fig. 8: frequency response of the contact force', '08_spectrum'),
    ):
        figure, axis = _panels(3.5)
        plot(axis, t, force, 'measured force')
        axis.set_title(title)
        paths.append(_save(figure, folder / f'figure_{name}.png'))
    return paths


def _testbed_signal_processing(path: Path) -> Path:
    t, force = step_response(record_testbed_step(0, as_paper=True))
    figure, axes = _panels(6.0, 2)
    _step_force(axes[0], t, force, 'force, as processed')
    axes[0].set_title('Step response on the testbed for signal processing')
    _spectrum(axes[1], t, force)
    return _save(figure, path)


def _step_force(axis: Any, t: Array, force: Array, label: str) -> None:
    steady = float(np.mean(force[len(force) // 2:]))
    axis.plot(t, force, color=_COLOURS[0], label=label)
    for bound in (1.0 - SETTLED, 1.0 + SETTLED):
        axis.axhline(bound * steady, color=_COLOURS[1], linestyle='--', linewidth=0.8,
                     label='5 % bounds' if bound < 1.0 else None)
    axis.set(xlabel='time since the step [s]', ylabel='force [N]')
    axis.legend(frameon=False)


def _spectrum(axis: Any, t: Array, force: Array, label: str = '') -> None:
    part = force[:FFT_POINTS]
    magnitude = np.abs(np.fft.rfft(part - np.mean(part)))
    frequency = np.fft.rfftfreq(FFT_POINTS, float(t[1] - t[0]))
    axis.stem(frequency[:31], magnitude[:31], basefmt=' ', label=label or None)
    axis.set(xlabel='frequency [Hz]', ylabel='magnitude')
