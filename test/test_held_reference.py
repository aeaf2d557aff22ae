# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""A reference that the robot holds between setpoints is told from a late one."""

from __future__ import annotations

from math import floor
from typing import Any

from contact_estimation.diagnosis.conclude.diagnose import diagnose
from contact_estimation.diagnosis.observe.signals import Recording, Signals
from contact_estimation.diagnosis.report.text_report import as_text
from contact_estimation.plant.open_loop import run_open_loop
from diagnosed_worlds import INTEGRATION_HZ, nominal, RATE_HZ, TWO_TOUCHES, world
import numpy as np
from numpy.typing import NDArray
import pytest

Array = NDArray[np.float64]

STEPS: Array = np.array([[0.0, 1.0, 3.0, 2.0, 2.0, 5.0]])
STAMPS: Array = np.linspace(0.0, 0.2, 6)


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


def named(recording: Recording) -> dict[str, float]:
    """Name effects with their first parameter."""
    return {effect.name: next(iter(effect.parameters.values())).value
            for effect in diagnose(recording, nominal()).effects}


@pytest.mark.parametrize('periods', [1, 5])
def test_a_held_reference_is_no_delay(periods: int) -> None:
    found = diagnose(recorded_with_hold(periods / RATE_HZ), nominal())
    assert (found.effects, found.holds_reference) == ([], True)
    assert 'holds its reference' in as_text(found)


def test_a_delay_beyond_the_hold_is_named() -> None:
    found = named(recorded_with_hold(1.0 / RATE_HZ, physics__command_delay__delay=0.02))
    assert list(found) == ['command_delay']
    assert found['command_delay'] == pytest.approx(0.02, abs=0.5 / RATE_HZ)
