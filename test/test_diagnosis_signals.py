# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""What a diagnosis observes: clocks and residuals."""

from __future__ import annotations

from functools import lru_cache
from math import floor
import re
from typing import Any

from concealed_worlds import FORCE_NOISE, physics, prepared_from, recorded as of_wall
from contact_estimation.diagnosis.dependence import Dependence, dependences
from contact_estimation.diagnosis.diagnose import diagnose
from contact_estimation.diagnosis.fit.discrepancy import discounted
from contact_estimation.diagnosis.fit.fitting import fit
from contact_estimation.diagnosis.location import guess_port, intervals
from contact_estimation.diagnosis.observe.model import Model
from contact_estimation.diagnosis.observe.prepared_recording import PreparedRecording
from contact_estimation.diagnosis.observe.residuals import force_residual
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


def test_force_residual_of_the_true_model_is_the_sensor_s_noise() -> None:
    recording, model = prepared_from(of_wall())
    residual = force_residual(recording, model)[recording.use]
    assert np.std(residual) == pytest.approx(FORCE_NOISE, rel=0.05)
    assert abs(np.mean(residual)) < 4.0 * FORCE_NOISE / np.sqrt(len(residual))


EFFECTS = {
    'coulomb_friction': (2.0,), 'cubic_stiffness': (3e6,), 'force_drift': (0.6,),
    'tool_inertia': (1.0,), 'robot_friction': (3.0,),
}


@lru_cache(maxsize=None)
def recalibrated(name: str = '') -> tuple[PreparedRecording, Model]:
    """Fit stiffness and damping alone in the world of an effect, '' for none."""
    recording, model = prepared_from(of_wall(**physics(name, *EFFECTS[name]) if name else {}))
    recording = discounted(recording, model)
    return recording, fit([recording], model).model


def found_in(name: str, channel: str) -> dict[str, Dependence]:
    """Test the residual of one channel."""
    every = dependences(*recalibrated(name), np.random.default_rng(0))
    return {one.on: one for one in every if one.channel == channel}


@pytest.mark.slow
@pytest.mark.parametrize('name, channel, on', [
    ('coulomb_friction', 'force', 'velocity'), ('cubic_stiffness', 'force', 'depth'),
    ('force_drift', 'force', 'time'), ('tool_inertia', 'force', 'acceleration'),
    ('robot_friction', 'motion', 'its own past'),
])
def test_residual_depends_on_the_quantity_of_the_missing_law(
    name: str, channel: str, on: str
) -> None:
    found = found_in(name, channel)
    assert found[on].is_real
    others = [one.share for key, one in found.items() if key not in ('its own past', 'frequency')]
    assert found[on].share >= max(others)


WORLDS = [
    ('coulomb_friction', (2.0,), 'contact'),
    ('cubic_stiffness', (3e6,), 'contact'),
    ('moving_environment', (0.0003, 1.7, 0.7), 'contact'),
    ('viscoelastic_relaxation', (500.0, 0.15), 'contact'),
    ('force_bias', (2.0,), 'force_sensor'),
    ('force_drift', (0.3,), 'force_sensor'),
    ('force_saturation', (70.0,), 'force_sensor'),
    ('tool_inertia', (1.0,), 'force_sensor'),
    ('robot_friction', (3.0,), 'robot'),
    ('reflected_inertia', (1.5,), 'robot'),
    ('actuator_saturation', (90.0,), 'robot'),
]


def refitted(signals: Signals) -> tuple[PreparedRecording, Model]:
    """Fit stiffness and damping alone."""
    recording, model = prepared_from(signals)
    recording = discounted(recording, model)
    return recording, fit([recording], model).model


@pytest.mark.slow
def test_port_of_an_effect_is_guessed_from_its_residuals() -> None:
    for name, values, expected in WORLDS:
        recording, model = refitted(of_wall(**physics(name, *values)))
        assert guess_port(recording, model) == expected, (name, values, expected)


def test_intervals_are_where_the_energy_is() -> None:
    recording, _ = prepared_from(of_wall())
    step = recording.observed.h * recording.block
    energy = np.ones(round(7.0 / step))
    energy[round(2.0 / step):round(2.5 / step)] = 20.0
    energy[round(2.6 / step):round(3.0 / step)] = 20.0
    energy[round(5.0 / step):round(5.4 / step)] = 20.0
    found = intervals(recording, energy)
    assert np.array(found) == pytest.approx(np.array([[2.0, 3.0], [5.0, 5.4]]), abs=0.1)
