# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Parameters of the plant node itself."""

from __future__ import annotations

from dataclasses import dataclass

from ..parameters.specification import parameter, ParameterGroup


@dataclass(frozen=True)
class PlantNodeParameters(ParameterGroup):
    """The experiment, and when it starts and ends."""

    experiment: str = parameter(
        'sine', 'Name of an experiment, or a YAML file of segments', read_only=True
    )
    duration: float = parameter(
        0.0, 'Time after which the node ends; 0: that of the experiment', 's', minimum=0.0,
        read_only=True,
    )
    repeat: bool = parameter(
        False, 'Repeat the experiment until the duration is over; without a '
        'duration, without end', read_only=True,
    )
    subscribers: int = parameter(
        1, 'Number of subscribers of wrench and joint_states to wait for at the start', minimum=0,
        maximum=1000, read_only=True,
    )
    patience_s: float = parameter(
        30.0, 'Start without them after this', 's', minimum=0.0, read_only=True
    )
    lockstep: bool = parameter(
        False, 'Send a sample only after the reference for the previous one has arrived: '
        'the run does not depend on the speed of the machine', read_only=True,
    )
    frame_id: str = parameter('contact_frame', 'Frame of the wrench', read_only=True)
    joint: str = parameter('contact_x', 'Name of the joint', read_only=True)
    summary_file: str = parameter(
        '', 'At the end, write samples sent, samples dropped and latency to this JSON file',
        read_only=True,
    )
