# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Simulated samples for the benchmarks, and a long recording repeated from them."""

from __future__ import annotations

from itertools import chain, cycle, islice
from math import pi
from pathlib import Path
from typing import Iterator

from ...messages import JointStateEncoder, WrenchEncoder
from ...parameters.values import build
from ...pipeline.axes import Result
from ...pipeline.parameters import EstimationParameters
from ...pipeline.session import ContactSession
from ...plant.closed_loop import run_closed_loop
from ...plant.plant_parameters import PAPER_NOISE, PlantParameters
from ...recordings import RecordingWriter
from ...reference.experiment import Experiment, Sine
from ...reference.experiments import experiment_named, manoeuvre


RATE = 500.0
PERIOD_S = 1.0 / RATE
_SETTLED_S = 8.6
"""Two seconds into the hold [s]."""


def sine_manoeuvre() -> list[Result]:
    """Simulate the sine experiment once; it ends at rest at its start position."""
    return _simulate(experiment_named('sine'), experiment_named('sine').duration)


def pressing(seconds: float) -> tuple[list[Result], list[Result]]:
    """
    Simulate an approach and a contact with 3 Hz excitation.

    seconds: duration of the contact; a multiple of 1 s has whole periods [s]
    """
    experiment = manoeuvre('pressing', Sine(8.0, 6.0 * pi), hold_s=seconds + 3.0)
    results = _simulate(experiment, _SETTLED_S + seconds)
    begin = round(_SETTLED_S * RATE)
    return results[:begin], results[begin:]


def _simulate(experiment: Experiment, duration: float) -> list[Result]:
    plant = build(PlantParameters, PAPER_NOISE)
    session = ContactSession(build(EstimationParameters, {'sample_rate': RATE}))
    return run_closed_loop(plant, session, experiment, duration).results


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
