# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The parts of a recording that are fitted, and its episodes of contact, some held out."""

from dataclasses import replace
from math import ceil, log10
from typing import NamedTuple

import numpy as np

from .model import Model
from .observed import Observed
from .shares import LITTLE, MOST, MUCH, SLIGHT
from .signals import check_signals, LEAST_SAMPLES, Recording, Signals
from .smoothing import pace_of, white_noise_std
from ...exceptions import RecordingError
from ...physics.numeric import Array, Flags
from ...plant.plant_parameters import PlantParameters

_GAP_S, _GAP_PERIODS = 0.5, 10.0  # without a sample of wrench or joints
_STRAIGHT = 0.005  # of the range: a line that tells as much as samples
_OF_LINE = 3  # fewest samples on either side of it
_OUTSIDE_PERIODS = 2.5  # between the ends of wrench and joints: else one outlasts the other
_MOST_SAMPLES = {True: 30_000, False: 66_000}  # fitted as they are, with and without a robot
_ENOUGH_SAMPLES = 20_000  # to which longer recordings are averaged
_MOST_AVERAGED = 1 << 12
_LEAST_CONTACT_S = 0.2


def continuous_parts(recording: Recording, model: PlantParameters) -> list[Recording]:
    """Split a recording at its gaps, and average recordings that are too long to be fitted."""
    check_signals(recording.signals)
    whole = _common(recording.signals)
    if not _is_enough(whole):
        return [recording]
    spans = spans_of(whole)
    parts = [_cut(whole, first, last) for first, last in spans] if len(spans) > 1 else [whole]
    parts = [part for part in parts if _is_enough(part)]
    if sum(len(part.wrench_t) for part in parts) < (1.0 - MUCH) * len(whole.wrench_t):
        parts = [whole]  # the samples are uneven, and there are no gaps
    parts = [part for part in parts if _touches(part, model)] or parts
    most = _MOST_SAMPLES[model.environment.unilateral]
    return [_named(recording, _shortened(part, most), len(parts) > 1 or len(spans) > 1)
            for part in parts]


def _common(signals: Signals) -> Signals:
    """Leave out what lies outside the time that both wrench and joints cover."""
    s = signals
    slack = _OUTSIDE_PERIODS * max(_period(s.wrench_t), _period(s.joint_t))
    first, last = max(s.wrench_t[0], s.joint_t[0]), min(s.wrench_t[-1], s.joint_t[-1])
    if last - first <= 0.0:
        return s
    return _cut(s, first - slack, last + slack)


def _cut(signals: Signals, first: float, last: float) -> Signals:
    s = signals
    wrench = (s.wrench_t >= first) & (s.wrench_t <= last)
    joint = (s.joint_t >= first) & (s.joint_t <= last)
    # A reference may be sparse: the samples before and after the part belong to it.
    begin, end = np.searchsorted(s.reference_t, (first, last))
    kept = slice(max(0, int(begin) - 1), int(end) + 1)
    return Signals(s.wrench_t[wrench], s.force[wrench], s.joint_t[joint], s.position[joint],
                   s.reference_t[kept], s.reference[:, kept])


def spans_of(signals: Signals) -> list[tuple[float, float]]:
    """Find the stretches in which no topic pauses."""
    # A pause of less than a fiftieth of the recording over which the topic goes straight on is
    # none: a straight line tells what happened.
    s = signals
    begin, end = float(s.wrench_t[0]), float(s.wrench_t[-1])
    pace = pace_of(_period(s.wrench_t), end - begin)
    pauses: list[tuple[float, float]] = []
    for stamps, values in ((s.wrench_t, s.force), (s.joint_t, s.position)):
        steps = np.diff(stamps)
        long = steps > max(_GAP_S * pace, _GAP_PERIODS * float(np.median(steps)))
        pauses += [(float(stamps[k]), float(stamps[k + 1])) for k in np.flatnonzero(long).tolist()
                   if steps[k] > SLIGHT * (end - begin) or not _goes_straight(stamps, values, k)]
    spans = []
    for pause, resume in sorted(pauses):
        if pause > begin:
            spans.append((begin, pause))
        begin = max(begin, resume)
    return [*spans, (begin, end)]


def _goes_straight(t: Array, y: Array, last: int) -> bool:
    """Return whether the lines through the samples before and after a pause are one line."""
    pause, length = t[last], t[last + 1] - t[last]
    first = min(int(np.searchsorted(t, pause - length)), last - _OF_LINE + 1)
    stop = max(int(np.searchsorted(t, pause + 2.0 * length)), last + 1 + _OF_LINE)
    if first < 0 or stop > len(t):
        return False
    ends = [np.polyval(np.polyfit(t[side] - pause, y[side], 1), (0.0, length))
            for side in (slice(first, last + 1), slice(last + 1, stop))]
    return float(np.max(np.abs(np.diff(ends, axis=0)))) <= _STRAIGHT * float(np.ptp(y))


def _is_enough(part: Signals) -> bool:
    return (min(len(part.wrench_t), len(part.joint_t)) >= LEAST_SAMPLES
            and min(float(np.ptp(part.force)), float(np.ptp(part.position))) > 0.0)


def _touches(part: Signals, model: PlantParameters) -> bool:
    """Return whether an attached wall, or the surface of another, is met for long enough."""
    if not model.environment.unilateral:
        return True
    inside = np.concatenate(([0], part.position > model.environment.location, [0]))
    edges = np.flatnonzero(np.diff(inside))
    least = _LEAST_CONTACT_S * pace_of(_period(part.wrench_t), float(np.ptp(part.wrench_t)))
    longest = max((stop - first for first, stop in zip(edges[::2], edges[1::2])), default=0)
    return bool(longest * _period(part.joint_t) > least)


def _shortened(signals: Signals, most: int) -> Signals:
    """Average a long recording as far as its motion allows; cut off what is still too much."""
    count = len(signals.wrench_t)
    if count <= most:
        return signals
    size = 2
    while size < _MOST_AVERAGED and count > _ENOUGH_SAMPLES * size:
        size *= 2
    while size > 1 and not _is_smooth(signals, size):
        size //= 2
    signals = _averaged(signals, size) if size > 1 else signals
    last = signals.wrench_t[min(len(signals.wrench_t), most) - 1]
    return _cut(signals, float(signals.wrench_t[0]), float(last))


def _is_smooth(signals: Signals, size: int) -> bool:
    """Return whether averages over a number of wrench samples lose nothing but noise."""
    period = size * _period(signals.wrench_t)
    for stamps, values in ((signals.wrench_t, signals.force), (signals.joint_t, signals.position)):
        samples = max(1, round(period / _period(stamps)))
        t, means = _means(stamps, values, samples)
        noise = max(white_noise_std(values), 1e-4 * float(np.ptp(values)))
        left = np.minimum(np.abs(values - np.interp(stamps, t, means)), 4.0 * noise)
        if np.mean(left**2) > (1.0 + LITTLE + 1.0 / samples) * noise**2:
            return False
    return True


def _averaged(signals: Signals, size: int) -> Signals:
    s, period = signals, size * _period(signals.wrench_t)
    wrench_t, force = _means(s.wrench_t, s.force, size)
    joint_t, position = _means(s.joint_t, s.position, max(1, round(period / _period(s.joint_t))))
    if len(s.reference_t) < 2:
        return Signals(wrench_t, force, joint_t, position, s.reference_t, s.reference)
    samples = max(1, round(period / _period(s.reference_t)))
    rows = [_means(s.reference_t, row, samples) for row in s.reference]
    return Signals(wrench_t, force, joint_t, position, rows[0][0],
                   np.array([row for _, row in rows]))


def _means(stamps: Array, values: Array, samples: int) -> tuple[Array, Array]:
    """Average stamps and values over so many samples each; the last may be fewer."""
    firsts = np.arange(0, len(stamps), samples)
    counts = np.diff(np.append(firsts, len(stamps)))
    return np.add.reduceat(stamps, firsts) / counts, np.add.reduceat(values, firsts) / counts


def _named(whole: Recording, signals: Signals, is_part: bool) -> Recording:
    name = whole.name
    if is_part:
        name = f'{name}, {signals.wrench_t[0]:.1f} to {signals.wrench_t[-1]:.1f} s'
    return replace(whole, name=name, signals=signals)


def _period(stamps: Array) -> float:
    return float(np.median(np.diff(stamps)))


_LEAST_SAMPLES = 30
_FEW = 3  # episodes, from which on a whole one can be spared
_THIRDS, _BLOCKS = 3, 5  # of a single episode or an attached wall; blocks of each
_LATE = (3, 4, 2)  # those that may be held out, the best place first


class HeldOut(NamedTuple):
    """The part of a recording that is excluded from fitting."""

    name: str  # such as 'episode 2' or '1.0 to 1.3, 2.0 to 2.3, 3.0 to 3.3 s'
    samples: Flags  # (N,) its samples


def episodes(model: Model, observed: Observed) -> list[tuple[int, int]]:
    """Find the contacts; what is short, unless all are, or hardly deep beside others, is none."""
    o = observed
    law = model.laws().contact
    if not law.unilateral:
        return []
    inside = law.contact(o.t, o.x, o.v).astype(int)
    edges = np.flatnonzero(np.diff(inside, prepend=0, append=0))
    pairs = list(zip(edges[::2].tolist(), edges[1::2].tolist()))
    least = _LEAST_CONTACT_S * o.pace / o.h
    if not any(stop - first >= least for first, stop in pairs):
        least = min(least, _LEAST_SAMPLES)  # a probe that touches briefly, sampled fast
    pairs = [(first, stop) for first, stop in pairs if stop - first >= least]
    depths = [float(np.max(o.x[first:stop])) - model.nominal.environment.location
              for first, stop in pairs]
    return [pair for pair, depth in zip(pairs, depths) if depth >= SLIGHT * max(depths)]


def require_contact(model: Model, observed: Observed, name: str) -> None:
    """Check that the recording has a contact."""
    if model.nominal.environment.unilateral and not episodes(model, observed):
        location = model.nominal.environment.location
        raise RecordingError(
            f'{name} has no contact of {_LEAST_SAMPLES} samples or more: expected x '
            f'beyond {location:g} m (environment.location), got at most '
            f'{np.max(observed.x):.6g} m; record a contact, or correct the location in the model')


def hold_out(model: Model, observed: Observed) -> HeldOut:
    """
    Choose what is held out of a recording: a whole episode, or a late block of each third.

    Never the deepest episode, which would be extrapolation; the nearest to the middle.
    Of one or two episodes, or an attached wall, each third spares a block of its last three
    fifths, a fifteenth of the whole: one block alone may lie where any model is right.
    Blocks are chosen, where possible, at depths and forces that occur in the rest too. All have
    as much force over way and time: none lies where a tool has left or amplitudes are small.
    """
    o = observed
    found = episodes(model, o)
    if len(found) < _FEW:
        touching = np.full(len(o.t), not found)
        for first, stop in found:
            touching[first:stop] = True
        return _late_blocks(o, touching)
    depth = [float(np.max(o.x[first:stop])) for first, stop in found]
    others, middle = set(range(len(found))) - {int(np.argmax(depth))}, len(found) // 2
    chosen = min(others, key=lambda k: (abs(k - middle), k))
    first = (found[chosen - 1][1] + found[chosen][0]) // 2 if chosen else 0
    last = chosen + 1 == len(found)
    stop = len(o.t) if last else (found[chosen][1] + found[chosen + 1][0]) // 2
    samples = np.zeros(len(o.t), bool)
    samples[first:stop] = True
    return HeldOut(f'episode {chosen + 1}', samples)


def _late_blocks(o: Observed, touching: Flags) -> HeldOut:
    """Hold out a late block of each third; all blocks have as much force over way and time."""
    count = _THIRDS * _BLOCKS
    way = np.append(0.0, np.abs(np.diff(o.x)) * (touching[1:] & touching[:-1]))
    told = np.cumsum(np.abs(o.force) * touching * (way / max(way.mean(), 1e-300) + 1.0))
    edges = np.searchsorted(told, told[-1] * np.arange(count + 1) / count)
    samples, names = np.zeros(len(o.t), bool), []
    digits = max(1, 1 + ceil(-log10(o.pace)))
    for third in range(_THIRDS):
        numbers = [third * _BLOCKS + k for k in _LATE]
        blocks = [(int(edges[k]), int(max(edges[k + 1], edges[k] + 1))) for k in numbers]
        begin, end = max(
            blocks, key=lambda pair: _visited(o.x, *pair) + _visited(o.force, *pair))
        samples[begin:end] = True
        names.append(f'{o.t[begin]:.{digits}f} to {o.t[end - 1]:.{digits}f}')
    return HeldOut(f'{", ".join(names)} s', samples)


def _visited(x: Array, begin: int, end: int) -> bool:
    """Return whether most values of a block occur elsewhere too."""
    rest = np.sort(np.concatenate((x[:begin], x[end:])))
    here, near = x[begin:end], SLIGHT * float(np.ptp(x))
    count = np.searchsorted(rest, here + near) - np.searchsorted(rest, here - near)
    return float(np.mean(count > 0)) > MOST
