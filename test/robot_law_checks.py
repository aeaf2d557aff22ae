# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Laws of robots, each against an independent form."""

from __future__ import annotations

from math import cos, exp, sin, sqrt
from typing import Callable

from law_runs import DT, law_of
import numpy as np
import pytest


def check_tip(name: str) -> None:
    tip = law_of(name, mass=0.5, stiffness=1e4, damping=3.0).compliance()
    assert tip == (0.5, 1e4, 3.0)


def check_joint_friction() -> None:
    law, state = law_of('joint_friction', F_c=4.0, wave=0.5, pitch=0.02, stiffness=1e6), 0.0
    delivered = []
    for k in range(2000):
        force, state = law.drive(0.0, 1e-4 * k, 0.1, DT, state)
        delivered.append(-force)
    assert np.max(delivered[200:]) == pytest.approx(6.0, rel=1e-3)
    assert np.min(delivered[200:]) == pytest.approx(2.0, rel=1e-3)


def check_stribeck_joint() -> None:
    law = law_of('stribeck_joint', F_c=3.0, F_s=2.0, v_s=0.02, F_v=1.0, v_t=0.1)
    for v in (0.05, -0.1):
        friction = 3.0 + 2.0 * exp(-abs(v) / 0.02) + abs(v / 0.1) ** 0.7
        assert 10.0 - law.drive(10.0, 0.0, v, DT, 0.0)[0] == pytest.approx(
            np.sign(v) * friction, rel=1e-6)


def check_sampled_command() -> None:
    t = np.arange(5000) * DT
    sent = np.column_stack((t, t, t))
    late = t - law_of('sampled_command', period=0.04, delay=0.01).follow(t, sent)[:, 0]
    assert np.mean(late[100:]) == pytest.approx(0.03, abs=1e-3)  # delay and half a period
    assert late[100:].max() == pytest.approx(0.049, abs=1e-3)


def check_torque_loop() -> None:
    law, tau, zeta = law_of('slow_torque_loop', tau=0.02, zeta=0.5), 0.02, 0.5
    _, state = law.drive(0.0, 0.0, 0.0, 1e-5, 0.0)
    for _ in range(3000):
        force, state = law.drive(5.0, 0.0, 0.0, 1e-5, state)
    root, t = sqrt(1.0 - zeta**2), 3000e-5
    ringing = cos(root * t / tau) + zeta / root * sin(root * t / tau)
    assert force == pytest.approx(5.0 * (1.0 - exp(-zeta * t / tau) * ringing), rel=1e-3)


def check_torque_limit() -> None:
    law = law_of('soft_torque_limit', limit=50.0)
    delivered = [law.drive(u, 0.0, 0.0, DT, 0.0)[0] for u in (1.0, 50.0, -1e5)]
    assert delivered == pytest.approx([1.0, 50.0 / 2.0**0.25, -50.0], rel=1e-6)


def check_windage() -> None:
    law = law_of('windage', c=100.0)
    assert [law.drive(0.0, 0.0, v, DT, 0.0)[0] for v in (0.1, -0.2)] == pytest.approx([-1.0, 4.0])


def check_cogging() -> None:
    law = law_of('cogging_torque', amplitude=2.0, pitch=0.004)
    forces = [law.drive(1.0, x, 0.0, DT, 0.0)[0] for x in (0.0, 0.001, 0.003)]
    assert forces == pytest.approx([1.0, 3.0, -1.0])


CHECKS: dict[str, Callable[[], None]] = {
    'flexible_mount': lambda: check_tip('flexible_mount'),
    'flexible_joint': lambda: check_tip('flexible_joint'),
    'joint_friction': check_joint_friction,
    'stribeck_joint': check_stribeck_joint,
    'sampled_command': check_sampled_command,
    'slow_torque_loop': check_torque_loop,
    'soft_torque_limit': check_torque_limit,
    'windage': check_windage,
    'cogging_torque': check_cogging,
}
