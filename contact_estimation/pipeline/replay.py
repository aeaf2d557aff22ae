# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Off-line re-estimation: a recording replayed through the session that the node runs."""

from collections import deque
from functools import partial
from math import nan
from typing import Any, Iterator, Mapping

from .arm_inputs import StartUp
from .arm_kinematics import static_of_parameters
from .events import apply_event, EstimationEvent, STATIC, TARE
from .inputs import LateMessages, MessageInputs
from .joint_torques import WINDOW_S
from .parameters import EstimationParameters
from .recorded_arm import (
    read_contact_signals, recorded_description, recorded_parameters, recorded_static,
    refused_at_start)
from .session import ContactSession
from ..estimators import ESTIMATORS
from ..estimators.estimate import AxesEstimates
from ..exceptions import MessageError, ParameterRangeError, RecordingError
from ..kinematics.parameters import JOINT_EFFORTS
from ..parameters import build
from ..recordings import RecordedMessage, RecordingReader
from ..recordings.decoding import decode_string, TrajectoryDecoder
from ..recordings.recorded_signals import Tare, wrench_rate
from ..recordings.source import canonical, RecordingSource
from ..reference.setpoints import Reference
from ..signals.stamp_screen import BEFORE_ANY

_CUTOFF = 'conditioning.cutoff_frequency'
_AHEAD = 6000  # messages by which an event may be recorded after the sample that it follows


def _measured(
    reader: RecordingReader, source: RecordingSource, given: Mapping[str, Any]
) -> dict[str, Any]:
    """Return the rate of the wrench where it is not given, and no filter if that is too low."""
    rate = nan
    if 'sample_rate' not in given:
        of_efforts = given.get('wrench_source') == JOINT_EFFORTS
        rate = wrench_rate(reader, source.joint_states if of_efforts else source.wrench)
        rate = min(rate, 1.0 / WINDOW_S) if of_efforts else rate
    for measured in ({'sample_rate': rate}, {'sample_rate': rate, _CUTOFF: 0.0}):
        try:
            build(EstimationParameters, {**measured, **given})
            return measured
        except ParameterRangeError:
            continue
    return {}


def no_usable_sample(recording: str, session: ContactSession) -> RecordingError:
    """Return the error of a recording in which no wrench met a joint state, with the reasons."""
    reasons = ', '.join(
        f'{count} {reason}' + (f' ({session.rejection_texts[reason]})'
                               if session.rejection_texts.get(reason) else '')
        for reason, count in session.rejected.items())
    remedy = 'check topics, joint and stamps'
    if any(reason.endswith('_absurd') for reason in session.rejected):
        remedy = ('values are out of range: give the units of the recording, such as '
                  '--units mm,N, or raise synchronisation.maximum_*')
    return RecordingError(
        f'no usable sample in {recording}: expected wrenches with joint states at or around '
        f'their stamps, got {reasons or "none"}; {remedy}')


class RecordingReplay:
    """Process a recording in a new session, with its events and references."""

    def __init__(
        self, reader: RecordingReader, source: RecordingSource, chosen: Mapping[str, Any]
    ) -> None:
        self._reader, self._source, self._chosen = reader, source, dict(chosen)
        given = {**recorded_parameters(reader, source, chosen), **chosen}
        parameters = build(EstimationParameters, {**_measured(reader, source, given), **given})
        self.session = ContactSession(parameters, generate_reference=False)
        of_tf = parameters.pose_source == 'tf'
        if parameters.kinematics.tip and self.session.arm is None and not of_tf:
            self.session.describe(recorded_description(reader, source))
        self._inputs = MessageInputs(self.session)
        arm = self._inputs.arm
        if arm is not None:
            arm.use_static(recorded_static(reader, source))
            arm.ignored = StartUp(**refused_at_start(reader, source))
        self._process_of = {
            source.wrench: self._inputs.process_wrench,
            source.tf if of_tf else source.joint_states: self._inputs.process_motion,
        }
        of_efforts = parameters.wrench_source == JOINT_EFFORTS
        if of_efforts:
            del self._process_of[source.wrench]
        # The first transform of a message stands for none of the others.
        self._late = None if of_tf or of_efforts else LateMessages(
            source.wrench, lambda: self.session.parameters.synchronisation)
        self.tares = self._tare() if source.tare else {}
        self._references = TrajectoryDecoder(parameters.joint)
        self._left_over: list[RecordedMessage] = []
        self._last_reference_ns, self._reference_jumps = BEFORE_ANY, 0

    def _tare(self) -> dict[str, Tare]:
        """Set the zero of the force of each axis as the user chose."""
        parameters = self.session.parameters
        signals = {axis: read_contact_signals(
            self._reader, self._source, parameters, axis, joint)
            for axis, joint in parameters.joints.items()}
        tares = {axis: own.tare for axis, own in signals.items() if own.tare is not None}
        self.session.set_bias({axis: tare.force for axis, tare in tares.items()})
        return tares

    def estimates(self) -> Iterator[list[AxesEstimates]]:
        """Run the recording through the session."""
        batches = self._ahead(self._reader.batches(self._topics()))
        for batch in self._late.joined(batches) if self._late else batches:
            yield self._process(batch)
        yield self._process_one_by_one(self._left_over)

    def _topics(self) -> list[str]:
        source = self._source
        asked = list(self._process_of)
        there = {canonical(name) for name in self._reader.topics()}
        asked += [name for name in (source.events,) if canonical(name) in there]
        if canonical(source.reference_trajectory) in there and self._may_follow():
            asked.append(source.reference_trajectory)
        return asked

    def _may_follow(self) -> bool:
        """Return whether the estimator, or one that a recorded event switches to, needs x_r."""
        fixed = 'estimator' in self._chosen
        used = [self.session.parameters.estimator] if fixed else list(ESTIMATORS)
        return any(name in ESTIMATORS and ESTIMATORS[name].follows_reference for name in used)

    def _ahead(
        self, batches: Iterator[list[RecordedMessage]]
    ) -> Iterator[list[RecordedMessage]]:
        """Read ahead: events and references must be known before the samples that they affect."""
        waiting: deque[list[RecordedMessage]] = deque()
        count = 0
        for batch in batches:
            data = self._separate_events(batch)
            waiting.append(data)
            count += len(data)
            while count - len(waiting[0]) >= _AHEAD:
                count -= len(waiting[0])
                yield waiting.popleft()
        yield from waiting

    def _separate_events(self, batch: list[RecordedMessage]) -> list[RecordedMessage]:
        source = self._source
        aside = (source.events, source.reference_trajectory)
        data = [message for message in batch if message[0] not in aside]
        if len(data) != len(batch):
            for message in batch:
                if message.topic == source.events:
                    self._add_event(message.data)
                elif message.topic == source.reference_trajectory:
                    self._add_reference(message.data)
        return data

    def _add_event(self, raw: bytes) -> None:
        event = EstimationEvent.from_text(decode_string(raw))
        if event.kind == TARE and self.tares:
            return  # the user has chosen another
        kept = {k: v for k, v in event.parameters.items() if k not in self._chosen}
        event = event._replace(parameters=kept)
        apply = partial(apply_event, self.session, event)
        if event.kind == STATIC and self._inputs.arm is not None:
            apply = partial(self._inputs.arm.use_static, static_of_parameters(kept))
        self.session.schedule(event.moment, apply)

    def _add_reference(self, raw: bytes) -> None:
        try:
            stamp_ns, x, v, a, _ = self._references.decode(raw)
        except MessageError as error:
            self.session.count_rejected(f'reference_{error.reason}')
            return
        rates = (0.0 if rate != rate else rate for rate in (v, a))
        jump_ns = self.session.parameters.synchronisation.time_jump_s * 1e9
        if stamp_ns < self._last_reference_ns - jump_ns:
            self._reference_jumps += 1
        self._last_reference_ns = stamp_ns
        self.session.add_reference(stamp_ns, Reference(x, *rates), self._reference_jumps)

    def _process(self, batch: list[RecordedMessage]) -> list[AxesEstimates]:
        """Process a batch at once where it is regular, else message by message."""
        messages = self._left_over + batch if self._left_over else batch
        self._left_over = []
        if self.session.waits:
            messages = self._ordered(messages)
        estimates, messages = self._finish_waiting(messages)  # few, or none
        wrench = self._source.wrench
        wrenches = [data for topic, _, data in messages if topic == wrench]
        motions = [data for topic, _, data in messages if topic != wrench]
        count = min(len(wrenches), len(motions))
        if count and self._late and self._late.end_together(messages):
            paired = self._inputs.process_pairs(wrenches[:count], motions[:count])
            if paired is not None:
                self._left_over = _last(
                    messages, wrench, len(wrenches) > count, len(messages) - 2 * count)
                return estimates + paired if estimates else paired
        return estimates + self._process_one_by_one(self._ordered(messages))

    def _ordered(self, messages: list[RecordedMessage]) -> list[RecordedMessage]:
        return self._late.ordered(messages) if self._late else messages

    def _finish_waiting(
        self, messages: list[RecordedMessage]
    ) -> tuple[list[AxesEstimates], list[RecordedMessage]]:
        """Process messages until no wrench waits for its joint state."""
        estimates: list[AxesEstimates] = []
        taken = 0
        while taken < len(messages) and self.session.waits:
            estimates += self._process_one_by_one(messages[taken:taken + 1])
            taken += 1
        return estimates, messages[taken:]

    def _process_one_by_one(self, messages: list[RecordedMessage]) -> list[AxesEstimates]:
        estimates: list[AxesEstimates] = []
        for topic, _, data in messages:
            estimates += [result.estimates for result in self._process_of[topic](data)]
        return estimates


def _last(
    messages: list[RecordedMessage], topic: str, of_it: bool, count: int
) -> list[RecordedMessage]:
    """Return the last messages of a topic, or of all others: those without a partner."""
    found: list[RecordedMessage] = []
    for message in reversed(messages):
        if len(found) == count:
            break
        if (message[0] == topic) is of_it:
            found.append(message)
    return found[::-1]
