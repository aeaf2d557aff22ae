# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Checks of stamps: order, bursts, rate, gaps and the clocks of the topics."""

from math import log, pi, sqrt
from typing import Sequence

import numpy as np

from .check import Check, Finding, FOLLOWS
from .quantities import Quantities
from ..observe.parts import spans_of
from ..observe.shares import LITTLE, MOST, MUCH, SLIGHT
from ..observe.signals import LEAST_SAMPLES
from ...physics import EFFECTS
from ...signals.stream_faults import bursts_of

_BACK_S = 0.1  # late messages of a busy network arrive within that
_EARLY_S, _LATE_S = 0.03, 0.15  # a damped wall is ahead of its spring, a slow filter behind
_SAMPLES, _AHEAD_S = 3.0, 0.005  # least shifts: in samples; of a reference, a cycle of 200 Hz
_STRIDE = 10  # steps over which recorded rates are compared with differences of positions


def complete_file(quantities: Quantities) -> Finding:
    """Find what of the file is damaged or left out."""
    damage = quantities.recording.damage
    if not damage:
        return Finding(True, 'the file could be read as a whole')
    last = float(quantities.whole.wrench_t[-1])
    return Finding(False, f'{damage}; what was read lasts {last:.6g} s, and the rest is not '
                          'diagnosed', fatal=False)


def stamp_order(quantities: Quantities) -> Finding:
    """Find a clock that was set back: two stretches then lie over one another."""
    back = quantities.recording.stamps_back_s
    if back <= _BACK_S:
        return Finding(True, f'stamps jump back by {back:.3g} s at most')
    return Finding(False, f'stamps of wrench or joint_states jump back by {back:.3g} s, expected '
                          f'{_BACK_S:g} s at most: the clock was set back, or recordings were '
                          'joined; cut the recording there')


def stamp_bursts(quantities: Quantities) -> Finding:
    """Find wrenches whose stamps tell when a buffer was read, not when the force was measured."""
    bursts = bursts_of(quantities.whole.wrench_t)
    if bursts is None:
        return Finding(True, 'stamps of the wrench come one by one')
    return Finding(False, bursts.text)


def sampling_rate(quantities: Quantities) -> Finding:
    """Find sampling too slow for the oscillation of robot or mass and wall, or in another unit."""
    rate, angular = 1.0 / quantities.period, _natural_frequency(quantities)
    if angular is None or not quantities.overlap.enough:
        return Finding(True, f'{rate:.3g} Hz')
    text = f'{rate:.3g} Hz for an oscillation of wall and mass at {angular / (2.0 * pi):.3g} Hz'
    unlike = _rates_over_stamps(quantities)
    if unlike is not None:
        return Finding(False, f'{text}; x_r moves {1.0 / unlike:.3g} times as fast as its '
                              'recorded rates, expected 1: stamps or rates have another unit, '
                              'or another clock; record seconds')
    turn = angular * quantities.period  # [rad] of the oscillation, a sample
    if turn > 2.0 * pi:
        return Finding(False, f'{text}: nothing of it can be seen; check the unit of the stamps, '
                              'or record at a higher rate')
    if turn < 1.0:
        return Finding(True, text)
    return Finding(False, f'{text}, expected at least {2.0 * pi:.1f} samples a period; '
                          'record at a higher rate. No fast dynamics are named', fatal=False)


def _rates_over_stamps(quantities: Quantities) -> float | None:
    """Return the ratio of recorded rates to differences of the reference if it is not 1."""
    t, (x, v, _, _) = quantities.whole.reference_t, quantities.whole.reference
    if len(t) <= _STRIDE:
        return None
    travel = np.concatenate([[0.0], np.cumsum(0.5 * (v[1:] + v[:-1]) * np.diff(t))])
    foretold, moved = (row[_STRIDE:] - row[:-_STRIDE] for row in (travel, x))
    fast = np.abs(foretold) > MUCH * np.max(np.abs(foretold))
    if np.count_nonzero(fast) < LEAST_SAMPLES:
        return None
    with np.errstate(divide='ignore'):  # of a reference that is held
        ratios = foretold[fast] / moved[fast]
    low, usual, high = np.quantile(ratios, (0.25, 0.5, 0.75))
    unlike = usual > 0.0 and abs(log(usual)) > log(1.0 + SLIGHT)
    return float(usual) if unlike and high - low < LITTLE * usual else None


def _natural_frequency(quantities: Quantities) -> float | None:
    """Return the natural frequency of the nominal contact [rad/s]."""
    wall, robot = quantities.model.environment, quantities.model.robot
    if quantities.with_reference:
        return sqrt(max(wall.stiffness + robot.stiffness, 0.0) / robot.mass)
    if not wall.unilateral and wall.inertia > 0.0:
        return sqrt(max(wall.stiffness, 0.0) / wall.inertia)
    return None


def clock_offset(quantities: Quantities) -> Finding:
    """Find topics that do not overlap, or a force that no sensor can measure so early or late."""
    overlap = quantities.overlap
    if not overlap.enough:
        return Finding(False, f'{overlap.text}: expected the same time, got '
                              f'{overlap.seconds:.3g} s in common; stamp all topics by one '
                              'clock, in one unit, or take the time of reception with --stamps '
                              'received')
    if not quantities.model.environment.unilateral:
        return Finding(True, overlap.text)
    lag = quantities.lag
    text = f'the force fits the motion best when shifted by {1e3 * lag.seconds:.0f} ms'
    off = lag.seconds > _LATE_S or lag.seconds < -_EARLY_S
    # Dissipation is ahead of the motion too, but a shift leaves most of its variance.
    explains = 1.0 - lag.correlation**2 < MOST * (1.0 - lag.unshifted**2)
    # A damped contact is ahead of its spring, but not of what the robot felt.
    felt = quantities.with_reference and quantities.of_robot.correlation > lag.correlation
    # What is held back as it leaves is ahead as well; a robot would have felt that.
    held = quantities.pulls and not quantities.with_reference
    resolved = abs(lag.seconds) > _SAMPLES * quantities.period
    # What yields is ahead of its spring, but peaks with it.
    shifted = off and MOST * abs(lag.seconds) > abs(
        quantities.peaks_apart(abs(lag.seconds)) - lag.seconds)
    if (shifted and explains and not felt and not held and resolved and lag.correlation > FOLLOWS):
        return Finding(False, f'{text}, expected {-1e3 * _EARLY_S:.0f} to {1e3 * _LATE_S:.0f} ms: '
                              'the clocks of wrench and joint_states differ; synchronise them')
    return Finding(True, text)


def with_offset(
    checks: Sequence[Check], topic: str, late: float, commanded: bool = True,
    could_cause: frozenset[str] | None = None,
) -> list[Check]:
    """
    Replace the result of `clock_offset`: the stamps of a topic are late, or early if negative [s].

    `commanded` is whether there is a robot with a reference; otherwise a force drives the wall.
    `could_cause` are the effects that are not named then; None, if nothing is.
    """
    side, when = ('late', 'earlier') if late > 0.0 else ('early', 'later')
    others = 'command and force both fit the motion'
    if topic == 'wrench':
        others = 'the force fits motion and command'
    cause = f'{topic} are' if topic == 'joint_states' else f'{topic} is'
    cause += f' stamped {side}' + (' or filtered' if late > 0.0 else '')
    if not commanded:
        others = 'the force that drives the wall fits the motion'
        cause += ', or wrench is a command that the drive follows late; record the measured force'
    elif late < 0.0:
        cause += ', or the other topics late'
    joints = late if topic == 'joint_states' else -late
    text = (f'{others} best about {1e3 * abs(late):.2g} ms {when}, '
            f'expected at the same instant: {cause}; stamp each sample when it is '
            f'measured (on line, set synchronisation.offset to {-joints:.2g} s)')
    fatal, causes = could_cause is None, frozenset(EFFECTS) if could_cause is None else could_cause
    return [Check(one.name, False, text, fatal, causes)
            if one.name == 'clock_offset' else one for one in checks]


def reference_clock(quantities: Quantities) -> Finding:
    """Find a reference that is stamped later than the robot follows it."""
    if not quantities.with_reference:
        return Finding(True, 'no reference_trajectory')
    early = quantities.ahead_of_reference
    text = f'the motion fits the reference best {1e3 * early.seconds:.0f} ms ahead of it'
    least = max(_AHEAD_S, _SAMPLES * quantities.period)
    if early.seconds <= least or early.left >= MUCH:
        return Finding(True, text)
    return Finding(False, f'{text}, expected 0 or later: no robot moves before its command; '
                          'stamp reference_trajectory by the clock of joint_states, with the '
                          'instant from which the robot follows it')


def common_time(quantities: Quantities) -> Finding:
    """Find a topic that begins late or ends early: much of the others has no counterpart."""
    overlap = quantities.overlap
    spans = (overlap.spans[name] for name in ('wrench', 'joint_states'))
    longest = max(end - begin for begin, end in spans)
    if overlap.seconds >= (1.0 - MUCH) * longest:
        return Finding(True, overlap.text)
    return Finding(False, f'{overlap.text}: the {overlap.seconds:.3g} s in which all topics were '
                          'recorded are diagnosed, the rest is not; record all topics from '
                          'begin to end', fatal=False)


def gaps(quantities: Quantities) -> Finding:
    """Find pauses of wrench or joint states."""
    spans = spans_of(quantities.whole)
    pauses = [(end, begin) for (_, end), (begin, _) in zip(spans[:-1], spans[1:])]
    if not pauses:
        return Finding(True, 'no pause')
    end, begin = max(pauses, key=lambda pause: pause[1] - pause[0])
    return Finding(False, f'{len(pauses)} pause(s) of wrench or joint_states, the longest from '
                          f'{end:.6g} to {begin:.6g} s, expected none: the stretches between them '
                          'are fitted as parts; record without a pause to name effects with a '
                          'memory', fatal=False)
