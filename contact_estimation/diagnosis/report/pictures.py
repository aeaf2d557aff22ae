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

"""The pictures of a diagnosis: before and after, over time and over the motion."""

from __future__ import annotations

import io
from typing import Any, Mapping, Sequence

import numpy as np

from .seen import Before, held_out_spans, Seen, seen, Span
from ..conclude.dependence import Dependence
from ..conclude.result import Diagnosis
from ...optional_packages import require_matplotlib

_INK, _MUTED, _GRID = '#1f2933', '#9aa5b1', '#e4e7eb'
_COLOURS = {'nominal': '#7b8794', 'recalibrated': '#c2410c', 'corrected': '#0b6e99'}
_HELD_OUT, _LOCATED = '#eef1f4', '#b7791f'
_MOST_BARS, _PANELS = 12, 4
_SMALL = 7
_CLIPPED = 5.0  # standard deviations, of the colours
_DPI = 110


def draw(diagnosis: Diagnosis) -> dict[str, bytes]:
    """
    Draw all pictures of the recording that is shown.

    Parameters
    ----------
    diagnosis : Diagnosis
        The result.

    Returns
    -------
    pictures : dict of str to bytes
        PNG files: 'overlay', 'residuals', 'plane', 'dependence' (where the recording is long
        enough to tell) and 'evidence'.

    Raises
    ------
    MissingPackageError
        If matplotlib is not installed.

    """
    pyplot, data = require_matplotlib(), seen(diagnosis)
    held = held_out_spans(diagnosis)
    figures = {
        'overlay': _overlay(pyplot, data),
        'residuals': _residuals(pyplot, diagnosis, data, held),
        'plane': _plane(pyplot, data),
        'evidence': _evidence(pyplot, diagnosis),
    }
    depends = {name: [one for one in found if one.channel == diagnosis.located_channel]
               for name, found in diagnosis.dependences.items()}
    if all(depends.values()):
        figures['dependence'] = _dependence(pyplot, depends)
    pictures = {}
    for name, figure in figures.items():
        stream = io.BytesIO()
        figure.savefig(stream, dpi=_DPI, format='png')
        pyplot.close(figure)
        pictures[name] = stream.getvalue()
    return pictures


def _quiet(axis: Any) -> None:
    axis.spines[['top', 'right']].set_visible(False)
    axis.spines[['left', 'bottom']].set_color(_MUTED)
    axis.tick_params(colors=_INK, labelsize=8)
    axis.grid(color=_GRID, linewidth=0.6)
    axis.set_axisbelow(True)


def _overlay(pyplot: Any, data: Seen) -> Any:
    """Lay the simulations over the recording: all of it, and where they differ most."""
    rows = [row for row in (data.force, data.position) if row is not None]
    figure, axes = pyplot.subplots(len(rows), 2, figsize=(9.5, 2.7 * len(rows)), squeeze=False,
                                   layout='constrained', width_ratios=(1.4, 1.0))
    for row, (whole, close) in zip(rows, axes):
        for axis, pick in ((whole, slice(None)), (close, data.close_up)):
            _draw_overlay(axis, data, row, pick)
            _quiet(axis)
        whole.set_ylabel(row.label, color=_INK, fontsize=9)
        whole.axvspan(*data.close_up_span, color=_LOCATED, alpha=0.18, linewidth=0)
    axes[0, 0].legend(frameon=False, fontsize=8, ncols=4, loc='lower left',
                      bbox_to_anchor=(0.0, 1.0), borderaxespad=0.0)
    axes[0, 1].set_title('where they differ most', fontsize=9, color=_LOCATED, loc='left')
    for axis in axes[-1]:
        axis.set_xlabel('time [s]', fontsize=9, color=_INK)
    for axis in axes[:, 1]:
        axis.locator_params(axis='x', nbins=6)
    return figure


def _draw_overlay(axis: Any, data: Seen, row: Before, pick: slice) -> None:
    step = max(1, len(data.t[pick]) // 1500)
    some = slice(pick.start, pick.stop, step)
    axis.plot(data.t[some], row.recorded[some], color=_INK, linewidth=2.2, alpha=0.35,
              label='recorded')
    for name, simulated in row.simulated.items():
        axis.plot(data.t[some], simulated[some], color=_COLOURS[name], linewidth=0.9,
                  linestyle=(0, (4, 2)) if name == 'nominal' else '-', label=name)
    axis.margins(x=0.01)


def _residuals(pyplot: Any, diagnosis: Diagnosis, data: Seen, held: Sequence[Span]) -> Any:
    """Draw what each model leaves over time, port by port."""
    figure, axes = pyplot.subplots(len(data.residuals), 1, sharex=True, squeeze=False,
                                   figsize=(9.5, 2.6 * len(data.residuals)),
                                   layout='constrained')
    for axis, row in zip(axes[:, 0], data.residuals):
        for first, last in held:
            axis.axvspan(first, last, color=_HELD_OUT, linewidth=0)
        axis.axhspan(-2.0 * row.noise, 2.0 * row.noise, color=_MUTED, alpha=0.35, linewidth=0,
                     label='noise, +- 2 std')
        for name in data.pair:
            axis.plot(data.block_t, row.left[name], color=_COLOURS[name], linewidth=0.7,
                      label=name)
        _quiet(axis)
        axis.margins(x=0.01)
        axis.set_ylabel(row.label, color=_INK, fontsize=9)
        both = np.concatenate([row.left[name] for name in data.pair])
        low, high = np.percentile(both, (0.2, 99.8))
        axis.set_ylim(1.25 * min(low, -3.0 * row.noise), 1.25 * max(high, 3.0 * row.noise))
        if row.holds_location:
            _mark(axis, diagnosis)
    if held:
        axes[0, 0].annotate('held out', (held[0][0], 1.0), xycoords=('data', 'axes fraction'),
                            xytext=(3, -9), textcoords='offset points', fontsize=8, color=_INK,
                            bbox={'facecolor': _HELD_OUT, 'edgecolor': 'none', 'pad': 1.0})
    if diagnosis.location is not None:  # its entry in the legend
        axes[0, 0].plot([], [], color=_LOCATED, linewidth=3.5, label='mismatch located here')
    axes[0, 0].legend(frameon=False, fontsize=8, ncols=4, loc='lower left',
                      bbox_to_anchor=(0.0, 1.04), borderaxespad=0.0)
    axes[-1, 0].set_xlabel('time [s]', fontsize=9, color=_INK)
    return figure


def _mark(axis: Any, diagnosis: Diagnosis) -> None:
    """Mark where the mismatch was located, above the axis."""
    location = diagnosis.location
    if location is None:
        return
    for first, last in location.intervals_s:
        axis.plot((first, last), (1.015, 1.015), color=_LOCATED, linewidth=3.5, clip_on=False,
                  transform=axis.get_xaxis_transform(), solid_capstyle='butt')


def _plane(pyplot: Any, data: Seen) -> Any:
    """Draw the residual over depth and speed, before and after."""
    figure, axes = pyplot.subplots(1, 2, figsize=(9.5, 3.6), sharex=True, sharey=True,
                                   layout='constrained')
    plane = data.plane
    after = float(np.sqrt(np.mean(plane.left[data.pair[1]] ** 2)))
    clipped = max(_CLIPPED, 2.0 * after)
    for axis, name in zip(axes, data.pair):
        order = np.argsort(np.abs(plane.left[name]))  # the largest on top
        dots = axis.scatter(
            1e3 * plane.x[order], 1e3 * plane.v[order], c=plane.left[name][order], s=5,
            cmap='RdBu_r', vmin=-clipped, vmax=clipped, linewidths=0, rasterized=True,
        )
        _quiet(axis)
        axis.set_facecolor('#f7f8f9')
        axis.set_title(name, loc='left', fontsize=9, color=_COLOURS[name])
        axis.set_xlabel(plane.x_label, fontsize=9, color=_INK)
    axes[0].set_ylabel('speed v [mm/s]', fontsize=9, color=_INK)
    bar = figure.colorbar(dots, ax=axes, extend='both', shrink=0.9, pad=0.01)
    bar.set_label(f'{plane.of} left over\n[std of its noise]', fontsize=8, color=_INK)
    bar.ax.tick_params(labelsize=8)
    return figure


def _dependence(pyplot: Any, depends: Mapping[str, Sequence[Dependence]]) -> Any:
    """Draw the residual over all that it may depend on, before and after, with its bands."""
    ons = [one.on for one in next(iter(depends.values()))]
    rows = -(-len(ons) // _PANELS)
    figure, axes = pyplot.subplots(rows, _PANELS, figsize=(9.5, 2.2 * rows), squeeze=False,
                                   layout='constrained')
    for axis in axes.flat[len(ons):]:
        axis.set_visible(False)
    for place, (axis, on) in enumerate(zip(axes.flat, ons)):
        both = [found[place] for found in depends.values()]
        _quiet(axis)
        for name, one in zip(depends, both):
            _draw_dependence(axis, one, _COLOURS[name])
        axis.axhline(float(on == 'frequency'), color=_MUTED, linewidth=0.8)
        shares = ' to '.join(f'{100.0 * max(one.share, 0.0):.0f}' for one in both)
        axis.set_title(f'{on}: {shares} %', loc='left', fontsize=9, color=_INK)
        axis.set_xlabel(f'[{both[0].unit}]' if both[0].unit else '', fontsize=8, color=_INK)
    for name in depends:
        axes[0, 0].plot([], [], color=_COLOURS[name], label=name)
    figure.legend(*axes[0, 0].get_legend_handles_labels(), frameon=False, fontsize=8, ncols=2,
                  loc='outside upper left')
    return figure


def _draw_dependence(axis: Any, one: Dependence, colour: str) -> None:
    if one.names:
        axis.errorbar(one.middle, one.mean, (one.mean - one.low, one.high - one.mean),
                      color=colour, fmt='o', markersize=3, capsize=2, linewidth=1.0)
        axis.set_xticks(one.middle, [name.replace(' ', '\n') for name in one.names])
        axis.margins(x=0.15)
        axis.tick_params(axis='x', labelsize=_SMALL, rotation=20)
        return
    if one.on == 'frequency':
        axis.set(xscale='log', yscale='log')
    axis.fill_between(one.middle, one.low, one.high, color=colour, alpha=0.25, linewidth=0)
    axis.plot(one.middle, one.mean, color=colour, linewidth=1.0, marker='o', markersize=2)


def _evidence(pyplot: Any, diagnosis: Diagnosis) -> Any:
    """Draw how much of the misfit each candidate alone would explain."""
    ranked = sorted(diagnosis.evidence.items(), key=lambda pair: -pair[1])[:_MOST_BARS]
    found = {effect.name for effect in diagnosis.effects}
    figure, axis = pyplot.subplots(figsize=(9.5, 0.7 + 0.24 * max(1, len(ranked))),
                                   layout='constrained')
    names = [name for name, _ in ranked]
    shares = [100.0 * max(0.0, float(share)) for _, share in ranked]
    colours = [_COLOURS['corrected'] if name in found else _MUTED for name in names]
    bars = axis.barh(range(len(names)), shares, color=colours, height=0.7)
    axis.bar_label(bars, [f'{share:.1f} %' for share in shares], padding=3, fontsize=8,
                   color=_INK)
    _quiet(axis)
    axis.set_yticks(range(len(names)), names)
    axis.invert_yaxis()
    axis.set_xlim(0.0, 112.0)
    axis.grid(False, axis='y')
    axis.set_xlabel('share of the misfit that it alone explains [%]', fontsize=9, color=_INK)
    return figure
