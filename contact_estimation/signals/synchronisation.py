# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Pairing of wrenches and joint states by their stamps."""

from collections import Counter, deque
from dataclasses import dataclass
from itertools import repeat
from math import inf, isfinite, nan
from typing import Any, Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from .contact_sample import AxesSample, ContactSample
from .stamp_screen import BEFORE_ANY, StampScreen
from ..parameters import parameter, ParameterGroup

MakeSample = Callable[[int, Sequence[float], Sequence[float]], Any]
Columns = Sequence[NDArray[np.float64]]
"""An array of shape (N,) for each axis."""

_new = tuple.__new__  # of a named tuple: half the time of a call of its class
_MOTIONS_KEPT = 10_000  # while no wrench comes
_NOTHING: tuple[AxesSample, ...] = ()


@dataclass(frozen=True)
class SynchronisationParameters(ParameterGroup):
    """Time limits of the pairing, and the ranges of valid measurements."""

    timeout_s: float = parameter(
        0.1, 'A wrench is dropped when no joint state at or after it comes within this time', 's',
        minimum=1e-3, maximum=60.0,
    )
    maximum_gap_s: float = parameter(
        0.05, 'No interpolation between joint states further apart than this. A stamp that is '
        'further ahead is false, unless the next messages confirm it', 's', minimum=1e-4,
        maximum=10.0,
    )
    time_jump_s: float = parameter(
        0.5, 'A stamp that is further behind the last ones than this is false, unless the next '
        'messages confirm that the clock was set back', 's', minimum=1e-3, maximum=1e6,
    )
    offset: float = parameter(
        0.0,
        'Added to the stamps of the joint states: positive where the wrench is stamped too late '
        '(or the joint states too early), negative the other way; the joint states that a '
        'negative one delays must come within timeout_s', 's', minimum=-10.0, maximum=10.0,
    )
    timing_std: float = parameter(
        1e-3,
        'Standard deviation of the time between force and motion that no stamp shows: lag of the '
        'force sensor, delay of its driver. Times K_hat, it is part of the deviation of B_hat',
        's', minimum=0.0, maximum=1.0,
    )
    maximum_force: float = parameter(
        1e6, 'A larger force is rejected; set it to the range of the sensor', 'N', minimum=1.0
    )
    maximum_position: float = parameter(
        1e3, 'A larger position (of an arm: of a joint) is rejected', 'm', minimum=1e-3
    )
    maximum_velocity: float = parameter(
        1e3, 'A larger velocity (of an arm: of a joint) is rejected', 'm/s', minimum=1e-3
    )


class Synchroniser:
    """
    Pair each wrench with the motion at its stamp, on all axes at once.

    A wrench is paired when a joint state stamped at or after it has come; the motion is
    interpolated to the stamp of the wrench. Where one axis has no valid measurement, the message
    is rejected for all, so that all axes have the same samples. The result depends on the messages
    and their stamps, not on which topic was served first. Stamps are screened before all else, see
    `StampScreen`.

    jumped: set at a backward clock jump; reset by the user of the samples
    """

    def __init__(
        self, parameters: SynchronisationParameters, sample: MakeSample | None = None
    ) -> None:
        self._sample = sample or _sample
        self.configure(parameters)
        self.rejected: Counter[str] = Counter()
        self.time_jumps = 0
        self.jumped = False
        self._wrenches: deque[tuple[int, Sequence[float]]] = deque()
        self._motions: deque[tuple[int, Sequence[float]]] = deque()
        self._wrench_screen = StampScreen('wrench', self.rejected)
        self._motion_screen = StampScreen('joint', self.rejected)
        self._last_wrench_ns = self._last_motion_ns = BEFORE_ANY

    @property
    def waits(self) -> bool:
        """Whether a wrench waits for its joint state."""
        return bool(self._wrenches)

    @property
    def motion_lag_s(self) -> float:
        """Newest stamp of a wrench less that of a joint state [s]; NaN before both."""
        if min(self.newest_ns) == BEFORE_ANY:
            return nan
        return (self._last_wrench_ns - self._last_motion_ns) * 1e-9

    @property
    def newest_ns(self) -> tuple[int, int]:
        """Last stamps used of wrenches and joint states [ns]."""
        return self._last_wrench_ns, self._last_motion_ns

    def configure(self, parameters: SynchronisationParameters) -> None:
        """Set other limits, as for the constructor."""
        self._timeout_ns = int(parameters.timeout_s * 1e9)
        self._gap_ns = int(parameters.maximum_gap_s * 1e9)
        self._jump_ns = int(parameters.time_jump_s * 1e9)
        self._offset_ns = round(parameters.offset * 1e9)
        self._largest_force = parameters.maximum_force
        self._largest_position = parameters.maximum_position
        self._largest_velocity = parameters.maximum_velocity
        self._surely_valid = min(parameters.maximum_position, parameters.maximum_velocity)

    def add_wrench(self, stamp_ns: int, forces: Sequence[float]) -> Sequence[AxesSample]:
        """
        Return the samples completed by a wrench.

        stamp_ns: header stamp [ns]
        forces: F_e along each axis [N]
        """
        last_ns, screen = self._last_wrench_ns, self._wrench_screen
        if last_ns < stamp_ns <= last_ns + self._gap_ns and not screen.held:
            return self._take_wrench(stamp_ns, forces)  # the usual case
        samples: list[AxesSample] = []
        for stamp_ns, forces in screen.admit(
                (stamp_ns, forces), last_ns, self._last_motion_ns, self._gap_ns, self._jump_ns):
            if stamp_ns < self._last_wrench_ns:
                self._restart(stamp_ns)
            samples += self._take_wrench(stamp_ns, forces)
        return samples

    def _take_wrench(self, stamp_ns: int, forces: Sequence[float]) -> Sequence[AxesSample]:
        self._wrench_screen.before_ns, self._last_wrench_ns = self._last_wrench_ns, stamp_ns
        for force in forces:
            if not abs(force) <= self._largest_force:  # also true for NaN
                self._reject('wrench', force)
                return _NOTHING
        motions = self._motions
        if motions and not self._wrenches and motions[-1][0] == stamp_ns:
            while len(motions) > 1:  # the usual case: both stamps are equal
                motions.popleft()
            return (self._sample(stamp_ns, motions[0][1], forces),)
        self._wrenches.append((stamp_ns, forces))
        return self._pair()

    def add_motion(self, stamp_ns: int, motion: Sequence[float]) -> Sequence[AxesSample]:
        """
        Add a joint state.

        stamp_ns: header stamp [ns]
        motion: x of each axis [m], then its rate of each axis [m/s], NaN where not measured
        """
        stamp_ns += self._offset_ns
        last_ns, screen = self._last_motion_ns, self._motion_screen
        if last_ns < stamp_ns <= last_ns + self._gap_ns and not screen.held:
            return self._take_motion(stamp_ns, motion)  # the usual case
        samples: list[AxesSample] = []
        for stamp_ns, motion in screen.admit(
                (stamp_ns, motion), last_ns, self._last_wrench_ns, self._gap_ns, self._jump_ns,
                self._offset_ns):
            if stamp_ns < self._last_motion_ns:
                self._motions.clear()
            samples += self._take_motion(stamp_ns, motion)
        return samples

    def _take_motion(self, stamp_ns: int, motion: Sequence[float]) -> Sequence[AxesSample]:
        self._motion_screen.before_ns, self._last_motion_ns = self._last_motion_ns, stamp_ns
        for value in motion:
            if not abs(value) <= self._surely_valid:  # also true for NaN
                checked = self._checked(motion)
                if checked is None:
                    return _NOTHING
                motion = checked
                break
        wrenches = self._wrenches
        if len(wrenches) == 1 and wrenches[0][0] == stamp_ns:
            forces = wrenches.popleft()[1]
            self._motions.clear()
            self._motions.append((stamp_ns, motion))
            return (self._sample(stamp_ns, motion, forces),)
        self._motions.append((stamp_ns, motion))
        if wrenches:
            return self._pair()
        if len(self._motions) > 2:
            self._drop_old_motions()
        return _NOTHING

    def add_pairs(
        self, stamps_ns: NDArray[np.int64], forces: Columns, positions: Columns,
        velocities: Columns,
    ) -> bool:
        """
        Add wrenches and joint states that have the same stamps, many at once.

        They are the samples that `add_wrench` and `add_motion` would return one by one.

        stamps_ns (N,): stamps of both [ns]
        forces, positions, velocities (N,): F_e [N], x [m] and its rate [m/s], NaN where not
        measured, of each axis
        """
        last, steps = max(self.newest_ns), np.diff(stamps_ns)
        begin = int(stamps_ns[0]) - last if last != BEFORE_ANY else 1 + int(stamps_ns[0])
        regular = (
            not (self._wrenches or self._wrench_screen.held or self._motion_screen.held)
            and not self._offset_ns
            and 0 < begin and (begin <= self._gap_ns or last == BEFORE_ANY)
            and bool(((steps > 0) & (steps <= self._gap_ns)).all())
            and all(bool((np.abs(F) <= self._largest_force).all()) for F in forces)
            and all(bool((np.abs(x) <= self._largest_position).all()) for x in positions)
            and not any(bool((np.abs(v) > self._largest_velocity).any()) for v in velocities)
        )
        if regular:
            before = int(stamps_ns[-2]) if len(stamps_ns) > 1 else None
            self._wrench_screen.before_ns, self._motion_screen.before_ns = (
                self.newest_ns if before is None else (before, before))
            self._last_wrench_ns = self._last_motion_ns = int(stamps_ns[-1])
            self._motions.clear()
            self._motions.append((int(stamps_ns[-1]), tuple(
                float(column[-1]) for column in (*positions, *velocities))))
        return regular

    def _checked(self, motion: Sequence[float]) -> Sequence[float] | None:
        """Return a motion with NaN for an infinite velocity; None where it is rejected."""
        infinite = False  # an infinite velocity counts as not measured
        for position, velocity in zip(motion, motion[len(motion) // 2:]):
            speed = abs(velocity)
            if not abs(position) <= self._largest_position or self._largest_velocity < speed < inf:
                self._reject('joint', position)
                return None
            infinite |= speed == inf
        return tuple([nan if abs(value) == inf else value for value in motion]) if infinite else (
            motion)

    def _reject(self, kind: str, value: float) -> None:
        """Count a message by the first of its values that is no measurement."""
        self.rejected[f'{kind}_absurd' if isfinite(value) else f'{kind}_not_finite'] += 1

    def _restart(self, stamp_ns: int) -> None:
        # Joint states from before the jump pair with no wrench any more; those that jumped first
        # are kept.
        newest = stamp_ns + self._jump_ns
        self._motions = deque(motion for motion in self._motions if motion[0] <= newest)
        self.time_jumps += 1
        self.jumped = True
        self.rejected['joint_missing'] += len(self._wrenches)
        self._wrenches.clear()

    def _drop_old_motions(self) -> None:
        # Keeps one at or before the last wrench, to interpolate from, and all after it.
        motions, limit = self._motions, self._last_wrench_ns
        if limit > self._last_motion_ns + self._jump_ns:
            limit = BEFORE_ANY  # the clock jumped back, and no wrench has come since
        while len(motions) > 1 and (motions[1][0] <= limit or len(motions) > _MOTIONS_KEPT):
            motions.popleft()

    def _pair(self) -> list[AxesSample]:
        samples: list[AxesSample] = []
        wrenches, motions = self._wrenches, self._motions
        while wrenches:
            stamp_ns, forces = wrenches[0]
            if not motions or motions[-1][0] < stamp_ns:
                newest = max(self._last_wrench_ns, motions[-1][0] if motions else stamp_ns)
                if newest - stamp_ns <= self._timeout_ns:
                    break
                self.rejected['joint_missing'] += 1
            else:
                motion = self._motion_at(stamp_ns)
                if motion is not None:
                    samples.append(self._sample(stamp_ns, motion, forces))
            wrenches.popleft()
        return samples

    def _motion_at(self, stamp_ns: int) -> Sequence[float] | None:
        motions = self._motions
        while len(motions) > 1 and motions[1][0] <= stamp_ns:
            motions.popleft()
        first_ns, first = motions[0]
        if first_ns == stamp_ns:
            return first
        if first_ns > stamp_ns:
            self.rejected['joint_missing'] += 1  # none at or before it
            return None
        second_ns, second = motions[1]
        if second_ns - first_ns > self._gap_ns:
            self.rejected['joint_gap'] += 1
            return None
        share = (stamp_ns - first_ns) / (second_ns - first_ns)
        return [a + share * (b - a) for a, b in zip(first, second)]


def _sample(stamp_ns: int, motion: Sequence[float], forces: Sequence[float]) -> AxesSample:
    if len(forces) == 1:
        return (_new(ContactSample, (stamp_ns, motion[0], motion[1], forces[0])),)
    velocities = motion[len(forces):]
    return tuple(map(ContactSample, repeat(stamp_ns), motion, velocities, forces))
