# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Recordings in the view, also while written; the view as a window, web page or file."""

from __future__ import annotations

import os
from pathlib import Path
import sys
from threading import Event
from typing import Any, Callable

from .live import LiveContact
from .readings import ContactLog
from .view import blueprint, ContactView, require_rerun
from ..estimators.estimate import Estimate
from ..pipeline.recorded_arm import read_contact_signals
from ..pipeline.replay import RecordingReplay
from ..recordings import RecordingReader
from ..recordings.mcap_file import GrowingRecording
from ..recordings.recorded_signals import RecordedSignals, Signal
from ..recordings.source import RecordingSource


_MOST = 500_000  # values of a curve: what a viewer still moves without stutter


def show_recording(
    view: ContactView, reader: RecordingReader, source: RecordingSource, replay: RecordingReplay,
    progress: Callable[[float, str], None] = lambda fraction, text: None,
) -> int:
    """Send signals, estimates, status and checks of a recording."""
    parameters = replay.session.parameters
    signals = read_contact_signals(reader, source, parameters, parameters.axis, parameters.joint)
    _send_signals(view.log, signals)
    view.flush()
    step, samples = 1 + len(signals.wrench) // _MOST, 0
    for estimates in filter(None, replay.estimates()):
        for contact, *_ in estimates[-samples % step::step]:
            _add(view.log, contact)
        samples += len(estimates)
        view.log.add_checks(estimates[-1][0].stamp_ns, {
            warned.name: warned.text for warned in replay.session.checks.warnings()})
        view.flush()
        progress(reader.progress, f'{samples} samples')
    return samples


def _send_signals(log: ContactLog, signals: RecordedSignals) -> None:
    reference = signals.reference_trajectory
    _send(log, 'force/measured', signals.wrench, 0, -1.0)
    _send(log, 'motion/measured', signals.joint_states, 0, 1e3)
    if len(reference):
        _send(log, 'motion/reference', reference, 0, 1e3)
        _send(log, 'force/desired', reference, 3, 1.0)


def _send(log: ContactLog, path: str, signal: Signal, row: int, scale: float) -> None:
    step = 1 + len(signal) // _MOST
    for stamp_ns, value in zip(signal.stamp_ns[::step].tolist(),
                               (scale * signal.values[row, ::step]).tolist()):
        log.add(path, stamp_ns, value)


def _add(log: ContactLog, estimate: Estimate) -> None:
    stamp_ns = estimate.stamp_ns
    log.add_estimate('stiffness', stamp_ns, estimate.stiffness, estimate.stiffness_std)
    log.add_estimate('damping', stamp_ns, estimate.damping, estimate.damping_std)
    log.add('model_fit/ratio', stamp_ns, estimate.model_fit)
    reason = f': {estimate.reason}' if estimate.reason else ''
    log.add_status(stamp_ns, f'{estimate.status.value}{reason}')


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


WINDOW, WEB = 'window', 'web'
_MEMORY = '1GiB'  # of the viewer and of what a page that opens late still gets


def show(view: ContactView, target: str, follow_s: float | None = None) -> str:
    """Connect a view to where it is shown."""
    layout = blueprint(follow_s)
    if target == WINDOW and has_display():
        rerun = require_rerun()
        rerun.spawn(recording=view.stream, default_blueprint=layout, memory_limit=_MEMORY,
                    executable_path=_executable(), hide_welcome_screen=True)
        text = 'opened the viewer'
    elif target in (WINDOW, WEB):
        text = serve(view, layout)
        if target == WINDOW:
            text = f'no display; {text}'
    else:
        view.stream.save(target, default_blueprint=layout)
        text = f'writing {target}; open it with: rerun {target}'
    view.stream.send_blueprint(layout)
    view.style()
    return text


def has_display() -> bool:
    """Return whether a window can be opened."""
    if sys.platform != 'linux':
        return True
    return bool(os.environ.get('DISPLAY') or os.environ.get('WAYLAND_DISPLAY'))


def serve(view: ContactView, layout: Any) -> str:
    view.serves = True
    address = view.stream.serve_grpc(default_blueprint=layout, server_memory_limit=_MEMORY)
    require_rerun().serve_web_viewer(open_browser=False, connect_to=address)
    page = f'http://localhost:9090/?url={address.replace(":", "%3A").replace("/", "%2F")}'
    return f'serving {page.replace("+", "%2B")}'


def _executable() -> str | None:
    """Return the viewer beside this Python, which need not be on PATH."""
    path = Path(sys.executable).with_name('rerun')
    return str(path) if path.exists() else None
