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

"""Wrench and joint samples brought together by their stamps alone."""

from __future__ import annotations

from collections import Counter, deque
from dataclasses import dataclass
from math import inf, isfinite, nan
from typing import Iterable

import numpy as np
from numpy.typing import NDArray

from .contact_sample import ContactSample
from ..parameters.specification import parameter, ParameterGroup

Motion = tuple[int, float, float]  # stamp_ns, position, velocity
_MOTIONS_KEPT = 10_000  # where no wrench comes
_NOTHING: tuple[ContactSample, ...] = ()


@dataclass(frozen=True)
class SynchronisationParameters(ParameterGroup):
    """How long to wait, and what counts as a gap."""

    timeout_s: float = parameter(
        0.1, 'A wrench without a joint sample at or after it is given up after this', 's',
        minimum=1e-3, maximum=60.0,
    )
    maximum_gap_s: float = parameter(
        0.05, 'Joint samples further apart than this are not interpolated between', 's',
        minimum=1e-4, maximum=10.0,
    )
    time_jump_s: float = parameter(
        0.5, 'Stamps going back by more than this mean that time itself was set back', 's',
        minimum=1e-3, maximum=1e6,
    )
    maximum_force: float = parameter(
        1e6, 'A larger force is no measurement and is rejected; set it to the range of the sensor',
        'N', minimum=1.0,
    )
    maximum_position: float = parameter(
        1e3, 'A larger position is no measurement and is rejected', 'm', minimum=1e-3
    )
    maximum_velocity: float = parameter(
        1e3, 'A larger velocity is no measurement and is rejected', 'm/s', minimum=1e-3
    )


class Synchroniser:
    """
    Pair each wrench with the motion at its stamp.

    A wrench is paired when a joint sample stamped at or after it has come; the motion is
    interpolated to the wrench's stamp. The result depends on the samples and their stamps, not
    on which topic was served first.

    Parameters
    ----------
    parameters : SynchronisationParameters
        Time limits.

    Attributes
    ----------
    rejected : Counter
        Samples not used, by reason.
    time_jumps : int
        Times that the stamps were set back.

    """

    def __init__(self, parameters: SynchronisationParameters) -> None:
        self.configure(parameters)
        self.rejected: Counter[str] = Counter()
        self.time_jumps = 0
        self.jumped = False
        self._wrenches: deque[tuple[int, float]] = deque()
        self._motions: deque[Motion] = deque()
        self._last_wrench_ns = self._last_motion_ns = -(2**63)

    @property
    def waits(self) -> bool:
        """Whether a wrench waits for its joint sample."""
        return bool(self._wrenches)

    def configure(self, parameters: SynchronisationParameters) -> None:
        """
        Take other limits.

        Parameters
        ----------
        parameters : SynchronisationParameters
            Time limits.

        """
        self._timeout_ns = int(parameters.timeout_s * 1e9)
        self._gap_ns = int(parameters.maximum_gap_s * 1e9)
        self._jump_ns = int(parameters.time_jump_s * 1e9)
        self._largest_force = parameters.maximum_force
        self._largest_position = parameters.maximum_position
        self._largest_velocity = parameters.maximum_velocity

    def add_wrench(self, stamp_ns: int, force: float) -> Iterable[ContactSample]:
        """
        Take a wrench.

        Parameters
        ----------
        stamp_ns : int
            Header stamp [ns].
        force : float
            F_e [N].

        Returns
        -------
        samples : iterable of ContactSample
            All that are complete now.

        """
        if stamp_ns <= self._last_wrench_ns:
            if not self._set_back('wrench', stamp_ns, self._last_wrench_ns):
                return _NOTHING
            self._restart(stamp_ns)
        self._last_wrench_ns = stamp_ns
        if not abs(force) <= self._largest_force:  # NaN as well
            finite = isfinite(force)
            self.rejected['wrench_absurd' if finite else 'wrench_not_finite'] += 1
            return _NOTHING
        motions = self._motions
        if motions and not self._wrenches and motions[-1][0] == stamp_ns:
            last = motions[-1]  # the usual case: both stamps are one instant
            motions.clear()
            motions.append(last)
            return (ContactSample(stamp_ns, last[1], last[2], force),)
        self._wrenches.append((stamp_ns, force))
        return self._pair()

    def add_motion(
        self, stamp_ns: int, position: float, velocity: float
    ) -> Iterable[ContactSample]:
        """
        Take a joint sample.

        Parameters
        ----------
        stamp_ns : int
            Header stamp [ns].
        position, velocity : float
            x [m] and its rate [m/s], NaN where not measured.

        Returns
        -------
        samples : iterable of ContactSample
            All that are complete now.

        """
        if stamp_ns <= self._last_motion_ns:
            if not self._set_back('joint', stamp_ns, self._last_motion_ns):
                return _NOTHING
            self._motions.clear()
        self._last_motion_ns = stamp_ns
        if velocity in (inf, -inf):
            velocity = nan
        if not abs(position) <= self._largest_position or abs(velocity) > self._largest_velocity:
            finite = isfinite(position)
            self.rejected['joint_absurd' if finite else 'joint_not_finite'] += 1
            return _NOTHING
        wrenches = self._wrenches
        if len(wrenches) == 1 and wrenches[0][0] == stamp_ns:
            force = wrenches.popleft()[1]
            self._motions.clear()
            self._motions.append((stamp_ns, position, velocity))
            return (ContactSample(stamp_ns, position, velocity, force),)
        self._motions.append((stamp_ns, position, velocity))
        if wrenches:
            return self._pair()
        self._drop_old_motions()
        return _NOTHING

    def add_pairs(
        self,
        stamps_ns: NDArray[np.int64],
        forces: NDArray[np.float64],
        positions: NDArray[np.float64],
        velocities: NDArray[np.float64],
    ) -> list[ContactSample] | None:
        """
        Take wrenches and joint samples that have the same stamps, many at once.

        Gives what `add_wrench` and `add_motion` would give one by one, or refuses.

        Parameters
        ----------
        stamps_ns : ndarray of int64, shape (N,)
            Stamps of both [ns].
        forces, positions, velocities : ndarray, shape (N,)
            F_e [N], x [m] and its rate [m/s], NaN where not measured.

        Returns
        -------
        samples : list of ContactSample or None
            None where something is irregular, so that they must be taken one by one.

        """
        last = max(self._last_wrench_ns, self._last_motion_ns)
        regular = (
            not self._wrenches
            and int(stamps_ns[0]) > last
            and bool((np.diff(stamps_ns) > 0).all())
            and bool((np.abs(forces) <= self._largest_force).all())
            and bool((np.abs(positions) <= self._largest_position).all())
            and not bool((np.abs(velocities) > self._largest_velocity).any())
        )
        if not regular:
            return None
        columns = (stamps_ns, positions, velocities, forces)
        samples = list(map(ContactSample, *(column.tolist() for column in columns)))
        newest = samples[-1]
        self._last_wrench_ns = self._last_motion_ns = newest.stamp_ns
        self._motions.clear()
        self._motions.append(newest[:3])
        return samples

    def count(self, reason: str) -> None:
        """
        Count a sample that somebody else found unusable.

        Parameters
        ----------
        reason : str
            Why.

        """
        self.rejected[reason] += 1

    def _set_back(self, kind: str, stamp_ns: int, last_ns: int) -> bool:
        """Tell a jump of time from a duplicate or a late sample, and count the latter."""
        if stamp_ns < last_ns - self._jump_ns:
            return True
        same = stamp_ns == last_ns
        self.rejected[f'{kind}_duplicate' if same else f'{kind}_out_of_order'] += 1
        return False

    def _restart(self, stamp_ns: int) -> None:
        # Joint samples from before the jump belong to no wrench any more; those that jumped
        # first are kept.
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
            limit = -(2**63)  # time was set back, and the wrenches have not followed yet
        while len(motions) > 1 and (motions[1][0] <= limit or len(motions) > _MOTIONS_KEPT):
            motions.popleft()

    def _pair(self) -> list[ContactSample]:
        samples: list[ContactSample] = []
        wrenches, motions = self._wrenches, self._motions
        while wrenches:
            stamp_ns, force = wrenches[0]
            if not motions or motions[-1][0] < stamp_ns:
                newest = max(self._last_wrench_ns, motions[-1][0] if motions else stamp_ns)
                if newest - stamp_ns <= self._timeout_ns:
                    break
                self.rejected['joint_missing'] += 1
            else:
                motion = self._motion_at(stamp_ns)
                if motion is not None:
                    samples.append(ContactSample(stamp_ns, motion[0], motion[1], force))
            wrenches.popleft()
        return samples

    def _motion_at(self, stamp_ns: int) -> tuple[float, float] | None:
        motions = self._motions
        while len(motions) > 1 and motions[1][0] <= stamp_ns:
            motions.popleft()
        first = motions[0]
        if first[0] == stamp_ns:
            return first[1], first[2]
        if first[0] > stamp_ns:
            self.rejected['joint_missing'] += 1  # none at or before it
            return None
        second = motions[1]
        if second[0] - first[0] > self._gap_ns:
            self.rejected['joint_gap'] += 1
            return None
        share = (stamp_ns - first[0]) / (second[0] - first[0])
        return (
            first[1] + share * (second[1] - first[1]),
            first[2] + share * (second[2] - first[2]),
        )
