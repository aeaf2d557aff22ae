# Copyright 2026 contact_estimation authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""The full matrices: right for coupled axes, with deviations that hold, the same in replay."""

from __future__ import annotations

import json
from math import nan
from pathlib import Path

from axes_runs import feed_axes, instants, JOINTS, PARAMETERS, session_of_axes
from contact_estimation.commands import replay
from contact_estimation.estimation.parameters import EstimationParameters
from contact_estimation.estimators.stiffness_matrix import (
    matrices,
    MatrixEstimate,
    principal_table,
    StiffnessMatrix,
    StiffnessMatrixParameters,
)
from contact_estimation.exceptions import ParameterRangeError
from contact_estimation.messages import WrenchEncoder
from contact_estimation.parameters.values import build
from contact_estimation.recordings import RecordingReader, RecordingWriter
from contact_estimation.recordings.estimation_metadata import RECORD, to_metadata
from contact_estimation.signals.contact_sample import AxesSample, ContactSample
import numpy as np
import pytest
from reference_messages import joint_state_bytes, JOINTS as JOINTS_TYPE

STIFFNESSES = np.array([8000.0, 3000.0, 500.0])
T = 0.002 * np.arange(1500)
MATRIX = {'matrix_estimator': 'stiffness_matrix'}


def turned(seed: int) -> np.ndarray:
    """Return three orthonormal columns."""
    return np.linalg.qr(np.random.default_rng(seed).standard_normal((3, 3)))[0]


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


def estimate_of(samples: list[AxesSample]) -> MatrixEstimate:
    """Estimate from samples that are all in contact."""
    estimator = StiffnessMatrix(StiffnessMatrixParameters(), 0.002)
    return estimator.process(samples, [True] * len(samples))[-1]


@pytest.mark.parametrize('with_velocity', [True, False])
def test_coupled_matrices_are_found_without_noise(with_velocity: bool) -> None:
    q = turned(1)
    K = q @ np.diag(STIFFNESSES) @ q.T + 200.0 * (np.eye(3)[[1, 0, 2]] - np.eye(3)[[0, 1, 2]])
    B = 0.01 * K.T
    found = estimate_of(samples_of(K, B, 1, noise=0.0, with_velocity=with_velocity))
    np.testing.assert_allclose(found.stiffness, K, atol=2.0)
    np.testing.assert_allclose(found.damping, B, atol=0.05)


def test_the_forgetful_fit_is_weighted_least_squares() -> None:
    samples = samples_of(np.diag(STIFFNESSES), np.eye(3), 3)
    table = np.array([[[s.position, s.velocity, s.force] for s in axes] for axes in samples])
    weight = np.sqrt(np.exp(-0.1 / 5.0 * ((len(T) - 1 - np.arange(len(T))) // 50)))[:, None]
    columns = np.column_stack([table[:, :, 0] - table[0, :, 0], table[:, :, 1], np.ones(len(T))])
    theta = np.linalg.lstsq(weight * columns, -weight * table[:, :, 2], rcond=None)[0]
    found = estimate_of(samples)
    np.testing.assert_allclose(found.stiffness, theta[:3].T, rtol=1e-4, atol=0.01)
    np.testing.assert_allclose(found.damping, theta[3:6].T, rtol=1e-3, atol=1e-3)


@pytest.mark.slow
def test_deviations_hold() -> None:
    inside = []
    for seed in range(30):
        q = turned(seed)
        K = q @ np.diag(STIFFNESSES) @ q.T
        found = estimate_of(samples_of(K, 0.01 * K, seed))
        inside += (np.abs(found.stiffness - K) < 2.0 * found.stiffness_std).ravel().tolist()
        inside += (np.abs(found.damping - 0.01 * K) < 2.0 * found.damping_std).ravel().tolist()
        inside += (np.abs(found.principal - STIFFNESSES) < 2.0 * found.principal_std).tolist()
    assert 0.92 < np.mean(inside) < 0.995


def test_principal_directions_and_normal_are_those_of_the_wall() -> None:
    q = turned(4)
    found = estimate_of(samples_of(q @ np.diag(STIFFNESSES) @ q.T, 0.01 * np.eye(3), 4))
    angles = np.arccos(np.abs(np.sum(found.directions * q.T, axis=1)))
    assert (angles < 4.0 * found.direction_std).all() and (found.direction_std < 0.01).all()
    assert np.arccos(abs(found.normal @ q[:, 0])) < 0.02


def test_the_normal_points_into_the_wall() -> None:
    n = np.array([1.0, 1.0, 0.0]) / np.sqrt(2.0)
    K = 5000.0 * np.outer(n, n)
    found = estimate_of(samples_of(K, 0.01 * K, 6))
    np.testing.assert_allclose(found.normal, n, atol=0.01)  # pushed by K (0.01, 0, 0) m
    assert found.principal[1] < 3.0 * found.principal_std[1] + 50.0
    assert (found.principal >= 0.0).all()


def test_without_excitation_the_normal_is_the_direction_of_the_force() -> None:
    force = (-30.0, -10.0, 0.0)
    rest = [tuple(ContactSample(2_000_000 * k, 0.0, 0.0, f) for f in force) for k in range(200)]
    found = estimate_of(rest)
    np.testing.assert_allclose(found.normal, -np.array(force) / np.linalg.norm(force))
    assert (found.stiffness_std[0] > 1e5).all()


def test_runs_may_be_cut_anywhere() -> None:
    samples = samples_of(np.diag(STIFFNESSES), np.eye(3), 5)
    estimator = StiffnessMatrix(StiffnessMatrixParameters(), 0.002)
    for begin in range(0, len(samples), 7):
        part = samples[begin:begin + 7]
        estimator.process(part, [True] * len(part))
    last = estimator.estimate
    assert last is not None
    np.testing.assert_array_equal(last.stiffness, estimate_of(samples).stiffness)


def test_another_wall_after_free_flight_is_learned_anew() -> None:
    first = samples_of(np.diag(STIFFNESSES), np.eye(3), 5)
    second = samples_of(2.0 * np.diag(STIFFNESSES), np.eye(3), 6)
    estimator = StiffnessMatrix(StiffnessMatrixParameters(), 0.002)
    estimator.process(first, [True] * len(first))
    estimator.process(first[:300], [False] * 300)
    found = estimator.process(second, [True] * len(second))[-1]
    np.testing.assert_allclose(np.diag(found.stiffness), 2.0 * STIFFNESSES, rtol=0.02)


def test_two_axes_are_refused() -> None:
    two = {k: v for k, v in PARAMETERS.items() if '.z.' not in k}
    with pytest.raises(ParameterRangeError, match='needs the axes x, y and z, got x, y'):
        build(EstimationParameters, {**two, **MATRIX})


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
    messages = list(RecordingReader(out).messages(['/estimator_node/stiffness_matrix']))
    assert len(messages) == len(every)
    assert messages[-1].data[-36 * 8:] == matrices(last).tobytes()
    assert principal_table(last).shape == (3, 6)
