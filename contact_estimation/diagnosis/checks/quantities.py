# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Quantities of a recording from which the checks decide, each computed once."""

from functools import cached_property
from math import sqrt

import numpy as np
from numpy.typing import NDArray
from scipy.signal import correlate, correlation_lags, savgol_filter

from .check import Early, Lag, Line, line_through, Onset, Overlap, Smooth
from ..observe.parts import continuous_parts
from ..observe.shares import LITTLE, MOST, MUCH, SLIGHT
from ..observe.signals import LEAST_SAMPLES, Recording, Signals
from ..observe.smoothing import pace_of, white_noise_std
from ...physics.numeric import Array, Flags
from ...physics.robot_law import RobotLaw
from ...plant.plant_parameters import PlantParameters
from ...signals.stream_faults import CLEAR

# Of the range of the smoothed force. On 60 simulated contacts its onset is then where the wall is
# within 2 % of the depth (median); at a fiftieth or a tenth of the range it is off by 4 or 8 %.
_ONSET = 0.04
_WINDOW_S, _ORDER = 0.08, 3  # smoothing: shorter than a touch-down takes; with a jerk
_BINS = 25  # of force or position; of 1000 samples 40 are in each
_LONGEST_AHEAD_S = 0.4  # search for a late reference: a second would take seconds


class Quantities:
    """Quantities of a recording, in part in comparison with the nominal model."""

    def __init__(
        self, whole: Signals, model: PlantParameters, recording: Recording | None = None,
    ) -> None:
        self.whole, self.model = whole, model
        self.recording = recording or Recording('', whole)

    @cached_property
    def parts(self) -> list[Signals]:
        """Its parts between gaps, in which both topics have samples."""
        return [part.signals for part in continuous_parts(Recording('', self.whole), self.model)]

    @cached_property
    def _longest(self) -> 'Quantities':
        """Quantities of the longest part."""
        if len(self.parts) == 1:
            return self
        return Quantities(max(self.parts, key=lambda part: len(part.wrench_t)), self.model)

    @cached_property
    def overlap(self) -> Overlap:
        """Return the time that all topics cover."""
        s = self.whole
        topics = {'wrench': s.wrench_t, 'joint_states': s.joint_t}
        if len(s.reference_t) > 1:
            topics['reference_trajectory'] = s.reference_t
        spans = {name: (float(t[0]), float(t[-1])) for name, t in topics.items()}
        first, last = max(span[0] for span in spans.values()), min(
            span[1] for span in spans.values())
        shortest = min(spans[name][1] - spans[name][0] for name in ('wrench', 'joint_states'))
        counts = [np.count_nonzero((t >= first) & (t <= last)) for t in (s.wrench_t, s.joint_t)]
        enough = last - first >= MOST * shortest and min(counts) >= LEAST_SAMPLES
        return Overlap(spans, max(last - first, 0.0), bool(enough))

    @property
    def with_reference(self) -> bool:
        """Whether a reference tells what a robot was to do."""
        return all(len(part.reference_t) > 1 for part in self.parts)

    @cached_property
    def period(self) -> float:
        """Sample period of the wrench [s]."""
        return float(np.median(np.diff(self.parts[0].wrench_t)))

    @cached_property
    def _window(self) -> int:
        return _window(self.period, float(np.ptp(self.parts[0].wrench_t)))

    @cached_property
    def smooth(self) -> Smooth:
        """Return the signals."""
        rows = [_smooth(part, self.with_reference) for part in self.parts]
        joined = [None if column[0] is None else np.concatenate(column, axis=-1)
                  for column in zip(*rows)]
        force, x, v, a, reference, rate = joined
        assert force is not None and x is not None and v is not None and a is not None
        return Smooth(force, x, v, a, reference, rate)

    @cached_property
    def force_noise(self) -> float:
        """White noise of the force [N]."""
        return white_noise_std(max((part.force for part in self.parts), key=len))

    @cached_property
    def position_noise(self) -> float:
        """White noise of the position [m]."""
        return white_noise_std(max((part.position for part in self.parts), key=len))

    @property
    def clear_force(self) -> float:
        """Force that is clearly no noise after smoothing [N]."""
        return CLEAR * self.force_noise / sqrt(self._window)

    @cached_property
    def wall_force(self) -> Array:
        """Magnitude of the nominal wall's force at the measured motion, shape (N,) [N]."""
        wall, s = self.model.environment, self.smooth
        force = (wall.stiffness * (s.x - wall.location) + wall.damping * s.v + wall.inertia * s.a)
        if not wall.unilateral:
            return np.asarray(force)
        return np.where(s.x > wall.location, np.maximum(force, 0.0), 0.0)

    @cached_property
    def deviations(self) -> tuple[float, float]:
        """Return the standard deviations of the measured and the nominal wall's force [N]."""
        return float(np.std(self.smooth.force)), float(np.std(self.wall_force))

    @cached_property
    def implied_force(self) -> Array:
        """F_e that the nominal robot must have felt to move as it did, shape (N,) [N]; eq. (1)."""
        s = self.smooth
        return self.model.robot.mass * s.a - self._impedance_force(0, len(s.x))

    def _impedance_force(self, early: int, count: int) -> Array:
        """Return u of eq. (1) [N] at the first samples, the reference shifted by so many."""
        robot, s = self.model.robot, self.smooth
        assert s.reference is not None
        law = RobotLaw(robot.mass, robot.damping, robot.stiffness, ())
        reference = s.reference if robot.force_tracking else s.reference * [[1], [1], [1], [0]]
        return np.asarray(law.impedance_force(
            s.x[:count], s.v[:count], reference[:, early:early + count]))

    @cached_property
    def of_wall(self) -> Line:
        """Measured force over that of the nominal wall; slope 1 for a true model."""
        return line_through(self.wall_force, -self.smooth.force)

    @cached_property
    def of_robot(self) -> Line:
        """Measured force over the implied one; slope 1 for a true model."""
        return line_through(self.implied_force, self.smooth.force)

    @cached_property
    def followed(self) -> Line:
        """Velocity over that of the reference in free flight; slope 1 for a robot."""
        s = self.smooth
        assert s.reference_rate is not None
        place = _bins(s.force)
        # The force of free flight is one value, at which the reference moves most.
        most = int(np.argmax(np.bincount(place, s.reference_rate**2, _BINS)))
        free = np.abs(place - most) <= 1
        return line_through(s.reference_rate[free], s.v[free])

    @cached_property
    def repeats(self) -> float:
        """Correlation over the place of the force on the way in with that on the way out."""
        s, place = self.smooth, _bins(self.smooth.x)
        counts, sums = (np.array([np.bincount(place[way], values[way], _BINS)
                                  for way in (s.v > 0.0, s.v < 0.0)])
                        for values in (np.ones(len(s.x)), s.force))
        both = (counts > 1).all(axis=0)
        way_in, way_out = sums[:, both] / counts[:, both]
        return line_through(way_in, way_out).correlation if both.sum() > 2 else 0.0

    @cached_property
    def _at_ends(self) -> tuple[Array, Array]:
        """Return the forces at the lowest and at the highest tenth of the positions [N]."""
        s = self.smooth
        low, high = np.quantile(s.x, (LITTLE, 1.0 - LITTLE))
        return s.force[s.x <= low], s.force[s.x >= high]

    @cached_property
    def sides(self) -> tuple[float, float]:
        """Mean forces at the lowest and at the highest tenth of the positions [N]."""
        low, high = self._at_ends
        return float(np.mean(low)), float(np.mean(high))

    @cached_property
    def sides_beyond_zero(self) -> tuple[float, float]:
        """Return the same without the zero of the sensor."""
        # It is that of the lowest positions if the force is level there, as in free flight, and
        # not at the highest.
        low, high = self._at_ends
        if np.std(low) < LITTLE * np.std(high):
            return 0.0, self.sides[1] - self.sides[0]
        return self.sides

    @property
    def sees_free_flight(self) -> bool:
        """Whether the force is level at the lowest positions."""
        level = max(self.clear_force, LITTLE * self.deviations[0])
        return bool(np.std(self._at_ends[0]) < level)

    @cached_property
    def _in_contact(self) -> Flags:
        """Where the force is clearly not that of the lowest positions, shape (N,)."""
        force = self.smooth.force
        least = max(self.clear_force, _ONSET * float(np.ptp(force)))
        return np.asarray(np.abs(force - self.sides[0]) > least)

    @cached_property
    def motion_in_contact(self) -> tuple[Array, Array]:
        """Return time, in samples, and position [m] from the first contact to the last."""
        s = self.smooth
        if not self.model.environment.unilateral:
            return np.arange(float(len(s.x))), s.x
        contact = np.flatnonzero(self._in_contact)
        first, last = (contact[0], contact[-1] + 1) if len(contact) else (0, len(s.x))
        return np.arange(float(last - first)), s.x[first:last]

    @cached_property
    def pulls(self) -> bool:
        """Whether the surface pulls the tool back, beyond the force of free flight."""
        force = self.smooth.force
        least = max(self.clear_force, LITTLE * float(np.ptp(force)))
        return float(np.max(force)) - self.sides[0] > least

    @cached_property
    def onset(self) -> Onset | None:
        """Where contacts begin by the force; None without a contact."""
        s, contact = self.smooth, self._in_contact
        if not contact.any():
            return None
        first = np.flatnonzero(contact[1:] & ~contact[:-1])
        depth = float(np.quantile(s.x[contact], 0.95))
        if not len(first):
            return Onset(float(np.min(s.x)), depth - float(np.min(s.x)), 0.0)
        # A loose or bouncing wall is left and met again deep inside: the first entry after each
        # return from it tells where it begins.
        away = s.x < np.min(s.x) + MUCH * np.ptp(s.x)
        returns = np.cumsum(np.diff(away.astype(int), prepend=0) > 0)
        first = first[np.unique(returns[first], return_index=True)[1]]
        begin = float(np.median(s.x[first]))
        window = self.period * self._window
        return Onset(begin, depth - begin, window * float(np.median(np.abs(s.v[first]))))

    @cached_property
    def lag(self) -> Lag:
        """Shift of the wrench against the joints, by the force of the nominal wall."""
        one = self._longest
        force, wall = -one.smooth.force, one.wall_force
        force, wall = force - np.mean(force), wall - np.mean(wall)
        both = max(float(np.sqrt((force @ force) * (wall @ wall))), 1e-300)
        values = correlate(force, wall, method='fft') / both
        lags = correlation_lags(len(force), len(wall))
        near = np.abs(lags) < MUCH * len(force)
        values, lags = values[near], lags[near]
        best = int(np.argmax(values))
        unshifted = (values[lags == 0][0], line_through(one.smooth.x, force).correlation)
        return Lag(float(lags[best] * self.period), float(values[best]),
                   float(np.max(np.abs(unshifted))))

    def peaks_apart(self, longest: float) -> float:
        """Return by how much the force peaks after the deepest contact [s]."""
        # From where the one is first near its peak to where the other is; the peak of the force is
        # sought so long [s] around the contact.
        one = self._longest
        force, x, deepest = -one.smooth.force, one.smooth.x, int(np.argmax(one.smooth.x))
        away = np.flatnonzero(one.wall_force <= 0.0)
        around = round(longest / one.period)
        first = max(int(np.max(away[away < deepest], initial=-1)) + 1 - around, 0)
        stop = int(np.min(away[away > deepest], initial=len(x))) + around
        late, deep = (int(np.argmax(signal >= np.max(signal) - SLIGHT * np.ptp(signal)))
                      for signal in (force[first:stop], x[first:stop]))
        return (late - deep) * one.period

    @cached_property
    def ahead_of_reference(self) -> Early:
        """By how much the nominal robot is ahead of its reference."""
        one = self._longest
        felt = self.model.robot.mass * one.smooth.a - one.smooth.force
        most = min(round(_LONGEST_AHEAD_S / self.period), round(MUCH * len(felt)))
        count = len(felt) - most
        misfits = np.array([
            float(np.mean((felt[:count] - one._impedance_force(early, count)) ** 2))
            for early in range(most + 1)])
        best = int(np.argmin(misfits))
        return Early(best * self.period, float(misfits[best] / max(misfits[0], 1e-300)))


def _bins(values: Array) -> NDArray[np.int_]:
    """Return in which of the bins of its range each value is, shape (N,)."""
    edges = np.linspace(np.min(values), np.max(values), _BINS + 1)
    return np.clip(np.searchsorted(edges, values) - 1, 0, _BINS - 1)


def _window(period: float, duration: float) -> int:
    """Return the odd number of samples of a smoothing polynomial, which two must overdetermine."""
    half = round(0.5 * _WINDOW_S * pace_of(period, duration) / period)
    return max(_ORDER + 2, 2 * half + 1)


def _smooth(part: Signals, with_reference: bool) -> Smooth:
    span = float(np.ptp(part.wrench_t))
    h = float(np.median(np.diff(part.wrench_t)))
    t = np.linspace(part.wrench_t[0], part.wrench_t[-1], round(span / h) + 1)
    window = _window(h, span)

    def polynomial(stamps: Array, values: Array, rate: int = 0) -> Array:
        even = np.interp(t, stamps, values)
        return np.asarray(savgol_filter(even, window, _ORDER, deriv=rate, delta=h))

    x, v, a = (polynomial(part.joint_t, part.position, rate) for rate in range(3))
    force = polynomial(part.wrench_t, part.force)
    if not with_reference:
        return Smooth(force, x, v, a, None, None)
    rows = [polynomial(part.reference_t, row) for row in part.reference]
    rate = polynomial(part.reference_t, part.reference[0], 1)
    if not part.reference[1].any():  # rates were not recorded
        rows[1:3] = rate, polynomial(part.reference_t, part.reference[0], 2)
    return Smooth(force, x, v, a, np.array(rows), rate)
