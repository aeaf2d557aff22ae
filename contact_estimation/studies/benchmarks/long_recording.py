# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""A long recording of two topics, repeated from one simulated run."""

from __future__ import annotations

from itertools import chain, cycle, islice
from pathlib import Path
from typing import Iterator

from .simulated_samples import pressing, RATE, sine_manoeuvre
from ...messages import JointStateEncoder, WrenchEncoder
from ...pipeline.axes import Result
from ...recordings import RecordingWriter

CONTACTS = ('mixed', 'always')
_BEGIN_NS = 1_700_000_000_000_000_000
_PERIOD_NS = round(1e9 / RATE)
_CYCLE_S = 12.0
_TRANSPORT_NS = 200_000  # from stamp to log time


def write_long_recording(folder: Path, hours: float, contact: str) -> None:
    """
    Write wrench and joint_states at 500 Hz with advancing stamps.

    folder: new rosbag2 folder
    hours: length [h]
    contact: 'mixed': the sine manoeuvre of 12 s repeated, one third in contact; 'always': one
    approach, then contact under excitation to the end
    """
    wrenches = WrenchEncoder('contact_frame')
    joints = JointStateEncoder('contact_frame', 'contact_x', True)
    with RecordingWriter.folder(folder) as writer:
        samples = islice(_endless(contact), round(hours * 3600.0 * RATE))
        for k, (_, position, velocity, force) in enumerate(r.sample for r in samples):
            stamp_ns = _BEGIN_NS + k * _PERIOD_NS
            log_ns = stamp_ns + _TRANSPORT_NS
            data = joints.encode(stamp_ns, position, velocity)
            writer.write('/joint_states', 'sensor_msgs/msg/JointState', data, log_ns)
            data = wrenches.encode(stamp_ns, force, 0.0, 0.0)
            writer.write('/wrench', 'geometry_msgs/msg/WrenchStamped', data, log_ns)


def _endless(contact: str) -> Iterator[Result]:
    if contact == 'mixed':
        return cycle(sine_manoeuvre())
    approach, pressed = pressing(_CYCLE_S)
    return chain(approach, cycle(pressed))
