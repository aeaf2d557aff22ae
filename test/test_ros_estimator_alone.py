# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""What only a fresh node of its own can show."""

from __future__ import annotations

from pathlib import Path

from contact_estimation.signals.contact_sample import ContactSample
from core_runs import contact_samples
import pytest
from ros_messages import JOINT, moved
from ros_peer import estimator_and_peer, PERIOD_NS

pytestmark = pytest.mark.slow

K_E = 4800.0
TOUCH = contact_samples(0.5, force_noise=0.1)
LONG = contact_samples(1.0, depth=0.012, amplitude=0.004)


def test_without_desired_trajectory_the_robot_rests_and_presses_with_force_reference(
    tmp_path: Path,
) -> None:
    for peer in estimator_and_peer(tmp_path, False, force_reference=20.0, joint=JOINT):
        begin_ns = peer.start_afresh()
        samples = moved(LONG, begin_ns)
        peer.feed(samples)
        positions = list(peer.reference_positions().values())
        assert positions[:80] == [-0.01] * 80
        K_hat = peer.values('stiffness')[samples[-1].stamp_ns]
        assert positions[-1] == pytest.approx(20.0 / K_hat, abs=5e-6)  # from the surface found
        last = peer.references[samples[-1].stamp_ns + PERIOD_NS]
        assert (last.joint_names, list(last.points[0].effort)) == ([JOINT], [20.0])


def test_tare_removes_a_bias(tmp_path: Path) -> None:
    for peer in estimator_and_peer(tmp_path):
        begin_ns = peer.start_afresh()
        free = [ContactSample(begin_ns + k * PERIOD_NS, -0.01, 0.0, -5.0) for k in range(400)]
        peer.feed(free)
        answer = peer.trigger('tare')
        assert answer.success, answer.message
        peer.diagnosed(
            lambda _, values: float(values['force_bias']) == pytest.approx(-5.0, abs=1e-3),
            'a bias of -5 N',
        )
        later = free[-1].stamp_ns + PERIOD_NS
        peer.feed([s._replace(force=s.force - 5.0) for s in moved(LONG, later)])
        stiffness = list(peer.values('stiffness').values())
        assert stiffness[-1] == pytest.approx(K_E, rel=0.01)
