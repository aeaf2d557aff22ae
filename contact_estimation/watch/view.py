# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The view of a contact in Rerun, also of a recording; as a window, web page or file."""

from contextlib import contextmanager
import os
from pathlib import Path
import sys
from threading import Event
from typing import Any, Callable, Iterator, Sequence

import numpy as np

from .live import CHECKS, ContactLog, LiveContact, STATUS
from ..estimators.estimate import Estimate
from ..exceptions import MissingPackageError, RecordingError
from ..figures import BLUE, MUTED, ORANGE
from ..pipeline.recorded_arm import read_contact_signals
from ..pipeline.replay import RecordingReplay
from ..recordings import RecordingReader
from ..recordings.mcap_file import GrowingRecording
from ..recordings.recorded_signals import Signal
from ..recordings.source import RecordingSource

_BAND = '#8cc8e0'  # bounds of an estimate, on a light and on a dark ground


def _estimate(symbol: str) -> dict[str, tuple[str, str, float]]:
    return {'upper': (f'{symbol} + 2 std', _BAND, 0.8), 'lower': (f'{symbol} - 2 std', _BAND, 0.8),
            'estimate': (symbol, BLUE, 1.8)}


PLOTS: dict[str, tuple[str, dict[str, tuple[str, str, float]]]] = {
    'force': ('pressing force [N]', {
        'measured': ('-F_e measured', MUTED, 1.0), 'desired': ('F_r desired', ORANGE, 1.5)}),
    'motion': ('position [mm]', {
        'desired': ('x_d desired', _BAND, 2.5), 'reference': ('x_r reference', ORANGE, 1.5),
        'measured': ('x measured', MUTED, 1.5)}),
    'stiffness': ('stiffness [N/m]', _estimate('K_e')),
    'damping': ('damping [N s/m]', _estimate('B_e')),
    'model_fit': ('residual [std of the noise]', {'ratio': ('model fit', BLUE, 1.5)}),
}
"""From top to bottom: title, and label, colour and width of each curve, the lowest first."""


def require_rerun() -> Any:
    """Import Rerun."""
    try:
        import rerun
        import rerun.blueprint
    except ImportError as error:
        raise MissingPackageError.of('rerun-sdk', 'the live view') from error
    return rerun


TIMELINE = 'time'
_EPOCH_NS = 10**17  # stamps beyond it count from 1970; simulated time starts near 0
_SHARES = {'model_fit': 0.6}  # of the height of a plot


class ContactView:
    """
    A log of a contact on its way to Rerun.

    `flush` sends what has been logged: a column costs no more than a value.

    serves: whether this process must live on for viewers to get the data
    """

    def __init__(self, name: str) -> None:
        self._rr = require_rerun()
        self.stream = self._rr.RecordingStream('contact_estimation')
        self.stream.send_recording_name(name)
        self.log, self.serves = ContactLog(), False

    def style(self) -> None:
        """Send names, colours and widths of all curves; once, when the stream has a sink."""
        for plot, (_, curves) in PLOTS.items():
            for curve, (label, colour, width) in curves.items():
                rgb = [int(colour[place:place + 2], 16) for place in (1, 3, 5)]
                self.stream.log(f'{plot}/{curve}', self._rr.SeriesLines(
                    names=label, colors=rgb, widths=width), static=True)

    def flush(self) -> None:
        """Send what has been logged since the last call."""
        values, texts = self.log.take()
        for path, (stamps, column) in values.items():
            self._send(path, stamps, self._rr.Scalars.columns(scalars=column))
        for path, stamp_ns, text, level in texts:
            self._send(path, [stamp_ns], self._rr.TextLog.columns(text=[text], level=[level]))

    def close(self) -> None:
        """Send what has been logged, and wait until it has arrived."""
        with _written():
            self.flush()
            self.stream.flush()
        self.stream.disconnect()

    def _send(self, path: str, stamps_ns: Sequence[int], columns: Any) -> None:
        stamps = np.asarray(stamps_ns, np.int64)
        if stamps[0] > _EPOCH_NS:
            times = self._rr.TimeColumn(TIMELINE, timestamp=stamps.astype('datetime64[ns]'))
        else:
            times = self._rr.TimeColumn(TIMELINE, duration=stamps.astype('timedelta64[ns]'))
        self.stream.send_columns(path, [times], columns)


def blueprint(follow_s: float | None = None) -> Any:
    """Return the layout."""
    rrb = require_rerun().blueprint
    plots = [_plot_view(rrb, plot, follow_s) for plot in PLOTS]
    return rrb.Blueprint(
        rrb.Vertical(
            *plots,
            rrb.Horizontal(_text_view(rrb, STATUS, 'status of the estimator'),
                           _text_view(rrb, CHECKS, 'checks'), column_shares=[1.0, 2.0]),
            row_shares=[*(_SHARES.get(plot, 1.0) for plot in PLOTS), 1.0]),
        rrb.BlueprintPanel(state='collapsed'),
        rrb.SelectionPanel(state='collapsed'),
        rrb.TimePanel(state='collapsed'),
        auto_layout=False, auto_views=False)


def _plot_view(rrb: Any, plot: str, follow_s: float | None) -> Any:
    options = {} if follow_s is None else {'time_ranges': rrb.VisibleTimeRange(
        TIMELINE, start=rrb.TimeRangeBoundary.cursor_relative(seconds=-follow_s),
        end=rrb.TimeRangeBoundary.cursor_relative())}
    return rrb.TimeSeriesView(
        origin=f'/{plot}', name=PLOTS[plot][0], plot_legend=rrb.Corner2D.LeftTop, **options)


def _text_view(rrb: Any, origin: str, name: str) -> Any:
    columns = rrb.TextLogColumns(text_log_columns=['LogLevel', 'Body'])
    return rrb.TextLogView(origin=origin, name=name, columns=columns)


_MOST = 500_000  # values of a curve: what a viewer still moves without stutter


def show_recording(
    view: ContactView, reader: RecordingReader, source: RecordingSource, replay: RecordingReplay,
    progress: Callable[[float, str], None] = lambda fraction, text: None,
) -> int:
    """Send signals, estimates, status and checks of a recording."""
    parameters = replay.session.parameters
    signals = read_contact_signals(reader, source, parameters, parameters.axis, parameters.joint)
    _send(view.log, 'force/measured', signals.wrench, 0, -1.0)
    _send(view.log, 'motion/measured', signals.joint_states, 0, 1e3)
    if len(signals.reference_trajectory):
        _send(view.log, 'motion/reference', signals.reference_trajectory, 0, 1e3)
        _send(view.log, 'force/desired', signals.reference_trajectory, 3, 1.0)
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


def follow_recording(view: ContactView, path: Path, estimator: str, stopped: Event) -> None:
    """Show an MCAP recording, which may not exist yet, until it is finished."""
    live = LiveContact(view.log, estimator)
    callbacks = {topic: callback for topic, _, callback, _ in live.subscriptions()}
    recording = GrowingRecording(path, callbacks)
    while not recording.finished and not stopped.is_set():
        for topic, _, raw in recording.new_messages():
            callbacks[topic](raw)
        view.flush()
        stopped.wait(_PERIOD_S)


@contextmanager
def _written() -> Iterator[None]:
    """Name what Rerun cannot write."""
    try:
        yield
    except RuntimeError as error:  # for a full disk too
        raise RecordingError(f'the view cannot be written: {error}') from error


WINDOW, WEB = 'window', 'web'
_MEMORY = '1GiB'  # of the viewer and of what a page that opens late still gets


def show(view: ContactView, target: str, follow_s: float | None = None) -> str:
    """Connect a view to where it is shown."""
    layout = blueprint(follow_s)
    if target == WINDOW and has_display():
        viewer = Path(sys.executable).with_name('rerun')  # which need not be on PATH
        require_rerun().spawn(
            recording=view.stream, default_blueprint=layout, memory_limit=_MEMORY,
            executable_path=str(viewer) if viewer.exists() else None, hide_welcome_screen=True)
        text = 'opened the viewer'
    elif target in (WINDOW, WEB):
        text = serve(view, layout)
        if target == WINDOW:
            text = f'no display; {text}'
    else:
        with _written():
            view.stream.save(target, default_blueprint=layout)
        text = f'{target}, open it with: rerun {target}'
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
