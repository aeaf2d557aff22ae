# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""What stands between the raw messages of an arm and a session."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import ClassVar, Sequence

from .arm_frames import ArmFrames, static_as_parameters
from .events import EstimationEvent, event_now, READY, STATIC
from .result import Result
from .session import ContactSession
from .start_up import StartUp
from ..exceptions import ContactEstimationError, MessageError
from ..messages import StampedTransform, TransformsDecoder


class ArmStage(ABC):
    """
    The stage of an arm behind `MessageInputs`: its motion, its sensor and its static transforms.

    Every message before the session knows the arm is counted as rejected.

    events: what a recording must hold besides the messages; the user takes them out
    ignored: in replay, what the node had refused before it knew the arm
    """

    lacking: ClassVar[str]
    """Reason for which messages are rejected while the arm is not known."""

    def __init__(self, session: ContactSession) -> None:
        self._session = session
        self.frames, self.events = ArmFrames(), list[EstimationEvent]()
        self.ignored, self._start_up = StartUp(), StartUp()
        self._transforms = TransformsDecoder()

    @abstractmethod
    def process_motion(self, raw: bytes) -> list[Result]:
        """Process a raw message that has the motion of the arm, or a part of it."""

    @property
    def has_sensor(self) -> bool:
        """Whether the axes of the force sensor are known."""
        return self._session.arm is not None and bool(self._session.arm.sensor)

    def admits(self, stamp_ns: int) -> bool:
        """Return whether a wrench can be used, or else count it as rejected."""
        if self.ignored.has_wrench(stamp_ns):
            return False
        if self._session.arm is None:
            self._count_missing()
            self._start_up.refused_wrench(stamp_ns)
            return False
        return True

    def place_sensor(self, stamp_ns: int, frame_id: str) -> bool:
        """
        Set the frame in which wrenches are measured.

        stamp_ns: of the wrench [ns]
        """
        arm = self._session.arm
        assert arm is not None
        try:
            self.frames.place_sensor(arm, self._session.parameters.force_sensor.frame or frame_id)
        except ContactEstimationError as error:
            self._session.count_rejected(
                'wrench_frame_unknown', f'{error}; or name the link in force_sensor.frame')
            self._start_up.refused_wrench(stamp_ns)
            return False
        self._announce_static()
        refused = self._start_up.take_report()
        if refused:
            self.events.append(event_now(self._session, READY, refused))
        return True

    def process_static_transforms(self, raw: bytes) -> None:
        """Process raw static transforms of tf."""
        try:
            self.use_static(self._transforms.decode(raw))
        except MessageError as error:
            self._session.count_rejected(f'tf_{error.reason}', str(error))

    def use_static(self, transforms: Sequence[StampedTransform]) -> None:
        """Use static transforms of tf."""
        if self.frames.add_static(transforms):
            self._announce_static()

    def _announce_static(self) -> None:
        new = self.frames.take_unreported()
        if new:
            self.events.append(event_now(self._session, STATIC, static_as_parameters(new)))

    def _count_missing(self) -> None:
        self._session.count_rejected(self.lacking, self._session.problem)
