# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Late stamps and held references are told from delays, masses and memories."""

from __future__ import annotations

from math import floor
import re
from typing import Any

from contact_estimation.diagnosis.diagnose import diagnose
from contact_estimation.diagnosis.observe.signals import Recording, Signals
from contact_estimation.diagnosis.report.text_report import as_text
from contact_estimation.plant.simulation import run_open_loop
from diagnosed_worlds import INTEGRATION_HZ, nominal, RATE_HZ, recorded, TWO_TOUCHES, world
import numpy as np
import pytest


@pytest.mark.slow
def test_stamps_before_the_event_are_no_mass_and_no_memory() -> None:
    early = -0.004
    signals = recorded()
    found = diagnose(Recording('early.mcap', signals._replace(
        joint_t=signals.joint_t - early, reference_t=signals.reference_t - early)), nominal())
    failed = {check.name: check.text for check in found.checks if not check.ok}
    assert (list(failed), found.effects, found.verdict) == (['clock_offset'], [], 'unexplained')
    assert 'wrench is stamped early' in failed['clock_offset']
    remedy = re.search(r'set synchronisation.offset to (-?[\d.]+) s', failed['clock_offset'])
    assert remedy and float(remedy[1]) == pytest.approx(early, rel=0.1)


def recorded_with_hold(period: float, **changes: Any) -> Recording:
    """Let the robot hold each setpoint; the desired trajectory is recorded as usual."""
    plant = world(sensors__force_noise=0.3, sensors__position_noise=3e-6, sample_rate=RATE_HZ,
                  integration_rate=INTEGRATION_HZ, seed=3, **changes)

    def desired(t: float) -> tuple[float, float, float, float]:
        return (*TWO_TOUCHES.desired(t)[:3], 0.0)

    def held(t: float) -> tuple[float, float, float, float]:
        return desired(floor(t / period + 1e-9) * period)

    truths, samples = run_open_loop(plant, held, -0.01, TWO_TOUCHES.duration)
    t = np.array([truth.t for truth in truths])
    stamps = np.arange(0.0, t[-1] + 1e-9, period)
    rows = np.array([desired(now) for now in stamps.tolist()]).T
    return Recording('held.mcap', Signals(t, samples.force, t, samples.position, stamps, rows))


@pytest.mark.slow
def test_a_held_reference_is_no_delay() -> None:
    found = diagnose(recorded_with_hold(5.0 / RATE_HZ), nominal())
    assert (found.effects, found.holds_reference) == ([], True)
    assert 'holds its reference' in as_text(found)
