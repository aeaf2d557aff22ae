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

"""The figure of an effect on parts of the recordings: its share and its main parameter."""

from __future__ import annotations

from math import isfinite
from typing import Any, Mapping, Sequence

from ..conclude.result import NamedEffect
from ...figures import BLUE, figure_style, INK, MUTED, new_figure

_SIZE = 4.8, 3.6  # [inch]
_LEAST, _MOST = -100.0, 150.0  # shares that are shown [%]; one of a tiny misfit may be any
_STDS = 2.0
_MOST_LETTERS = 60  # of the names of all parts on one line
_SLANTED: Mapping[str, Any] = {'rotation': 30, 'ha': 'right', 'fontsize': 7}


@figure_style()
def plot_parts(effect: NamedEffect) -> Any:
    """
    Plot an effect part by part.

    Parameters
    ----------
    effect : NamedEffect
        With its parts.

    Returns
    -------
    figure : matplotlib.figure.Figure
        Two axes: the share on each part when left out, with that of all parts and its interval,
        of what the zeros leave if some are named; the first parameter fitted on each part alone,
        with that of all parts and two standard deviations.

    """
    figure, (above, below) = new_figure(_SIZE, 2, sharex=True)
    _plot_shares(above, effect)
    _plot_values(below, effect)
    places = range(len(effect.parts))
    names = [part.name.partition(', every')[0] for part in effect.parts]
    crowded = sum(map(len, names)) > _MOST_LETTERS
    below.set_xticks(places, names, **_SLANTED if crowded else {})
    below.set_xlim(-0.6, len(places) - 0.4)
    for axis in (above, below):
        axis.grid(False, axis='x')
    return figure


def _plot_shares(axis: Any, effect: NamedEffect) -> None:
    every, interval = effect.share, effect.share_interval
    shares = [100.0 * part.share for part in effect.parts]
    if effect.beside_zeros is not None:
        every, interval = effect.beside_zeros.share, effect.beside_zeros.interval
        shares = [100.0 * float(share) for share in effect.beside_zeros.parts]
    low, high = (100.0 * value for value in interval)
    if isfinite(low) and isfinite(high):
        axis.axhspan(low, high, color=BLUE, alpha=0.18, linewidth=0, zorder=3,
                     label='95 % interval')
    axis.bar(range(len(shares)), shares, width=0.6, color=MUTED, label='each part')
    axis.axhline(100.0 * every, color=BLUE, linewidth=1.2, label='all parts')
    axis.axhline(0.0, color=INK, linewidth=0.6)
    axis.set_ylim(_limits([*shares, 0.0, 100.0]))
    axis.set(ylabel='share [%]' if effect.beside_zeros is None else 'share beside zeros [%]')
    axis.set_title(effect.name)


def _limits(shown: Sequence[float]) -> tuple[float, float]:
    """Return the range of the shares, cut off where one of a tiny misfit is far away."""
    return 1.05 * max(min(shown), _LEAST), 1.05 * min(max(shown), _MOST)


def _plot_values(axis: Any, effect: NamedEffect) -> None:
    name, pooled = next(iter(effect.parameters.items()))
    if isfinite(pooled.std):
        reach = _STDS * pooled.std
        axis.axhspan(pooled.value - reach, pooled.value + reach, color=BLUE, alpha=0.18,
                     linewidth=0, label='all parts, ± 2 std')
    axis.axhline(pooled.value, color=BLUE, linewidth=1.2, label='all parts')
    values = [part.parameters[name] for part in effect.parts]
    axis.plot(range(len(values)), values, 'o', color=INK, markersize=4, label='each part alone')
    axis.set(ylabel=name if pooled.unit in ('', '1') else f'{name} [{pooled.unit}]')
    axis.margins(y=0.2)
