# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Counterparts of the paper's figures: 5 to 9 simulated, 10 to 17 on the testbed."""

from pathlib import Path
from typing import Any, Iterator, Sequence

import numpy as np

from .paper_cases import ALL_CASES, Case, PRBS_LONG, record_testbed_step, STEP, step_recording
from .testbed_arm import B_E, K_E
from ..estimators.signal_processing import FFT_POINTS, SETTLED, step_response
from ..figures import BLUE, figure_style, MUTED, new_figure, ORANGE
from ..physics.numeric import Array
from ..plant.closed_loop import ClosedLoopRun

_COLOURS = {'indirect_adaptive': BLUE, 'mrac': ORANGE, 'mrac (eq. 25 alone)': '#d4a017',
            'rls': '#4d7c0f', 'kalman': '#7c3aed'}
_BEFORE, _AFTER = 0.4, 0.3  # shown around the contact [s]

Runs = Sequence[tuple[Case, ClosedLoopRun]]


def plot_figures(folder: Path) -> list[Path]:
    """Plot all figures with seed 0."""
    folder.mkdir(parents=True, exist_ok=True)
    paths = []
    with figure_style():
        for name, figure in _figures():
            paths.append(folder / f'{name}.png')
            figure.savefig(paths[-1])
    return paths


def _figures() -> Iterator[tuple[str, Any]]:
    step, sine, long = step_response(step_recording(0)), *map(
        _runs, ('testbed_sine', 'testbed_sine_long'))
    yield 'figure_05_trajectory', _trajectory()
    yield 'figure_06_with_excitation', _estimates(6, _runs('simulation_sine'))
    yield 'figure_07_step_response', _step_response(
        step, 'Fig. 7: force response for signal processing')
    yield 'figure_08_spectrum', _step_response(
        step, 'Fig. 8: frequency response of the contact force', 'spectrum')
    yield 'figure_09_without_excitation', _estimates(9, _runs('simulation_none'))
    yield 'figure_10_testbed_trajectories', _trajectories(sine)
    yield 'figure_11_testbed_sine_profiles', _profiles(11, sine)
    yield 'figure_12_testbed_sine', _estimates(12, sine)
    yield 'figure_13_testbed_long_profiles', _profiles(13, long)
    yield 'figure_14_testbed_long', _estimates(14, long)
    for number, name in (15, 'testbed_prbs'), (16, 'testbed_prbs_long'), (17, 'testbed_none'):
        yield f'figure_{number}_{name}', _estimates(number, _runs(name))
    yield 'testbed_signal_processing', _step_response(
        step_response(record_testbed_step(0, as_paper=True)),
        'Step response on the testbed for signal processing', 'force', 'spectrum')


def _runs(name: str) -> Runs:
    return [(case, case.simulate(0)) for case in (*ALL_CASES, *PRBS_LONG)
            if case.case == name and case.law != STEP]


def _times(run: ClosedLoopRun) -> list[float]:
    return [truth.t for truth in run.truths]


def _contact(run: ClosedLoopRun) -> tuple[float, float]:
    touching = [truth.t for truth in run.truths if truth.force < 0.0]
    return touching[0] - _BEFORE, touching[-1] + _AFTER


def _trajectory() -> Any:
    experiment = next(c for c in ALL_CASES if c.case == 'simulation_none').experiment()
    t = np.arange(0.0, experiment.duration, 0.01)
    figure, axis = new_figure((8.0, 3.5))
    axis.plot(t, [experiment.desired(s).position for s in t.tolist()], color=BLUE,
              label='reference trajectory x_d')
    axis.axhline(0.0, color=MUTED, label='wall x_e')
    axis.set(xlabel='time [s]', ylabel='position [m]',
             title='Fig. 5: trajectory of the manipulator')
    axis.legend()
    return figure


def _trajectories(runs: Runs) -> Any:
    figure, axis = new_figure((8.0, 4.0))
    for case, run in runs[:2]:
        # The reference made of a sample is followed one sample later.
        x_r = [r.reference.position if r.reference else np.nan for r in run.results]
        axis.plot(_times(run), x_r, color=_COLOURS[case.estimator],
                  label=f'x_r, {case.estimator} ({case.law})')
    case, run = runs[0]
    axis.plot(_times(run), [truth.position for truth in run.truths], color=MUTED,
              label=f'wall, {case.estimator}')
    axis.set(xlabel='time [s]', ylabel='position [m]', xlim=_contact(run), ylim=(-0.01, 0.03),
             title='Fig. 10: reference trajectories on the testbed, sine excitation')
    axis.legend()
    return figure


def _profiles(number: int, runs: Runs) -> Any:
    case, run = runs[0]
    figure, axes = new_figure((8.0, 6.0), 2, sharex=True)
    axes[0].plot(_times(run), [-r.sample.force for r in run.results], color=BLUE)
    axes[1].plot(_times(run), [1e3 * r.sample.position for r in run.results], color=BLUE)
    axes[0].set(ylabel='contact force [N]', xlim=_contact(run),
                title=f'Fig. {number}: {case.case}, {case.estimator}, as processed, seed 0')
    axes[1].set(xlabel='time [s]', ylabel='wall deflection [mm]')
    return figure


def _estimates(number: int, runs: Runs) -> Any:
    """Plot K_e and B_e of all runs over time."""
    figure, axes = new_figure((8.0, 7.0), 2, sharex=True)
    first, on_testbed = runs[0], runs[0][0].on_testbed
    for case, run in runs:
        look = {'color': _COLOURS[case.estimator + case.variant],
                'label': f'{case.estimator}{case.variant} ({case.law})'}
        axes[0].plot(_times(run), [r.estimate.stiffness for r in run.results], **look)
        axes[1].plot(_times(run), [r.estimate.damping for r in run.results], **look)
    for axis, true, top, name in (
        (axes[0], K_E, 1.6, 'stiffness [N/m]'),
        (axes[1], B_E, 2.5 if on_testbed else 1.6, 'damping [kg/s]'),
    ):
        axis.axhline(true, color=MUTED, zorder=0)
        axis.set(ylabel=name, ylim=(0.0, top * true),
                 xlim=_contact(first[1]) if on_testbed else (5.5, 9.6))
    axes[0].set_title(f'Fig. {number}: {first[0].case}, seed 0')
    axes[0].legend()
    axes[1].set_xlabel('time [s]')
    return figure


def _step_response(response: tuple[Array, Array], title: str, *parts: str) -> Any:
    """Plot the force after a step, by default, or its spectrum, or both."""
    t, force = response
    figure, axes = new_figure((8.0, 3.0 * max(len(parts), 1)), max(len(parts), 1), squeeze=False)
    for part, axis in zip(parts or ('force',), axes[:, 0]):
        if part == 'force':
            steady = float(np.mean(force[len(force) // 2:]))
            axis.plot(t, force, color=BLUE, label='measured force')
            for bound in (1.0 - SETTLED, 1.0 + SETTLED):
                axis.axhline(bound * steady, color=ORANGE, linestyle='--', linewidth=0.8,
                             label='5 % bounds' if bound < 1.0 else None)
            axis.set(xlabel='time since the step [s]', ylabel='force [N]')
            axis.legend()
        else:
            start = force[:FFT_POINTS]
            magnitude = np.abs(np.fft.rfft(start - np.mean(start)))
            frequency = np.fft.rfftfreq(FFT_POINTS, float(t[1] - t[0]))
            axis.stem(frequency[:31], magnitude[:31], basefmt=' ')
            axis.set(xlabel='frequency [Hz]', ylabel='magnitude')
    axes[0, 0].set_title(title)
    return figure
