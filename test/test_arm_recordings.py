# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Recordings of an arm: replay and diagnosis take x, v and F_e along its normal."""

from __future__ import annotations

import json
from pathlib import Path

from arm_contact import instants, K_E, LOCATION, messages, NORMAL, PARAMETERS
from contact_estimation.commands import replay
from contact_estimation.diagnosis.observe.signals import read_recording
from contact_estimation.exceptions import RecordingError
from contact_estimation.pipeline.events import DESCRIPTION, EstimationEvent
from contact_estimation.recordings import RecordingWriter
from contact_estimation.recordings.encoding import encode_string
from contact_estimation.recordings.source import RECORD, to_metadata
import numpy as np
import pytest
from reference_messages import JOINTS, STRING, WRENCH
from small_arm import pose, urdf
import yaml

pytest.importorskip('pinocchio')
TYPES = {'/joint_states': JOINTS, '/wrench': WRENCH}


def record(path: Path, every: int = 1, description: str = '', metadata: bool = False) -> Path:
    with RecordingWriter.file(path) as writer:
        for topic, stamp_ns, raw in messages(every):
            writer.write(topic, TYPES[topic], raw, stamp_ns)
        if description == 'topic':
            writer.write('/robot_description', STRING, encode_string(urdf()), stamp_ns)
        if description == 'event':
            event = EstimationEvent(DESCRIPTION, 0, {'text': urdf()})
            raw = encode_string(event.to_text())
            writer.write('/estimator_node/events', STRING, raw, stamp_ns)
        if metadata:
            writer.write_metadata(RECORD, to_metadata(PARAMETERS))
    return path


def parameter_file(folder: Path) -> Path:
    """Write the parameters and the description as files."""
    (folder / 'arm.urdf').write_text(urdf())
    values = {**PARAMETERS, 'robot_description_file': str(folder / 'arm.urdf')}
    file = folder / 'arm.yaml'
    file.write_text(yaml.safe_dump({'estimator_node': {'ros__parameters': values}}))
    return file


def test_replay_takes_arm_and_description_from_files(tmp_path: Path) -> None:
    recording = record(tmp_path / 'a.mcap')
    assert replay.main([str(recording), '--params', str(parameter_file(tmp_path)),
                        '--json', str(tmp_path / 'a.json')]) == 0
    summary = json.loads((tmp_path / 'a.json').read_text())
    assert summary['stiffness'] == pytest.approx(K_E, rel=0.01)
    assert summary['location'] == pytest.approx(LOCATION, abs=1e-4)
    assert summary['samples'] == len(instants())


def test_later_parameter_files_override_earlier_ones_and_an_arm_has_a_picture(
    tmp_path: Path
) -> None:
    pytest.importorskip('matplotlib')
    recording, tool = record(tmp_path / 'a.mcap'), tmp_path / 'tool.yaml'
    tool.write_text(yaml.safe_dump({'/**': {'ros__parameters': {'estimator': 'kalman'}}}))
    assert replay.main([
        str(recording), '--params', str(parameter_file(tmp_path)), '--params', str(tool),
        '--json', str(tmp_path / 'a.json'), '--picture', str(tmp_path / 'a.png')]) == 0
    assert json.loads((tmp_path / 'a.json').read_text())['estimator'] == 'kalman'
    assert (tmp_path / 'a.png').read_bytes().startswith(b'\x89PNG')


@pytest.mark.parametrize('description', ['topic', 'event'])
def test_replay_takes_arm_and_description_from_the_recording(
    tmp_path: Path, description: str
) -> None:
    recording = record(tmp_path / 'a.mcap', description=description, metadata=True)
    assert replay.main([str(recording), '--json', str(tmp_path / 'a.json')]) == 0
    summary = json.loads((tmp_path / 'a.json').read_text())
    assert summary['stiffness'] == pytest.approx(K_E, rel=0.01)


def test_a_recording_without_description_says_what_to_give(tmp_path: Path) -> None:
    recording = record(tmp_path / 'a.mcap', metadata=True)
    with pytest.raises(RecordingError, match='no robot description on /robot_description'):
        read_recording(recording)


@pytest.mark.parametrize('frame', ['base', 'tip'])
def test_diagnosis_reads_motion_and_force_along_the_normal(tmp_path: Path, frame: str) -> None:
    recording = record(tmp_path / 'a.mcap', 4, 'topic', metadata=True)
    normal, truth = NORMAL, instants()
    if frame == 'tip':
        deepest = min(truth, key=lambda instant: instant.contact.force)
        normal = pose(tuple(deepest.q))[:3, :3].T @ NORMAL
    signals = read_recording(recording, parameters={
        'contact.normal': normal.tolist(), 'contact.normal_frame': frame}).signals
    assert len(signals.joint_t) == len(truth[::4])
    np.testing.assert_allclose(
        signals.position, [t.contact.position + LOCATION for t in truth[::4]], atol=1e-4)
    forces = np.array([t.contact.force for t in truth])[:len(signals.force)]
    assert len(forces) > len(truth) - 4  # the last wrenches have no later joint state
    np.testing.assert_allclose(signals.force, forces, atol=0.02)


def test_diagnosis_takes_out_the_inertia_of_a_tool_of_known_mass(tmp_path: Path) -> None:
    recording = record(tmp_path / 'a.mcap', description='topic', metadata=True)
    with_tool, without = (
        read_recording(recording, parameters={'physics.tool_inertia.mass': mass}).signals
        for mass in (2.0, float('nan')))
    t, v = (np.array([getattr(one.contact, name) for one in instants()], float)
            for name in ('stamp_ns', 'velocity'))
    inertia = 2.0 * np.gradient(v, 1e-9 * t)[:len(without.force)]
    jumps = np.abs(np.diff(inertia, prepend=0.0)) > 0.2  # the touch, smeared over 20 ms
    smooth = np.convolve(jumps, np.ones(21), 'same') == 0.0
    taken = (with_tool.force - without.force)[smooth]
    np.testing.assert_allclose(taken, inertia[smooth], atol=0.1 * np.abs(inertia).max())


def test_force_sign_turns_a_recording_of_one_axis(tmp_path: Path) -> None:
    with RecordingWriter.file(tmp_path / 'a.mcap') as writer:
        for topic, stamp_ns, raw in messages():
            writer.write(topic, TYPES[topic], raw, stamp_ns)
    forces = [read_recording(tmp_path / 'a.mcap', joint=name, parameters=given).signals.force
              for name, given in (('wrist', {}), ('wrist', {'force_sign': -1}))]
    np.testing.assert_array_equal(forces[0], -forces[1])
