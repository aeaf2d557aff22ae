# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""A recording in the view: replayed through the session that the node runs."""

from __future__ import annotations

from typing import Callable

from .contact_log import ContactLog
from .view import ContactView
from ..estimators.estimate import Estimate
from ..pipeline.recorded_arm import read_contact_signals
from ..pipeline.replay import RecordingReplay
from ..recordings import RecordingReader
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
