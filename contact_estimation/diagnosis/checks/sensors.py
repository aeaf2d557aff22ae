# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Checks of the sensors: sources, jumps, steps of the zero, limits and resolution."""

from math import sqrt

import numpy as np
from numpy.typing import NDArray
from scipy.signal import medfilt

from .check import Finding, LISTED, WORTH_A_NAME
from .quantities import Quantities
from ..observe.shares import LITTLE, MOST, MUCH, SLIGHT
from ..observe.signals import Signals
from ..observe.smoothing import quantisation_step
from ...physics.numeric import Array, stretches
from ...signals.stream_faults import courses_of, TARE_DUE, zero_steps as steps_of

_RUN = 5  # samples: their median ignores two that jump; noise does not repeat a value so often


def two_sources(quantities: Quantities) -> Finding:
    """Find a force or a position that alternates between two signals."""
    s = quantities.whole
    for signal, topic, unit, values in (('force', 'wrench', 'N', s.force),
                                        ('position', 'joint_states', 'm', s.position)):
        found = courses_of(values, LITTLE * float(np.ptp(values)))
        if found is not None:
            return Finding(False, found.text(signal, topic, unit))
    return Finding(True, 'force and position have one course each')


def spikes(quantities: Quantities) -> Finding:
    """Find positions that jump away and back within two samples."""
    s = quantities.whole
    found = jumps(s.position)
    if not found.any():
        return Finding(True, 'no position jumps away and back')
    t, x = s.joint_t[found][0], s.position[found][0]
    return Finding(False, f'{np.count_nonzero(found)} position(s) jump away and back, the first '
                          f'to {x:.6g} m at {t:.6g} s: they are left out; check the encoder',
                   fatal=False)


def jumps(position: Array) -> NDArray[np.bool_]:
    """
    Return which positions [m] jump away and back, shape (N,).

    None if there are too many, or others are nearly as far away: the motion is sampled coarsely.
    """
    usual = medfilt(position, _RUN)
    usual[:2], usual[-2:] = usual[2], usual[-3]  # the filter pads with zeros
    away = np.abs(position - usual)
    found = away > MOST * np.ptp(usual)
    none = np.zeros(len(position), bool)
    if not found.any() or np.mean(found) >= SLIGHT:
        return none
    return found if np.max(away[~found]) < MOST * np.min(away[found]) else none


def without_spikes(signals: Signals) -> Signals:
    """Leave out positions that jump away and back."""
    kept = ~jumps(signals.position)
    return signals._replace(joint_t=signals.joint_t[kept], position=signals.position[kept])


def zero_steps(quantities: Quantities) -> Finding:
    """
    Find steps of the force in free flight, at once or from before a contact to after it.

    A drift is none: it is as fast in free flight.
    """
    onset, s = quantities.onset, quantities.whole
    if not quantities.model.environment.unilateral or onset is None:
        return Finding(True, 'no free flight')
    x = np.interp(s.wrench_t, s.joint_t, s.position)
    free = x < onset.position - MUCH * (onset.position - float(np.min(x)))
    least = max(quantities.force_noise, WORTH_A_NAME / TARE_DUE * float(np.ptp(s.force)))
    steps = steps_of(s.wrench_t[free], s.force[free], least)
    if not steps:
        return Finding(True, 'the zero of the force sensor does not step')
    times = ', '.join(f'by {one.size:+.2g} N between {one.begin:.4g} and {one.end:.4g} s'
                      for one in steps[:LISTED])
    return Finding(False, f'the zero of the force sensor steps {times}: the driver zeroes the '
                          'sensor, or it slips; zero it before the recording and not during it, '
                          'or cut the recording there')


def force_clipping(quantities: Quantities) -> Finding:
    """Find a force that stays at exactly its extreme value, again and again, in motion."""
    for part in quantities.parts:
        x = np.interp(part.wrench_t, part.joint_t, part.position)
        for limit in (float(np.min(part.force)), float(np.max(part.force))):
            if abs(limit) < MUCH * float(np.ptp(part.force)):  # free flight
                continue
            runs = _moving_runs(part.force == limit, x)
            if runs > 1:
                return Finding(False, f'the force stays at exactly {limit:.6g} N in {runs} '
                                      'stretches of motion, expected to change: the sensor is at '
                                      'the limit of its range; press less or choose a larger '
                                      'range. Of what clipping looks like only force_saturation '
                                      'is named', fatal=False)
    return Finding(True, 'no flat tops')


def _moving_runs(flat: NDArray[np.bool_], x: Array) -> int:
    least = SLIGHT * float(np.ptp(x))
    return sum(bool(flat[first]) and stop - first >= _RUN
               and float(np.ptp(x[first:stop])) > least for first, stop in stretches(flat))


def quantisation(quantities: Quantities) -> Finding:
    """Find positions rounded more coarsely than their noise and than the depth deserves."""
    step = quantisation_step(quantities.whole.position)
    depth = float(np.ptp(quantities.smooth.x))
    if quantities.model.environment.unilateral and quantities.onset is not None:
        depth = quantities.onset.depth
    if step == 0.0:
        return Finding(True, 'positions are not rounded')
    text = f'positions are rounded to {step:.3g} m, {100.0 * step / max(depth, step):.2g} % of ' \
           'the depth'
    coarse = 0.5 * WORTH_A_NAME  # two roundings, of place and surface, are worth a name
    if step < coarse * depth or step / sqrt(12.0) < quantities.position_noise:
        return Finding(True, text)
    return Finding(False, f'{text}, expected less than {100.0 * coarse:g} %: the rounding is '
                          'treated as noise, and no effect of such a size is named; record more '
                          'digits', fatal=False)
