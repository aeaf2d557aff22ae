# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Stamps that are late or early are told from delays, masses and memories."""

from __future__ import annotations

import re
from typing import Any

from contact_estimation.diagnosis.conclude.diagnose import diagnose
from contact_estimation.diagnosis.conclude.result import Diagnosis
from contact_estimation.diagnosis.conclude.views import Offset
from contact_estimation.diagnosis.observe.signals import Recording
from diagnosed_worlds import nominal, recorded
import pytest

LATE_S, DRIVE_HZ = 0.01, 250.0
WALL = {'environment.stiffness': 5000.0, 'environment.damping': 12.0, 'environment.inertia': 2.0,
        'environment.location': 0.0, 'environment.unilateral': False}


def diagnosed(late: float, wrench: float = 0.0, **physics: Any) -> Diagnosis:
    """Diagnose a recording whose joint states, or wrenches, are stamped late."""
    signals = recorded(**{f'physics__{name}': value for name, value in physics.items()})
    late_ones = signals._replace(joint_t=signals.joint_t + late - wrench,
                                 reference_t=signals.reference_t - wrench)
    return diagnose(Recording('late.mcap', late_ones), nominal())


@pytest.mark.parametrize('wrench, joints', [(-0.004, 0.0), (0.0, -0.003)])
def test_stamps_before_the_event_are_no_mass_and_no_memory(wrench: float, joints: float) -> None:
    found = diagnosed(joints, wrench)
    failed = {check.name: check.text for check in found.checks if not check.ok}
    assert (list(failed), found.effects, found.verdict) == (['clock_offset'], [], 'unexplained')
    early = 'wrench is' if wrench else 'joint_states are'
    assert f'{early} stamped early' in failed['clock_offset']
    remedy = re.search(r'set synchronisation.offset to (-?[\d.]+) s', failed['clock_offset'])
    assert remedy and float(remedy[1]) == pytest.approx(wrench - joints, rel=0.1)


def test_an_offset_is_put_right() -> None:
    signals = recorded()
    for offset, joints, reference in (
            (Offset('joint_states', 0.01), -0.01, 0.0), (Offset('wrench', 0.01), 0.01, 0.01)):
        shifted = offset.put_right(Recording('file.mcap', signals)).signals
        assert shifted.joint_t == pytest.approx(signals.joint_t + joints, abs=1e-12)
        assert shifted.reference_t == pytest.approx(signals.reference_t + reference, abs=1e-12)


def test_a_command_that_arrives_late_is_named() -> None:
    found = diagnosed(0.0, command_delay__delay=LATE_S)
    assert [effect.name for effect in found.effects] == ['command_delay']
    assert all(check.ok for check in found.checks)
