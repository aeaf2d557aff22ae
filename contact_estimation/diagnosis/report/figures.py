# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
The figures of a diagnosis, each a function of the plot data.

All are 4.8 inches wide: two side by side fill a desktop page, one a telephone. Blue and orange
differ in lightness too, so that they stay apart for the colour-blind and in print.
"""

from math import isfinite
from typing import Any, Mapping, Sequence

import numpy as np

from .plot_data import Comparison, PlotData, Residuals
from .wording import quantity
from ..dependence import Dependence
from ..result import Diagnosis, NamedEffect
from ...figures import BLUE, figure_style, GREY, INK, MUTED, new_figure, OCHRE, ORANGE

COLOURS = {'nominal': GREY, 'recalibrated': ORANGE, 'corrected': BLUE}
_HELD_OUT = '#eef1f4'
_WIDTH = 4.8  # [inch]
_MOST_BARS, _MOST_POINTS = 12, 1500
_SATURATED = 5.0  # colour range [standard deviations]
_CUT_OFF = -100.0, 150.0  # shares that are shown [%]; that of a part with no misfit may be any
_MOST_LETTERS = 60  # of the names of all parts on one line
_SLANTED: Mapping[str, Any] = {'rotation': 30, 'ha': 'right', 'fontsize': 7}


@figure_style()
def plot_comparison(data: PlotData, signal: Comparison) -> Any:
    """Plot a signal, recorded and predicted: all of it, and where the mismatch is greatest."""
    figure, (whole, close) = new_figure((_WIDTH, 4.4), 2)
    for axis, chosen in ((whole, slice(0, len(data.t))), (close, data.close_up)):
        step = max(1, (chosen.stop - chosen.start) // _MOST_POINTS)
        some = slice(chosen.start, chosen.stop, step)
        axis.plot(data.t[some], signal.recorded[some], color=INK, linewidth=2.6, alpha=0.35,
                  label='recorded')
        for name, predicted in signal.predicted.items():
            axis.plot(data.t[some], predicted[some], color=COLOURS[name], linewidth=1.0,
                      linestyle=(0, (4, 2)) if name == 'nominal' else '-', label=name,
                      zorder=3 if name == 'nominal' else 2)  # dashes on top hide no line
        axis.set_ylabel(signal.label)
    t = data.t[data.close_up]
    whole.axvspan(t[0], t[-1], color=OCHRE, alpha=0.18, linewidth=0)
    figure.legend(*whole.get_legend_handles_labels(), ncols=4, loc='outside upper left',
                  columnspacing=1.0, handlelength=1.5)
    close.set_title('close-up of the greatest mismatch', color=OCHRE)
    close.set_xlabel('time [s]')
    return figure


@figure_style()
def plot_residuals(data: PlotData, residuals: Residuals) -> Any:
    """Plot the residuals of a channel over time, before and after; located intervals above."""
    figure, axis = new_figure((_WIDTH, 2.7))
    for number, (first, last) in enumerate(data.held_out_s):
        axis.axvspan(first, last, color=_HELD_OUT, linewidth=0,
                     label='_' * bool(number) + 'held out')
    axis.axhspan(-2.0 * residuals.noise, 2.0 * residuals.noise, color=MUTED, alpha=0.35,
                 linewidth=0, label='noise, ± 2 std')
    for name in data.pair:
        axis.plot(data.block_t, residuals.by_model[name], color=COLOURS[name], linewidth=0.7,
                  label=name)
    for number, span in enumerate(residuals.located_s):
        axis.plot(span, (1.015, 1.015), color=OCHRE, linewidth=3.5, clip_on=False,
                  transform=axis.get_xaxis_transform(), solid_capstyle='butt',
                  label='_' * bool(number) + 'mismatch located')
    axis.set(xlabel='time [s]', ylabel=residuals.label, ylim=_limits(data, residuals))
    figure.legend(*axis.get_legend_handles_labels(), ncols=3, loc='outside upper left',
                  columnspacing=1.0)
    return figure


def _limits(data: PlotData, residuals: Residuals) -> tuple[float, float]:
    """Return the range of nearly all residuals, at least three standard deviations."""
    both = np.concatenate([residuals.by_model[name] for name in data.pair])
    low, high = np.percentile(both, (0.2, 99.8))
    return (1.25 * min(float(low), -3.0 * residuals.noise),
            1.25 * max(float(high), 3.0 * residuals.noise))


@figure_style()
def plot_parts(effect: NamedEffect) -> Any:
    """Plot an effect part by part: the share that it explains, and its first parameter."""
    # Of a law beside named offsets the share is that of what these leave.
    figure, (above, below) = new_figure((_WIDTH, 3.6), 2, sharex=True)
    _plot_shares(above, effect)
    _plot_values(below, effect)
    places = range(len(effect.parts))
    names = [part.name for part in effect.parts]
    times = [name.partition(' s, ')[0] + ' s' for name in names if ' s, ' in name]
    names = times if len(set(times)) == len(names) else names
    crowded = sum(map(len, names)) > _MOST_LETTERS
    below.set_xticks(places, names, **_SLANTED if crowded else {})
    below.set(xlim=(-0.6, len(places) - 0.4), xlabel='part of the recording')
    for axis in (above, below):
        axis.grid(False, axis='x')
        # On the right: the power of ten of the axis stands on the left.
        axis.legend(loc='lower right', ncols=3, bbox_to_anchor=(1.0, 1.0), borderaxespad=0.0,
                    columnspacing=1.0, handlelength=1.2)
    return figure


def _plot_shares(axis: Any, effect: NamedEffect) -> None:
    every, interval = effect.share, effect.share_interval
    shares = [100.0 * part.share for part in effect.parts]
    if effect.beside_zeros is not None:
        every, interval = effect.beside_zeros.share, effect.beside_zeros.interval
        shares = [100.0 * float(share) for share in effect.beside_zeros.parts]
    low, high = (100.0 * value for value in interval)
    axis.bar(range(len(shares)), shares, width=0.6, color=MUTED, label='each fold')
    axis.axhline(100.0 * every, color=BLUE, linewidth=1.2, label='all folds')
    if isfinite(low) and isfinite(high):
        axis.axhspan(low, high, color=BLUE, alpha=0.18, linewidth=0, zorder=3,
                     label='95 % interval')
    axis.axhline(0.0, color=INK, linewidth=0.6)
    shown = [*shares, 0.0, 100.0]
    axis.set_ylim(1.05 * max(min(shown), _CUT_OFF[0]), 1.05 * min(max(shown), _CUT_OFF[1]))
    axis.set(ylabel='explained [%]' if effect.beside_zeros is None
             else 'explained of what\nthe offsets leave [%]')


def _plot_values(axis: Any, effect: NamedEffect) -> None:
    name, pooled = next(iter(effect.parameters.items()))
    values = [part.parameters[name] for part in effect.parts]
    axis.plot(range(len(values)), values, 'o', color=INK, markersize=4, label='each fold alone')
    axis.axhline(pooled.value, color=BLUE, linewidth=1.2, label='all folds')
    if isfinite(pooled.std):
        axis.axhspan(pooled.value - 2.0 * pooled.std, pooled.value + 2.0 * pooled.std, color=BLUE,
                     alpha=0.18, linewidth=0, label='± 2 std')
    axis.set(ylabel=name if pooled.unit in ('', '1') else f'{name} [{pooled.unit}]')
    axis.margins(y=0.2)


@figure_style()
def plot_plane(data: PlotData) -> Any:
    """Plot the residuals over position and velocity, before and after the correction."""
    figure, axes = new_figure((_WIDTH, 6.0), 2, sharex=True, sharey=True)
    plane = data.plane
    after = float(np.sqrt(np.mean(plane.by_model[data.pair[1]] ** 2)))
    saturated = max(_SATURATED, 2.0 * after)
    for axis, name in zip(axes, data.pair):
        residual = plane.by_model[name]
        order = np.argsort(np.abs(residual))  # the greatest on top
        dots = axis.scatter(
            1e3 * plane.x[order], 1e3 * plane.v[order], c=residual[order], s=5, cmap='RdBu_r',
            vmin=-saturated, vmax=saturated, linewidths=0, rasterized=True)
        axis.set_facecolor('#f7f8f9')
        axis.set_title(f'{name} model', color=COLOURS[name])
        axis.set_ylabel('velocity v [mm/s]')
    axes[-1].set_xlabel(plane.x_label)
    bar = figure.colorbar(dots, ax=axes, extend='both', shrink=0.9, pad=0.01)
    bar.set_label(f'{plane.channel} residual [std of its noise]')
    return figure


@figure_style()
def plot_dependences(dependences: Mapping[str, Sequence[Dependence]]) -> Any:
    """Plot the mean residual over each quantity, with its 95 % band, before and after."""
    quantities = list(zip(*dependences.values()))
    rows = -(-len(quantities) // 2)
    figure, axes = new_figure((_WIDTH, 1.8 * rows), rows, 2, squeeze=False)
    for axis in axes.flat[len(quantities):]:
        axis.remove()
    for axis, both in zip(axes.flat, quantities):
        for name, one in zip(dependences, both):
            _plot_dependence(axis, one, COLOURS[name])
        axis.axhline(0.0, color=MUTED, linewidth=0.8)
        shares = ' → '.join(f'{100.0 * max(one.share, 0.0):.0f}' for one in both)
        axis.set_title(f'{quantity(both[0])}: {shares} %')
        axis.set_xlabel(f'[{both[0].unit}]' if both[0].unit else '', fontsize=8)
    handles = [axes[0, 0].plot([], [], color=COLOURS[name], label=f'{name} model')[0]
               for name in dependences]
    figure.legend(handles=handles, ncols=2, loc='outside upper left')
    figure.supylabel('mean residual [std of its noise]', fontsize=9)
    return figure


def _plot_dependence(axis: Any, one: Dependence, colour: str) -> None:
    if one.names:
        axis.errorbar(one.middle, one.mean, (one.mean - one.low, one.high - one.mean),
                      color=colour, fmt='o', markersize=3, capsize=2, linewidth=1.0)
        axis.set_xticks(one.middle, [name.replace(' ', '\n') for name in one.names],
                        rotation=20, fontsize=7)
        axis.margins(x=0.15)
        return
    axis.fill_between(one.middle, one.low, one.high, color=colour, alpha=0.25, linewidth=0)
    axis.plot(one.middle, one.mean, color=colour, linewidth=1.0, marker='o', markersize=2)


@figure_style()
def plot_evidence(diagnosis: Diagnosis) -> Any:
    """Plot how much of the mismatch each of the best candidates alone would explain."""
    ranked = sorted(diagnosis.evidence.items(), key=lambda pair: -pair[1])[:_MOST_BARS]
    named = {effect.name for effect in diagnosis.effects}
    figure, axis = new_figure((_WIDTH, 0.7 + 0.24 * max(1, len(ranked))))
    names = [name for name, _ in ranked]
    shares = [100.0 * max(0.0, float(share)) for _, share in ranked]
    colours = [BLUE if name in named else MUTED for name in names]
    bars = axis.barh(range(len(names)), shares, color=colours, height=0.7)
    axis.bar_label(bars, [f'{share:.1f} %' for share in shares], padding=3, fontsize=8)
    axis.set_yticks(range(len(names)), [name.replace('_', ' ') for name in names])
    axis.invert_yaxis()
    axis.grid(False, axis='y')
    axis.set(xlim=(0.0, 120.0), xticks=(0, 25, 50, 75, 100),
             xlabel='explained share of the mismatch [%]')
    return figure
