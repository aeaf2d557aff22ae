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

"""
On what the residuals of each port depend, and how much of that could be chance.

The residual is averaged over bins of a quantity. Stretches of half a second are drawn with
replacement for the bands of these means (block bootstrap, Kuensch 1989), and put in another order
for what chance would give: within a stretch residuals may be correlated in any way.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from .location import phases
from ..observe.model import Model
from ..observe.ports import Ports

Array = NDArray[np.float64]
Places = NDArray[np.int_]

_STRETCH_S = 0.5
_DRAWS = 400
_BAND = (2.5, 97.5)
_BY_CHANCE = 99.0  # percentile
_BINS = 12
_PAST = 5  # blocks
_LEAST_STRETCHES = 8
_SEGMENT = 4  # stretches: lowest frequency of the spectrum
_WORTH_A_WORD = 0.05  # share; a right model on smoothed motion leaves up to so much


class Dependence(NamedTuple):
    """
    How the residual of a port depends on a quantity.

    Attributes
    ----------
    port : str
        'force' or 'motion'.
    on, unit : str
        The quantity, such as 'velocity'; unit '' where `names` tells the bins.
    share : float
        Of the residual's mean square, explained by the means of the bins; for 'its own past' by
        the blocks just before; for 'frequency' 1 less the spectral flatness.
    chance : float
        That chance stays below in 99 of 100 cases.
    names : tuple of str
        Of the bins, where they have names.
    middle : ndarray, shape (bins,)
        Of the quantity in each bin; for 'its own past' lags [s].
    mean, low, high : ndarray, shape (bins,)
        Of the residual, in standard deviations of a block, with its 95 % band; for 'its own past'
        the autocorrelation, for 'frequency' the power in that of the noise.

    """

    port: str
    on: str
    unit: str
    share: float
    chance: float
    names: tuple[str, ...]
    middle: Array
    mean: Array
    low: Array
    high: Array

    @property
    def is_real(self) -> bool:
        """Whether there is more than chance gives, and enough for a word."""
        return self.share > max(self.chance, _WORTH_A_WORD)


class _Binned(NamedTuple):
    """A quantity cut into bins; `bins` tells the bin of each block."""

    on: str
    unit: str
    names: tuple[str, ...]
    middle: Array
    bins: Places


def dependences(port: Ports, model: Model, generator: Generator) -> list[Dependence]:
    """
    Test what a model leaves at each port.

    Parameters
    ----------
    port : Ports
        The recording.
    model : Model
        Fitted.
    generator : numpy.random.Generator
        Of the draws.

    Returns
    -------
    dependences : list of Dependence
        Of the force, then of the motion; empty where the recording is too short to tell.

    """
    parts = port.split(port.residuals(model, robust=False))
    names = ('motion',) if port.driven_by_force(model) else ('force', 'motion')
    found = []
    for name, part in zip(names, parts):
        use = np.flatnonzero(port.filled(name))
        span = max(1, round(_STRETCH_S / (port.observed.h * port.block)))
        count = len(use) // span
        if count < _LEAST_STRETCHES:
            continue
        use = use[:count * span]
        residual = part[use]
        for binned in _quantities(port, model, use):
            found.append(_dependence(name, residual, binned, count, generator))
        step = port.observed.h * port.block
        found.append(_on_frequency(name, residual, step, count, generator))
        found.append(_on_past(name, residual, step, count, generator))
    return found


def _quantities(port: Ports, model: Model, use: Places) -> list[_Binned]:
    o = port.observed
    depth = port.blocks(o.x - model.nominal.environment.location)[use]
    v = port.blocks(o.v)[use]
    found = [
        _cut('depth', 'm', depth), _cut('velocity', 'm/s', v),
        _cut('acceleration', 'm/s^2', port.blocks(o.a)[use]),
        _cut('time', 's', port.blocks(o.t)[use]),
    ]
    way = np.where(port.touching(model)[use], np.where(v > 0.0, 0, 1), 2)
    found.append(_named('direction', ('pressing further', 'letting go', 'free'), way))
    marks = phases(port, model)
    phase = np.full(len(use), len(marks))
    for place, where in enumerate(marks.values()):
        phase[where[use]] = place
    return [*found, _named('phase', (*marks, 'other'), phase)]


def _cut(on: str, unit: str, values: Array) -> _Binned:
    """Cut a quantity into bins of as many blocks each."""
    edges = np.unique(np.percentile(values, np.linspace(0.0, 100.0, _BINS + 1)[1:-1]))
    bins = np.searchsorted(edges, values)
    counts = np.bincount(bins, minlength=len(edges) + 1)
    middle = np.bincount(bins, values, len(counts)) / np.maximum(counts, 1)
    return _Binned(on, unit, (), middle, bins)


def _named(on: str, names: tuple[str, ...], bins: Places) -> _Binned:
    """Keep the bins that there are."""
    there, bins = np.unique(bins, return_inverse=True)
    kept = tuple(names[place] for place in there.tolist())
    return _Binned(on, '', kept, np.arange(len(kept), dtype=np.float64), bins)


def _dependence(
    port: str, residual: Array, binned: _Binned, count: int, generator: Generator
) -> Dependence:
    bins, size = binned.bins, len(binned.middle)
    rows = residual.reshape(count, -1)
    place = bins.reshape(count, -1) + size * np.arange(count)[:, None]
    sums = np.bincount(place.ravel(), residual, count * size).reshape(count, size)
    counts = np.bincount(place.ravel(), minlength=count * size).reshape(count, size)
    drawn = _drawn(count, generator)
    with np.errstate(invalid='ignore', divide='ignore'):  # a bin that was not drawn at all
        means = (drawn @ sums) / (drawn @ counts)
    low, high = np.nanpercentile(means, _BAND, axis=0)
    mean = sums.sum(axis=0) / counts.sum(axis=0)
    total = counts.sum(axis=0)
    by_chance = []
    for _ in range(_DRAWS):
        other = np.bincount(bins, rows[generator.permutation(count)].ravel(), size) / total
        by_chance.append(float(total @ other**2))
    square = max(float(residual @ residual), 1e-300)
    return Dependence(
        port, binned.on, binned.unit, float(total @ mean**2) / square,
        float(np.percentile(by_chance, _BY_CHANCE)) / square, binned.names, binned.middle, mean,
        low, high,
    )


def _drawn(count: int, generator: Generator) -> Array:
    """Draw stretches with replacement: how often each comes, shape (draws, count)."""
    drawn = generator.multinomial(count, np.full(count, 1.0 / count), _DRAWS)
    return np.asarray(drawn, np.float64)


def _on_frequency(
    port: str, residual: Array, step: float, count: int, generator: Generator
) -> Dependence:
    """Tell how far the spectrum, octave by octave, is from that of noise."""
    segments = max(1, count // _SEGMENT)
    length = len(residual) // segments
    window = np.hanning(length)
    frequencies = np.fft.rfftfreq(length, step)
    octaves = np.maximum(np.log2(np.maximum(frequencies, 1e-9) / frequencies[1]), -1.0)
    bins = np.floor(octaves).astype(int) + 1  # 0: the mean
    lines = np.bincount(bins)

    def octave_powers(series: Array) -> Array:
        rows = series[:segments * length].reshape(segments, length)
        power = np.abs(np.fft.rfft(rows * window)) ** 2 / np.sum(window**2)
        return np.array([np.bincount(bins, row) / lines for row in power])[:, 1:]

    def uneven(powers: Array) -> float:
        mean, weights = powers.mean(axis=0), lines[1:] / np.sum(lines[1:])
        return float(1.0 - np.exp(weights @ np.log(mean + 1e-300)) / (weights @ mean + 1e-300))

    powers = octave_powers(residual)
    drawn = _drawn(segments, generator)
    low, high = np.percentile(drawn @ powers / segments, _BAND, axis=0)
    by_chance = [uneven(octave_powers(generator.permutation(residual)))
                 for _ in range(_DRAWS // 4)]
    middle = np.bincount(bins, frequencies)[1:] / lines[1:]
    return Dependence(
        port, 'frequency', 'Hz', uneven(powers), float(np.percentile(by_chance, _BY_CHANCE)), (),
        middle, powers.mean(axis=0), low, high,
    )


def _past_of(series: Array) -> Array:
    """Give what came before each block from the sixth on, a row for each lag."""
    return np.array([series[_PAST - lag:-lag] for lag in range(1, _PAST + 1)])


def _on_past(
    port: str, residual: Array, step: float, count: int, generator: Generator
) -> Dependence:
    """Tell how much of the residual its own past foretells: whether it is white."""
    here = residual[_PAST:]
    square = max(float(here @ here), 1e-300)
    products = here * _past_of(residual)
    rows = np.array_split(np.arange(len(here)), count)
    sums = np.array([[products[:, row].sum(axis=1), np.full(_PAST, here[row] @ here[row])]
                     for row in rows])
    drawn = _drawn(count, generator)
    drawn_sums = np.tensordot(drawn, sums, 1)
    ratios = drawn_sums[:, 0] / np.maximum(drawn_sums[:, 1], 1e-300)
    low, high = np.percentile(ratios, _BAND, axis=0)

    def foretold(series: Array) -> float:
        past = _past_of(series).T
        left = series[_PAST:] - past @ np.linalg.lstsq(past, series[_PAST:], rcond=None)[0]
        return 1.0 - float(left @ left) / square

    by_chance = [foretold(generator.permutation(residual)) for _ in range(_DRAWS // 4)]
    return Dependence(
        port, 'its own past', 's', foretold(residual),
        float(np.percentile(by_chance, _BY_CHANCE)), (), step * np.arange(1.0, _PAST + 1.0),
        products.sum(axis=1) / square, low, high,
    )
