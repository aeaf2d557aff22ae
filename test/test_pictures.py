# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""`--picture` of replay and simulate: a picture of force, motion and estimates."""

from __future__ import annotations

from pathlib import Path

from contact_estimation.commands import replay, simulate
from contact_estimation.estimators.estimate import Estimate, EstimateStatus
import pytest
from run_commands import Command

PNG = b'\x89PNG\r\n'
SHORT = """
start: -0.01
segments:
- {duration: 0.4, position: 0.008}
- {duration: 0.3, position: -0.01}
"""


def estimates(count: int, first: int = 0) -> list[tuple[Estimate, ...]]:
    """Return estimates whose stiffness is their number."""
    return [(Estimate(k, float(k), 2.0, 3.0, 4.0, 0.0, 0.0, EstimateStatus.ESTIMATING, ''),)
            for k in range(first, first + count)]


def test_simulate_and_replay_write_a_picture(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip('matplotlib')
    (tmp_path / 'model.yaml').write_text(
        'plant_node: {ros__parameters: {environment: {stiffness: 4800.0}}}')
    (tmp_path / 'short.yaml').write_text(SHORT)
    recording = tmp_path / 'a.mcap'
    simulated = Command('simulate', simulate.main, capfd)(
        '--model', tmp_path / 'model.yaml', '--experiment', tmp_path / 'short.yaml',
        '--output', recording, '--picture', tmp_path / 'a.png')
    replayed = Command('replay', replay.main, capfd)(recording, '--picture', tmp_path / 'b.png')
    assert (simulated.code, replayed.code) == (0, 0)
    assert (tmp_path / 'a.png').read_bytes().startswith(PNG)
    assert (tmp_path / 'b.png').read_bytes().startswith(PNG)


def test_a_picture_never_replaces_a_recording(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    recording = tmp_path / 'a.mcap'
    recording.write_bytes(b'\x89MCAP0\r\n')
    message = Command('replay', replay.main, capfd).refusal(recording, '--picture', recording)
    assert 'recordings are never overwritten' in message
    assert recording.read_bytes() == b'\x89MCAP0\r\n'


def test_a_picture_of_another_kind_is_refused(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip('matplotlib')
    message = Command('replay', replay.main, capfd).refusal('a.mcap', '--picture', 'run.pdf')
    assert '--picture writes a PNG file, got run.pdf' in message
