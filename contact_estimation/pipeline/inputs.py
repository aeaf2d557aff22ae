# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Raw messages, in the order of their stamps, as inputs of a session for all its axes."""

from collections import Counter
from operator import itemgetter
from typing import Any, Callable, Iterable, Iterator, Sequence

import numpy as np

from .arm_efforts import ArmEfforts
from .arm_inputs import ArmJoints, ArmStage, ArmTransforms
from .axes import Result
from .session import ContactSession
from ..estimators.estimate import AxesEstimates
from ..exceptions import MessageError
from ..kinematics.parameters import JOINT_EFFORTS
from ..recordings import RecordedMessage
from ..recordings.cdr import header_stamp_ns
from ..recordings.decoding import ForceTorqueDecoder, JointsDecoder, WrenchDecoder
from ..signals.stamp_screen import BEFORE_ANY, StampScreen
from ..signals.synchronisation import SynchronisationParameters


_AT_ONCE = 2000  # messages in small chunks that are processed together
_MOST_HELD = 6000  # messages for which a late topic is awaited


class LateMessages:
    """Undo the lateness of one topic against the other, where it does not last."""

    def __init__(self, wrench: str, limits: Callable[[], SynchronisationParameters]) -> None:
        self._wrench, self._limits = wrench, limits

    def joined(
        self, batches: Iterable[list[RecordedMessage]]
    ) -> Iterator[list[RecordedMessage]]:
        """Join small batches, and one that ends with one topic late and those that follow."""
        held: list[list[RecordedMessage]] = []
        together: list[RecordedMessage] = []
        for batch in batches:
            held.append(batch)
            together += batch
            if len(together) >= _AT_ONCE and self.end_together(together):
                yield together
            elif len(together) >= _MOST_HELD:
                yield from held
            else:
                continue
            held, together = [], []
        yield from held

    def end_together(self, messages: list[RecordedMessage]) -> bool:
        """Return whether the last stamps of both topics are within the limit of lateness."""
        last: dict[bool, int | None] = {}
        for message in reversed(messages):
            last.setdefault(message.topic == self._wrench, self._stamp_ns(message))
            if len(last) == 2:
                break
        wrench_ns, joint_ns = last.get(True), last.get(False)
        if wrench_ns is None or joint_ns is None:
            return False
        return abs(wrench_ns - joint_ns) <= self._limits().timeout_s * 1e9

    def ordered(self, messages: list[RecordedMessage]) -> list[RecordedMessage]:
        """Order messages by stamps, where both topics end and set time back together."""
        if not self.end_together(messages):
            return messages
        topics = {of_wrench: _TopicOrder(of_wrench, self._limits()) for of_wrench in (False, True)}
        for place, message in enumerate(messages):
            stamp_ns = self._stamp_ns(message)
            topics[message.topic == self._wrench].add(place, stamp_ns)
        if topics[False].jumps != topics[True].jumps:
            return messages
        keys = {**topics[False].keys, **topics[True].keys}
        return [messages[place] for place in sorted(keys, key=keys.__getitem__)]

    def _stamp_ns(self, message: RecordedMessage) -> int | None:
        stamp_ns = header_stamp_ns(message.data)
        if stamp_ns is None or message.topic == self._wrench:
            return stamp_ns
        return stamp_ns + round(self._limits().offset * 1e9)


class _TopicOrder:
    """Keys by which the messages of one topic sort, as the pairing screens their stamps."""

    def __init__(self, of_wrench: bool, limits: SynchronisationParameters) -> None:
        self.keys: dict[int, tuple[int, int, bool]] = {}
        self.jumps = 0
        self._of_wrench = of_wrench
        self._newest_ns = BEFORE_ANY
        self._gap_ns = int(limits.maximum_gap_s * 1e9)
        self._jump_ns = int(limits.time_jump_s * 1e9)
        self._offset_ns = 0 if of_wrench else round(limits.offset * 1e9)
        self._screen = StampScreen('', Counter())

    def add(self, place: int, stamp_ns: int | None) -> None:
        """Add the message at a place; one that is rejected sorts with the one before it."""
        self.keys[place] = self.jumps, self._newest_ns, self._of_wrench
        if stamp_ns is None:
            return
        for admitted_ns, at in self._screen.admit(
                (stamp_ns, place), self._newest_ns, BEFORE_ANY, self._gap_ns, self._jump_ns,
                self._offset_ns):
            self.jumps += admitted_ns < self._newest_ns
            self._screen.before_ns, self._newest_ns = self._newest_ns, admitted_ns
            self.keys[at] = self.jumps, admitted_ns, self._of_wrench


_FORCES = {'x': 2, 'y': 3, 'z': 4}  # places in a WrenchReading


class MessageInputs:
    """
    The entrance of raw wrenches and motion to a session, of prismatic axes and of arms.

    A message that cannot be used is counted as rejected and gives no result.

    frame_id: frame of the wrenches: as configured, else that of the first wrench; '' before it
    arm: of an arm, where one is configured: takes its motion, and waits for what describes it
    """

    def __init__(self, session: ContactSession) -> None:
        self._session = session
        self._wrenches = session.checks.wrenches
        self.frame_id = session.parameters.frame_id
        self.arm = _stage_of(session)
        self._wrench: ForceTorqueDecoder | WrenchDecoder
        self._forces: Callable[..., Any]
        if self.arm is not None:
            self._wrench, self._forces = ForceTorqueDecoder(), itemgetter(1)
            if isinstance(self.arm, ArmEfforts):
                self.frame_id = session.parameters.kinematics.tip
            return
        joints = session.parameters.joints
        self._wrench = WrenchDecoder()
        self._joints = JointsDecoder(list(joints.values()))
        places = [_FORCES[axis] for axis in joints]
        self._columns = ['xyz'.index(axis) for axis in joints]
        self._sign, self._components = session.parameters.force_sign, itemgetter(0, 2, 3, 4)
        one = slice(places[0], places[0] + 1)
        self._forces = itemgetter(*places if len(places) > 1 else (one,))

    def process_wrench(self, raw: bytes) -> list[Result]:
        """Process a raw wrench."""
        decoder, arm = self._wrench, self.arm
        try:
            reading = decoder.decode(raw)
        except MessageError as error:
            self._session.count_rejected(f'wrench_{error.reason}', str(error))
            return []
        if arm is not None and not arm.admits(reading[0]):
            return []
        if decoder.frame_id != self.frame_id or arm is not None and not arm.has_sensor:
            if not self._accepts(reading[0], decoder.frame_id):
                return []
        forces = self._forces(reading)
        if arm is None:
            self._wrenches.append(self._components(reading))
            if self._sign < 0.0:
                forces = [-force for force in forces]
        return self._session.add_wrench(reading[0], *forces)

    def process_motion(self, raw: bytes) -> list[Result]:
        """Process a raw joint state or, where the poses of an arm come from tf, raw transforms."""
        if self.arm is not None:
            return self.arm.process_motion(raw)
        try:
            stamp_ns, positions, velocities = self._joints.decode(raw)
        except MessageError as error:
            self._session.count_rejected(f'joint_states_{error.reason}', str(error))
            return []
        return self._session.add_motion(stamp_ns, *positions, *velocities)

    def process_pairs(
        self, wrenches: Sequence[bytes], joints: Sequence[bytes]
    ) -> list[AxesEstimates] | None:
        """Process raw wrenches and joint states that have the same stamps, many at once."""
        if not isinstance(self._wrench, WrenchDecoder):
            return None
        forces = self._wrench.decode_many(wrenches)
        motions = self._joints.decode_many(joints) if forces else None
        if not forces or not motions or not np.array_equal(forces[0], motions[0]):
            return None
        if not self._adopts(self._wrench.frame_id):
            return None
        stamps_ns, *components = forces
        columns = [self._sign * components[column] for column in self._columns]
        self._wrenches.extend(stamps_ns, *components)
        estimates = self._session.add_pairs(stamps_ns, columns, *motions[1:])
        if estimates is None:
            self._wrenches.drop(len(wrenches))
        return estimates

    def _accepts(self, stamp_ns: int, frame_id: str) -> bool:
        """Check the frame of a wrench, in whose axes an arm must know its sensor."""
        if not self._adopts(frame_id):
            self._session.count_rejected(
                'wrench_frame_id', f'expected {self.frame_id!r}, got {frame_id!r}; set frame_id')
            return False
        if self.arm is not None and not self.arm.place_sensor(stamp_ns, frame_id):
            self.frame_id = self._session.parameters.frame_id
            return False
        return True

    def _adopts(self, frame_id: str) -> bool:
        """Compare with the frame expected; without a configured frame the first one is adopted."""
        self.frame_id = self.frame_id or frame_id
        return frame_id == self.frame_id


def _stage_of(session: ContactSession) -> ArmStage | None:
    if session.parameters.wrench_source == JOINT_EFFORTS:
        return ArmEfforts(session)
    if session.parameters.pose_source == 'tf':
        return ArmTransforms(session)
    return ArmJoints(session) if session.parameters.kinematics.tip else None
