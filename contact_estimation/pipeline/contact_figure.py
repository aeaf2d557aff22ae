# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The figure of a contact over time: force, motion, stiffness and damping with their bands."""

from __future__ import annotations

from typing import Any, Mapping

import numpy as np
from numpy.typing import NDArray

from ..figures import BLUE, figure_style, INK, MUTED, new_figure, ORANGE
from ..recordings.recorded_signals import RecordedSignals, Signal

Series = NDArray[np.float64]

_QUANTITIES = {'stiffness': 'K_e [N/m]', 'damping': 'B_e [N s/m]'}
_NOTHING = np.empty((0, 2))
_MOST = 40_000  # points of a signal: more than a picture shows


@figure_style()
def plot_contact(
    series: Mapping[str, Series], title: str, true: Mapping[str, float] | None = None,
    force_note: str = '', warning: str = '',
) -> Any:
    """
    Plot a contact.

    series (N, 2): time [s] and value of force, desired_force, position, desired and reference; of
    stiffness, damping, stiffness_std and damping_std where they are estimated. What is missing or
    empty is not plotted.
    true: True stiffness and damping, where they are known
    """
    shown = {name: label for name, label in _QUANTITIES.items() if name in series}
    count = 2 + len(shown)
    figure, axes = new_figure((9.0, 2.5 * count), count, sharex=True)
    figure.suptitle(title, x=0.01, ha='left', fontsize=12)
    if warning:
        axes[0].set_title(warning, color=ORANGE)
    _plot_force(axes[0], series, force_note)
    _plot_motion(axes[1], series)
    for axis, (name, label) in zip(axes[2:], shown.items()):
        _plot_estimate(axis, series, name, (true or {}).get(name), label)
    axes[-1].set_xlabel('time [s]')
    for axis in axes:
        axis.legend(loc='upper left', ncols=3)
    return figure


def signal_series(signals: RecordedSignals) -> dict[str, Series]:
    """
    Return the signals of a recording over time since its first wrench, thinned for a picture.

    Returns series (N, 2): force, position, reference and desired_force, as in `plot_contact`
    """
    begin = int(signals.wrench.stamp_ns[0])

    def over_time(signal: Signal, row: int) -> Series:
        step = 1 + len(signal) // _MOST
        t = (signal.stamp_ns[::step] - begin) * 1e-9
        return np.column_stack((t, signal.values[row, ::step]))

    reference = signals.reference_trajectory
    series = {'force': over_time(signals.wrench, 0),
              'position': over_time(signals.joint_states, 0)}
    if len(reference):
        series['reference'] = over_time(reference, 0)
        if np.any(reference.values[3]):
            series['desired_force'] = over_time(reference, 3)
    return series


def _plot_force(axis: Any, series: Mapping[str, Series], note: str) -> None:
    force, desired = series['force'], series.get('desired_force', _NOTHING)
    axis.plot(force[:, 0], -force[:, 1], color=INK, linewidth=0.7, label='-F_e measured')
    if len(desired):
        axis.plot(desired[:, 0], desired[:, 1], color=ORANGE, linewidth=1.0, label='F_r desired')
    axis.set_ylabel('pressing force [N]')
    if note:
        axis.set_xlabel(note, loc='left', color=INK)


def _plot_motion(axis: Any, series: Mapping[str, Series]) -> None:
    for name, colour, width, label in (
        ('desired', MUTED, 2.0, 'x_d desired'),
        ('reference', ORANGE, 1.0, 'x_r reference'),
        ('position', INK, 1.0, 'x measured'),
    ):
        if name in series:
            own = series[name]
            axis.plot(own[:, 0], 1e3 * own[:, 1], color=colour, linewidth=width, label=label)
    axis.set_ylabel('position [mm]')


def _plot_estimate(
    axis: Any, series: Mapping[str, Series], name: str, true: float | None, label: str
) -> None:
    own, std = series[name], series.get(f'{name}_std', _NOTHING)
    high = 1.0
    if true is not None:
        axis.axhline(true, color=ORANGE, linewidth=1.0, label=f'true {true:g}')
        high = 1.5 * true or high
    if len(own):
        t, value = own[:, 0], own[:, 1]
        axis.plot(t, value, color=BLUE, linewidth=1.2, label='estimate')
        if len(std) and np.isfinite(std[:, 1]).any():
            band = 2.0 * np.interp(t, std[:, 0], std[:, 1])
            axis.fill_between(t, value - band, value + band, color=BLUE, alpha=0.2,
                              linewidth=0, label='± 2 std')
        high = max(high, float(np.nanpercentile(value, 99)))
    axis.set_ylim(0.0, 1.1 * high)  # room for the legend
    axis.set_ylabel(label)
