# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The estimator node itself on an arm: driver, estimator and recorder as processes over DDS."""

from __future__ import annotations

import json
from pathlib import Path
import re
import shutil
import time
from typing import Any

from .arm_evaluation import Case, errors, Estimated
from .arm_files import ArmFiles
from .speed_nodes import end_node, start_node
from ..exceptions import EstimationError
from ..recordings import RecordingReader
from ..recordings.plain_decoding import decode_diagnostics, Vector3StampedDecoder

_START_S = 3.0
_LONGEST_S = 120.0
_TOPICS = {'stiffness': 'stiffness', 'stiffness_std': 'stiffness_std', 'damping': 'damping',
           'damping_std': 'damping_std', 'location': 'location'}


def live_run(files: ArmFiles, case: Case) -> tuple[dict[str, Any], Path]:
    """Play a run to the node in real time and record what it publishes."""
    recorded = files.path(f'live_{case.name}')
    shutil.rmtree(recorded, ignore_errors=True)  # of an interrupted study
    parameters = [f'{name}:={_yaml(value)}' for name, value in case.parameters.items()]
    nodes = [
        start_node('contact_estimation.ros.recorder_node', [f'output:={recorded}']),
        # The arm follows the reference that is played, not that of the node.
        start_node('contact_estimation.ros.estimator_node', parameters,
                   ['reference_trajectory:=unused_reference']),
    ]
    try:
        time.sleep(_START_S)
        nodes.append(
            start_node(f'{__package__}.arm_player_node', [f'recording:={case.recording}']))
        if nodes[-1].wait(_LONGEST_S) or any(node.poll() is not None for node in nodes[:2]):
            raise EstimationError(f'a node ended early: {[node.poll() for node in nodes]}')
    finally:
        for node in reversed(nodes):
            end_node(node)
    return errors(_last(recorded), case.run, case.world), recorded


def _yaml(value: Any) -> str:
    return json.dumps(list(value) if isinstance(value, tuple) else value)


def _last(recorded: Path) -> Estimated:
    """Return the last estimates that the node published."""
    reader, decoder = RecordingReader(recorded), Vector3StampedDecoder()
    topics = {f'/estimator_node/{topic}': name for name, topic in _TOPICS.items()}
    values = dict.fromkeys(_TOPICS, float('nan'))
    for message in reader.messages(list(topics)):
        value = decoder.decode(message.data)[1]
        if value == value:
            values[topics[message.topic]] = value
    return Estimated(
        'kalman', 'load and inertia, on line', values['stiffness'], values['stiffness_std'],
        values['damping'], values['damping_std'], values['location'],
        warnings=tuple(warned(reader)))


def warned(reader: RecordingReader) -> list[str]:
    """Return what a node has warned of, without remedies and numbers that change."""
    kinds: dict[str, str] = {}
    for message in reader.messages(['/diagnostics']):
        for status in decode_diagnostics(message.data):
            for key, text in status.values.items():
                if re.fullmatch(r'warning_\d+', key):
                    kinds.setdefault(re.sub(r'[-+.\d]+', '#', text), text.split(';')[0])
    return list(kinds.values())
