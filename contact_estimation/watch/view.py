# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The view of a contact in Rerun: plots of signals and estimates, and a log of texts."""

from __future__ import annotations

from typing import Any, Sequence

import numpy as np

from .layouts import Plot, PLOTS
from .readings import CHECKS, ContactLog, STATUS
from ..exceptions import MissingPackageError


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
        for plot in PLOTS:
            for curve in plot.curves:
                colour = [int(curve.colour[place:place + 2], 16) for place in (1, 3, 5)]
                self.stream.log(f'{plot.key}/{curve.key}', self._rr.SeriesLines(
                    names=curve.label, colors=colour, widths=curve.width), static=True)

    def flush(self) -> None:
        """Send what has been logged since the last call."""
        values, texts = self.log.take()
        for path, (stamps, column) in values.items():
            self._send(path, stamps, self._rr.Scalars.columns(scalars=column))
        for path, stamp_ns, text, level in texts:
            self._send(path, [stamp_ns], self._rr.TextLog.columns(text=[text], level=[level]))

    def close(self) -> None:
        """Send what has been logged, and wait until it has arrived."""
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
            row_shares=[*(_SHARES.get(plot.key, 1.0) for plot in PLOTS), 1.0],
        ),
        rrb.BlueprintPanel(state='collapsed'),
        rrb.SelectionPanel(state='collapsed'),
        rrb.TimePanel(state='collapsed'),
        auto_layout=False, auto_views=False,
    )


def _plot_view(rrb: Any, plot: Plot, follow_s: float | None) -> Any:
    options: dict[str, Any] = {}
    if follow_s is not None:
        options['time_ranges'] = rrb.VisibleTimeRange(
            TIMELINE, start=rrb.TimeRangeBoundary.cursor_relative(seconds=-follow_s),
            end=rrb.TimeRangeBoundary.cursor_relative())
    return rrb.TimeSeriesView(
        origin=f'/{plot.key}', name=plot.title, plot_legend=rrb.Corner2D.LeftTop, **options)


def _text_view(rrb: Any, origin: str, name: str) -> Any:
    columns = rrb.TextLogColumns(text_log_columns=['LogLevel', 'Body'])
    return rrb.TextLogView(origin=origin, name=name, columns=columns)
