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

    Parameters
    ----------
    view : ContactView
        Connected.
    path : Path
        MCAP recording, which may not exist yet.
    estimator : str
        Name of the estimator node.
    stopped : Event
        Set from outside, to stop before.
    period_s : float
        Time between looks at the file [s].

    """
    live = LiveContact(view.log, estimator)
    callbacks = {topic: callback for topic, _, callback, _ in live.subscriptions()}
    recording = GrowingRecording(path, callbacks)
    while not recording.finished and not stopped.is_set():
        for topic, _, raw in recording.new_messages():
            callbacks[topic](raw)
        view.flush()
        stopped.wait(period_s)
