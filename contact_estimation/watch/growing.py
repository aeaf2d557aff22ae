# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""A recording in the view while it is written."""

from __future__ import annotations

from pathlib import Path
from threading import Event

from .live import LiveContact
from .view import ContactView
from ..recordings.growing import GrowingRecording

_PERIOD_S = 0.1


def follow_recording(
    view: ContactView, path: Path, estimator: str, stopped: Event, period_s: float = _PERIOD_S
) -> None:
    """
    Show what is recorded until the recording is finished.

    path: MCAP recording, which may not exist yet
    period_s: time between looks at the file [s]
    """
    live = LiveContact(view.log, estimator)
    callbacks = {topic: callback for topic, _, callback, _ in live.subscriptions()}
    recording = GrowingRecording(path, callbacks)
    while not recording.finished and not stopped.is_set():
        for topic, _, raw in recording.new_messages():
            callbacks[topic](raw)
        view.flush()
        stopped.wait(period_s)
