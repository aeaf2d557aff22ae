# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Read a recording for the diagnosis."""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from typing import Any, Mapping

from .signals import Recording, signals_of
from ...exceptions import UnknownNameError
from ...messages import FORCE_OF_AXIS
from ...parameters.values import build
from ...pipeline.parameters import EstimationParameters
from ...pipeline.recorded_arm import arm_parameters, read_contact_signals
from ...recordings import RecordingReader
from ...recordings.source import RecordingSource
from ...texts import printable


def read_recording(
    path: str | PathLike[str], *, topics: Mapping[str, str] | None = None, axis: str = 'x',
    joint: str = '', parameters: Mapping[str, Any] | None = None,
    most_samples: int | None = None, **reading: Any,
) -> Recording:
    """
    Read the signals of a recording.

    Parameters
    ----------
    path : str or path-like
        An `.mcap` file, a rosbag2 folder, or a CSV, Parquet or MAT file.
    topics : mapping of str to str, optional
        Recorded topic names by 'wrench', 'joint_states' and 'reference_trajectory'. A topic that
        is not given has that name.
    axis : {'x', 'y', 'z'}
        Force axis of the wrench.
    joint : str
        Joint of the contact axis; '' if the recording has only one.
    parameters : mapping, optional
        Parameters of `estimator_node` by dotted name, of which those of an arm and its tool and of
        the force's sign are used; they take precedence over recorded ones.
    most_samples : int, optional
        Number of wrenches after which reading stops, a bound of the memory; all by default.
    **reading
        Further attributes of `RecordingSource`, such as columns={'t': 'time'}, units=('mm',).

    Returns
    -------
    recording : Recording
        Name and signals, time in seconds from the first wrench.

    Raises
    ------
    RecordingError
        If the recording cannot be read or lacks wrenches or joint states.
    UnknownNameError
        If `axis` or a key of `topics` is unknown.

    """
    if axis not in FORCE_OF_AXIS:
        raise UnknownNameError.among('axis', axis, FORCE_OF_AXIS)
    source = RecordingSource.of_topics(topics or {}, **reading)
    reader = RecordingReader(str(path), source)
    arm = build(EstimationParameters, arm_parameters(reader, source, parameters or {}))
    signals = read_contact_signals(reader, source, arm, axis, joint, most_samples)
    back = max(signals.wrench.back_ns, signals.joint_states.back_ns)
    return Recording(printable(Path(path).name), signals_of(signals), 1e-9 * back,
                     _damage(reader), tare=signals.tare)


def _damage(reader: RecordingReader) -> str:
    """Say what of a file could not be read; '' if all was."""
    if reader.damaged_chunks:
        return f'{reader.damaged_chunks} stretch(es) of it cannot be read'
    return 'it ends within its data' if reader.truncated else ''
