# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""A permanently attached wall under a recorded force: a drive that has friction and no spring."""

from __future__ import annotations

from concealed_worlds import diagnosed, named, nominal
from contact_estimation.diagnosis.observe.signals import Signals
import numpy as np
import pytest

NO_REFERENCE = (np.empty(0), np.empty((4, 0)))
MASS, DRAG, DRY, BIAS = 90.0, 200.0, 20.0, 3.0  # of a linear drive


def drive() -> Signals:
    """Record a drive without a spring that is controlled in position, integrated here."""
    rate, fine = 500, 10
    h = 1.0 / rate / fine
    t = np.arange(6 * rate) / rate
    wanted = 0.05 * np.sin(2.0 * t) + 0.02 * np.sin(5.3 * t + 1.0)
    wanted_rate = 0.1 * np.cos(2.0 * t) + 0.106 * np.cos(5.3 * t + 1.0)
    x, v = float(wanted[0]), float(wanted_rate[0])
    force, position = np.empty(len(t)), np.empty(len(t))
    for k in range(len(t)):
        push = 4e4 * (wanted[k] - x) + 3e3 * (wanted_rate[k] - v)
        force[k], position[k] = push, x
        for _ in range(fine):  # the controller holds its output
            v += h / MASS * (push - DRAG * v - DRY * np.tanh(v / 4e-4))
            x += h * v
    noise = np.random.default_rng(1).normal(size=(2, len(t)))
    measured = -force + BIAS + 0.2 * noise[0]
    return Signals(t, measured, t, position + 2e-7 * noise[1], *NO_REFERENCE)


@pytest.mark.slow
def test_friction_bias_drag_and_held_force_of_a_drive_are_found() -> None:
    found = diagnosed(drive(), nominal(  # which has the wrong drag
        environment__stiffness=0.0, environment__damping=300.0, environment__inertia=MASS,
        environment__unilateral=False))
    assert found.verdict == 'physics_missing'
    assert sorted(named(found)) == ['coulomb_friction', 'force_bias']
    values = {effect.name: effect.parameters for effect in found.effects}
    assert values['coulomb_friction']['F_c'].value == pytest.approx(DRY, rel=0.01)
    assert values['force_bias']['bias'].value == pytest.approx(BIAS, rel=0.02)
    assert found.damping.value == pytest.approx(DRAG, rel=0.01)
    assert found.stiffness.value == pytest.approx(0.0, abs=1.0)
    assert found.corrected.values[2] == pytest.approx(MASS, rel=0.01)
    assert found.recordings[0].observed.between == 'held'
