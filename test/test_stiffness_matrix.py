# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The full matrices: right for coupled axes, with deviations that hold, the same in replay."""

from __future__ import annotations

import json
from math import nan
from pathlib import Path

from axes_runs import feed_axes, instants, JOINTS, PARAMETERS, session_of_axes
from contact_estimation.commands import replay
from contact_estimation.estimators.stiffness_matrix import (
    matrices, principal_table, StiffnessMatrix, StiffnessMatrixParameters)
from contact_estimation.recordings import RecordingReader, RecordingWriter
from contact_estimation.recordings.encoding import WrenchEncoder
from contact_estimation.recordings.source import RECORD, to_metadata
from contact_estimation.signals.contact_sample import AxesSample, ContactSample
import numpy as np
from reference_messages import joint_state_bytes, JOINTS as JOINTS_TYPE

STIFFNESSES = np.array([8000.0, 3000.0, 500.0])
T = 0.002 * np.arange(1500)
MATRIX = {'matrix_estimator': 'stiffness_matrix'}


def samples_of(
    K: np.ndarray, B: np.ndarray, seed: int, noise: float = 0.3, with_velocity: bool = True
) -> list[AxesSample]:
    """Move 1 mm along every axis about a point off the origin; press with K x + B v + c."""
    draw = np.random.default_rng(seed)
    omega, phase = 2.0 * np.pi * draw.uniform(1.0, 6.0, (3, 3, 1)), draw.uniform(0, 6, (3, 3, 1))
    x = 1e-3 * np.sin(omega * T + phase).sum(axis=0).T + np.array([0.4, -0.2, 0.1])
    v = 1e-3 * (omega * np.cos(omega * T + phase)).sum(axis=0).T
    F = -((x - [0.39, -0.2, 0.1]) @ K.T + v @ B.T) + noise * draw.standard_normal(x.shape)
    rates = v if with_velocity else np.full_like(v, nan)
    return [
        tuple(ContactSample(round(2e6 * k), *map(float, (x[k, i], rates[k, i], F[k, i])))
              for i in range(3))
        for k in range(len(T))
    ]


def test_estimates_agree_with_batch_least_squares_of_the_samples() -> None:
    samples = samples_of(np.diag(STIFFNESSES), 10.0 * np.eye(3), 3)
    table = np.array([[[s.position, s.velocity, s.force] for s in axes] for axes in samples])
    weight = np.sqrt(np.exp(0.002 / 5.0 * np.arange(len(T))))[:, None]
    columns = np.column_stack([table[:, :, 0] - table[0, :, 0], table[:, :, 1], np.ones(len(T))])
    theta = np.linalg.lstsq(weight * columns, -weight * table[:, :, 2], rcond=None)[0]
    estimator = StiffnessMatrix(StiffnessMatrixParameters(), 1e-6)  # as here, no lag
    found = estimator.process(samples, [True] * len(samples))[-1]
    assert (np.abs(found.stiffness - theta[:3].T) < 0.7 * found.stiffness_std).all()
    assert (np.abs(found.damping - theta[3:6].T) < 0.7 * found.damping_std).all()


def test_replay_gives_the_matrices_of_the_session(tmp_path: Path) -> None:
    samples, wrenches = instants(0.6), WrenchEncoder('tool')
    with RecordingWriter.file(tmp_path / 'a.mcap') as writer:
        for stamp_ns, positions, velocities, forces in samples:
            raw = joint_state_bytes(list(JOINTS.values()), positions, velocities,
                                    stamp_ns=stamp_ns)
            writer.write('/joint_states', JOINTS_TYPE, raw, stamp_ns)
            raw = wrenches.encode(stamp_ns, *forces)
            writer.write('/wrench', 'geometry_msgs/msg/WrenchStamped', raw, stamp_ns)
        writer.write_metadata(RECORD, to_metadata({**PARAMETERS, **MATRIX}))
    session = session_of_axes(False, **MATRIX)
    feed_axes(session, samples)
    every, last = session.matrix.take(), session.matrix.last
    out, summary = tmp_path / 'out.mcap', tmp_path / 'out.json'
    assert last is not None
    assert replay.main([str(tmp_path / 'a.mcap'), '--json', str(summary), '--output',
                        str(out)]) == 0
    found = json.loads(summary.read_text())['stiffness_matrix']
    assert found['stiffness'] == last.stiffness.tolist()
    assert found['status'] == 'estimating'
    assert session.matrix.status == f'estimating: {found["reason"]}'
    messages = list(RecordingReader(out).messages(['/estimator_node/stiffness_matrix']))
    assert len(messages) == len(every)
    assert messages[-1].data[-36 * 8:] == matrices(last).tobytes()
    assert principal_table(last).shape == (3, 6)
