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

"""From raw messages to the contact axes of a session, whether one or several."""

from __future__ import annotations

from operator import attrgetter
from typing import Any, Callable, NamedTuple, Sequence

import numpy as np

from .axes import estimated_axes
from .session import ContactSession, Result
from ..estimators.estimator import Estimate
from ..messages import (
    FORCE_OF_AXIS,
    JointStateDecoder,
    SeveralJointsDecoder,
    WrenchDecoder,
    WrenchReading,
)


class Estimates(NamedTuple):
    """
    Estimates of consecutive samples.

    Attributes
    ----------
    contact : list of Estimate
        Of the contact axis.
    further : list of tuple of Estimate
        Of the axes beside it, for each sample; empty where there are none.

    """

    contact: list[Estimate]
    further: list[tuple[Estimate, ...]]


class ContactReadings:
    """
    Decoders for the axes of a session, and its entries for what they read.

    One axis has entries of its own, which take plain numbers: tuples would cost time at every
    sample.

    Parameters
    ----------
    session : ContactSession
        Where readings go.

    Attributes
    ----------
    wrench, joints : decoder
        With `decode` and `decode_many`.
    force_of : callable
        Takes a wrench reading, returns what `add_wrench` takes as force.
    add_wrench, add_motion : callable
        Take a stamp and what was read; return results.

    """

    wrench: WrenchDecoder
    joints: JointStateDecoder | SeveralJointsDecoder
    force_of: Callable[[WrenchReading], Any]
    add_wrench: Callable[[int, Any], list[Result]]
    add_motion: Callable[..., list[Result]]

    def __init__(self, session: ContactSession) -> None:
        self._session = session
        axes = estimated_axes(session.parameters)
        self._columns = ['xyz'.index(axis) for axis in axes]
        self.wrench = WrenchDecoder()
        if len(axes) == 1:
            self.joints = JointStateDecoder(session.parameters.joint)
            self.force_of = FORCE_OF_AXIS[session.parameters.axis]
            self.add_wrench, self.add_motion = session.add_wrench, session.add_motion
        else:
            self.joints = SeveralJointsDecoder(list(axes.values()))
            self.force_of = attrgetter(*(f'force_{axis}' for axis in axes))
            self.add_wrench, self.add_motion = session.add_wrenches, session.add_motions

    def add_pairs(self, wrenches: Sequence[bytes], motions: Sequence[bytes]) -> Estimates | None:
        """
        Take raw messages of both topics that have the same stamps, many at once.

        Parameters
        ----------
        wrenches, motions : sequence of bytes
            As many of one as of the other.

        Returns
        -------
        estimates : Estimates or None
            One a pair; None where they must be taken one by one.

        """
        forces = self.wrench.decode_many(wrenches)
        readings = self.joints.decode_many(motions) if forces else None
        if not forces or not readings or not np.array_equal(forces[0], readings[0]):
            return None
        frame_id = self.wrench.frame_id
        if self._session.frame_id not in ('', frame_id):
            return None
        self._session.accepts_frame(frame_id)
        columns = [forces[1 + column] for column in self._columns]
        if len(columns) == 1:
            alone = self._session.add_pairs(forces[0], columns[0], readings[1], readings[2])
            return None if alone is None else Estimates(alone, [])
        together = self._session.add_pairs_of_axes(forces[0], columns, *readings[1:])
        return None if together is None else Estimates(*together)
