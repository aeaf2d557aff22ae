# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
Dependence of the residuals of each channel on time, motion and their own past.

The residual is averaged over bins of a quantity. Stretches of half a second are drawn with
replacement for the bands of these means (block bootstrap, Kuensch 1989), and permuted for the
distribution without dependence: within a stretch residuals may be correlated in any way.
"""

from typing import NamedTuple

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from .fit.evidence import DRAWS
from .location import phases
from .observe.model import Model
from .observe.prepared_recording import PreparedRecording
from .observe.residuals import residuals
from ..physics.numeric import Array

Places = NDArray[np.int_]

_STRETCH_S = 0.5
_BAND = (2.5, 97.5)
_AT_ONCE = 1_000_000  # values of permuted stretches: 8 MB
_SIGNIFICANCE = 99.0  # percentile of the distribution without dependence
_BINS = 12
_PAST = 5  # blocks
_LEAST_STRETCHES = 8
_LEAST_SHARE = 0.05  # of the residuals, that smoothing alone can cause


class Dependence(NamedTuple):
    """Dependence of the residuals of a channel on a quantity."""

    channel: str  # 'force' or 'motion'
    # on, unit: the quantity, such as 'velocity'; unit '' if the bins have `names`
    on: str
    unit: str
    # of the mean square of the residual: explained by the means of the bins; for 'its own past' by
    # the blocks just before
    share: float
    chance: float  # 99 % quantile of the share without dependence
    names: tuple[str, ...]  # of the bins, if they have names
    middle: Array  # (bins,) of the quantity in each bin; for 'its own past' lags [s]
    # mean, low, high (bins,): of the residual, in standard deviations of a block, with its 95 %
    # band; for 'its own past' the autocorrelation
    mean: Array
    low: Array
    high: Array

    @property
    def is_real(self) -> bool:
        """Whether the share is significant and not negligible."""
        return self.share > max(self.chance, _LEAST_SHARE)


class _Binned(NamedTuple):
    """A quantity cut into bins; `bins` holds the bin of each block."""

    on: str
    unit: str
    names: tuple[str, ...]
    middle: Array
    bins: Places


def dependences(
    recording: PreparedRecording, model: Model, generator: Generator
) -> list[Dependence]:
    """Test the residuals of a model, channel by channel."""
    parts = recording.split(residuals(recording, model, robust=False))
    channels = {'force': recording.force, 'motion': recording.motion}
    if recording.driven_by_force(model):
        del channels['force']
    span = max(1, round(_STRETCH_S * recording.observed.pace / recording.block_s))
    found = []
    for (name, channel), part in zip(channels.items(), parts):
        use = np.flatnonzero(channel.filled)
        count = len(use) // span
        if count < _LEAST_STRETCHES:
            continue
        use = use[:count * span]
        residual = part[use]
        orders = generator.permuted(np.tile(np.arange(count), (DRAWS, 1)), axis=1)
        for binned in _quantities(recording, model, use):
            found.append(_dependence(name, residual, binned, orders, generator))
        found.append(_on_past(name, residual, recording.block_s, count, generator))
    return found


def _quantities(recording: PreparedRecording, model: Model, use: Places) -> list[_Binned]:
    o = recording.observed
    depth = recording.blocks(o.x - model.nominal.environment.location)[use]
    v = recording.blocks(o.v)[use]
    found = [
        _cut('depth', 'm', depth), _cut('velocity', 'm/s', v),
        _cut('acceleration', 'm/s^2', recording.blocks(o.a)[use]),
        _cut('time', 's', recording.blocks(o.t)[use])]
    direction = np.where(recording.touching(model)[use], np.where(v > 0.0, 0, 1), 2)
    found.append(_named('direction', ('loading', 'unloading', 'free'), direction))
    marks = phases(recording, model)
    phase = np.full(len(use), len(marks))
    for place, where in enumerate(marks.values()):
        phase[where[use]] = place
    return [*found, _named('phase', (*marks, 'other'), phase)]


def _cut(on: str, unit: str, values: Array) -> _Binned:
    """Cut a quantity into bins of equally many blocks."""
    edges = np.unique(np.percentile(values, np.linspace(0.0, 100.0, _BINS + 1)[1:-1]))
    bins = np.searchsorted(edges, values)
    counts = np.bincount(bins, minlength=len(edges) + 1)
    middle = np.bincount(bins, values, len(counts)) / np.maximum(counts, 1)
    return _Binned(on, unit, (), middle, bins)


def _named(on: str, names: tuple[str, ...], bins: Places) -> _Binned:
    """Keep the bins that are not empty."""
    there, bins = np.unique(bins, return_inverse=True)
    kept = tuple(names[place] for place in there.tolist())
    return _Binned(on, '', kept, np.arange(len(kept), dtype=np.float64), bins)


def _dependence(
    channel: str, residual: Array, binned: _Binned, orders: Places, generator: Generator
) -> Dependence:
    """Compare the means of bins with those of stretches in random orders, (draws, count)."""
    bins, size, count = binned.bins, len(binned.middle), orders.shape[1]
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
    permuted = np.concatenate([
        np.sum(_sums(rows[some].reshape(len(some), -1), bins, size)**2 / total, axis=1)
        for some in np.array_split(orders, 1 + residual.size * DRAWS // _AT_ONCE)])
    square = max(float(residual @ residual), 1e-300)
    return Dependence(
        channel, binned.on, binned.unit, float(total @ mean**2) / square,
        float(np.percentile(permuted, _SIGNIFICANCE)) / square, binned.names, binned.middle, mean,
        low, high)


def _sums(series: Array, bins: Places, size: int) -> Array:
    """Sum each of several series over its bins, (series, size)."""
    place = bins + size * np.arange(len(series))[:, None]
    sums = np.bincount(place.ravel(), series.ravel(), len(series) * size)
    return np.asarray(sums.reshape(len(series), size), np.float64)


def _drawn(count: int, generator: Generator) -> Array:
    """Draw stretches with replacement; return how often each is drawn, (draws, count)."""
    drawn = generator.multinomial(count, np.full(count, 1.0 / count), DRAWS)
    return np.asarray(drawn, np.float64)


def _past_of(series: Array) -> Array:
    """Return the values before each block from the sixth on, a row for each lag."""
    return np.array([series[_PAST - lag:-lag] for lag in range(1, _PAST + 1)])


def _on_past(
    channel: str, residual: Array, step: float, count: int, generator: Generator
) -> Dependence:
    """Compute how much of the residual its own past predicts: 0 for white noise."""
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

    def predictable_share(series: Array) -> float:
        past = _past_of(series).T
        left = series[_PAST:] - past @ np.linalg.lstsq(past, series[_PAST:], rcond=None)[0]
        return 1.0 - float(left @ left) / square

    permuted = [predictable_share(generator.permutation(residual)) for _ in range(DRAWS // 4)]
    return Dependence(
        channel, 'its own past', 's', predictable_share(residual),
        float(np.percentile(permuted, _SIGNIFICANCE)), (), step * np.arange(1.0, _PAST + 1.0),
        products.sum(axis=1) / square, low, high)
