# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""`--picture`: force, motion and the estimates of a recording as a PNG file."""

from __future__ import annotations

from typing import Mapping

from .command_line import new_file
from ..exceptions import RecordingError
from ..figures import as_png, require_matplotlib
from ..pipeline.estimate_files import EstimateTrace, plot_contact, signal_series
from ..pipeline.parameters import EstimationParameters
from ..pipeline.recorded_arm import read_contact_signals
from ..recordings import RecordingReader
from ..recordings.source import RecordingSource


def picture_trace(path: str | None) -> EstimateTrace | None:
    """Return what collects the estimates for a picture."""
    if path is None:
        return None
    require_matplotlib()
    if new_file(path).suffix.lower() != '.png':
        raise RecordingError(f'--picture writes a PNG file, got {path}; let its name end in .png')
    return EstimateTrace()


def write_picture(
    path: str, reader: RecordingReader, source: RecordingSource,
    parameters: EstimationParameters, trace: EstimateTrace,
    true: Mapping[str, float] | None = None,
) -> None:
    """Write the picture of a recording."""
    signals = read_contact_signals(reader, source, parameters, parameters.axis, parameters.joint)
    series = {**signal_series(signals), **trace.series(int(signals.wrench.stamp_ns[0]))}
    estimator = f', {parameters.estimator}' if 'stiffness' in series else ''
    figure = plot_contact(series, reader.path.name + estimator, true)
    new_file(path).write_bytes(as_png(figure))
