# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""What a diagnosis observes: clocks, noise and residuals."""

from functools import lru_cache
from math import floor, pi
import re
from typing import Any

from concealed_worlds import (
    FORCE_NOISE, nominal as nominal_wall, physics, prepared_from, recorded as recording_of,
    recorded as of_wall)
from contact_estimation.diagnosis.dependence import Dependence, dependences
from contact_estimation.diagnosis.diagnose import diagnose
from contact_estimation.diagnosis.fit.discrepancy import (
    correlation_time, discounted, material, std_beyond_noise, with_discrepancy)
from contact_estimation.diagnosis.fit.fitting import fit
from contact_estimation.diagnosis.location import guess_port, intervals
from contact_estimation.diagnosis.observe.channel import Channel, force_noise
from contact_estimation.diagnosis.observe.model import Model
from contact_estimation.diagnosis.observe.observed import observe
from contact_estimation.diagnosis.observe.prepared_recording import PreparedRecording
from contact_estimation.diagnosis.observe.residuals import force_residual
from contact_estimation.diagnosis.observe.signals import Recording, Signals
from contact_estimation.diagnosis.observe.smoothing import differentiate, smooth, white_noise_std
from contact_estimation.diagnosis.report.text_report import as_text
from contact_estimation.plant.simulation import run_open_loop
from diagnosed_worlds import INTEGRATION_HZ, nominal, RATE_HZ, recorded, TWO_TOUCHES, world
import numpy as np
from numpy.typing import NDArray
import pytest


def early(seconds: float, **changes: Any) -> tuple[Any, dict[str, str]]:
    """Diagnose a recording whose wrenches are stamped early; return what checks say, too."""
    signals = recorded(**changes)
    found = diagnose(Recording('early.mcap', signals._replace(
        joint_t=signals.joint_t + seconds, reference_t=signals.reference_t + seconds)), nominal())
    return found, {check.name: check.text for check in found.checks if not check.ok}


@pytest.mark.slow
def test_stamps_before_the_event_are_no_mass_and_no_memory() -> None:
    found, failed = early(0.004)
    assert (list(failed), found.effects, found.verdict) == (['clock_offset'], [], 'unexplained')
    assert 'wrench is stamped early' in failed['clock_offset']
    remedy = re.search(r'set synchronisation.offset to (-?[\d.]+) s', failed['clock_offset'])
    assert remedy and float(remedy[1]) == pytest.approx(-0.004, rel=0.1)


@pytest.mark.slow
def test_friction_is_named_though_stamps_are_before_the_event() -> None:
    found, failed = early(0.004, **physics('coulomb_friction', 3.0))
    assert list(failed) == ['clock_offset'] and not found.refused
    effect, = found.effects
    assert effect.family == 'friction'
    assert found.stiffness.value == pytest.approx(nominal().environment.stiffness, rel=0.1)


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
    ('robot_friction', 'motion', 'its own past')])
def test_residual_depends_on_the_quantity_of_the_missing_law(
    name: str, channel: str, on: str
) -> None:
    found = found_in(name, channel)
    assert found[on].is_real
    others = [one.share for key, one in found.items() if key != 'its own past']
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


def noise_of(signals: Signals, **changes: Any) -> float:
    """Estimate the noise floor of a recording."""
    model = Model.of(nominal_wall(**changes))
    return force_noise(model, observe(signals, model.nominal))


@pytest.mark.slow
@pytest.mark.parametrize('changes', [
    {},
    physics('force_bias', 2.0),
    physics('force_drift', 0.3),
    physics('tool_inertia', 1.0),
    {**physics('force_bias', -5.0), **physics('force_drift', 1.0),
     **physics('tool_inertia', 1.0)},
], ids=['plain', 'bias', 'drift', 'tool', 'all'])
def test_noise_floor_is_that_of_the_sensor(changes: dict[str, Any]) -> None:
    assert noise_of(recording_of(**changes)) == pytest.approx(FORCE_NOISE, rel=0.1)


Array = NDArray[np.float64]

H = 0.004
T = H * np.arange(2000)


def wave(frequency: float) -> Array:
    """Give a sine of 5 mm."""
    return np.asarray(5e-3 * np.sin(2.0 * pi * frequency * T))


@pytest.mark.parametrize('std, quantum', [(3e-6, 0.0), (3e-6, 1e-6), (1e-6, 3e-6)])
def test_noise_std_is_known_under_a_slow_signal(std: float, quantum: float) -> None:
    generator = np.random.default_rng(1)
    signal = wave(3.0) + std * generator.standard_normal(len(T))
    if quantum > 0.0:
        signal = np.round(signal / quantum) * quantum
    # What rounding adds is white and even over a step (Widrow 1956).
    expected = np.sqrt(std**2 + quantum**2 / 12.0)
    assert white_noise_std(signal) == pytest.approx(expected, rel=0.1)


def test_smoothing_solves_the_normal_equations() -> None:
    generator = np.random.default_rng(5)
    signal, weight = generator.standard_normal(40), generator.uniform(0.1, 1.0, 40)
    third = np.diff(np.eye(40), 3, axis=0)
    matrix = np.diag(weight) + (2.0 * pi * 0.1) ** -6 * third.T @ third
    expected = np.linalg.solve(matrix, weight * signal)
    np.testing.assert_allclose(smooth(signal, weight, 0.1), expected, atol=1e-9)


def test_derivatives_are_those_of_a_sine() -> None:
    omega = 2.0 * pi * 3.0
    got = differentiate(np.sin(omega * T), H)
    inner = slice(2, -2)
    # Errors of fourth order: (w h)^4 / 30 and (w h)^4 / 90.
    np.testing.assert_allclose(got.rate[inner], omega * np.cos(omega * T)[inner],
                               atol=1.1 * omega * (omega * H) ** 4 / 30.0)
    np.testing.assert_allclose(got.acceleration[inner], -omega**2 * np.sin(omega * T)[inner],
                               atol=1.1 * omega**2 * (omega * H) ** 4 / 90.0)


COUNT, NOISE, UNKNOWN = 24_000, 0.02, 0.5


def channel(spread: NDArray[np.float64], block: int, discrepancy: float = 0.0) -> Channel:
    """Make a channel of which a tenth of the samples do not count."""
    use = np.random.default_rng(2).random(COUNT) > 0.1
    return Channel(NOISE, spread, use, block, discrepancy)


def errors(spread: NDArray[np.float64], block: int, unknown: float) -> NDArray[np.float64]:
    """Draw noise, and a discrepancy that is the same throughout a block."""
    rng = np.random.default_rng(1)
    same = np.repeat(rng.normal(size=COUNT // block), block)
    return NOISE * spread * rng.normal(size=COUNT) + unknown * same


@pytest.mark.parametrize('block', [1, 8])
@pytest.mark.parametrize('widest', [1.0, 150.0])
def test_discrepancy_is_found_beside_noise_of_any_spread(block: int, widest: float) -> None:
    spread = np.repeat(np.geomspace(1.0, widest, COUNT // block), block)
    plain = channel(spread, block)
    assert std_beyond_noise(
        plain.average(errors(spread, block, UNKNOWN)), plain) == pytest.approx(UNKNOWN, rel=0.06)
    assert std_beyond_noise(plain.average(errors(spread, block, 0.0)), plain) < 0.3 * NOISE


def test_exact_model_leaves_no_discrepancy_worth_a_name() -> None:
    recording, model = prepared_from(recording_of())
    assert not material([with_discrepancy(recording, model)], model)


def test_correlation_time_is_that_of_an_autoregressive_process() -> None:
    rng, phi = np.random.default_rng(3), 0.8
    values = np.zeros(20_000)
    for k, push in enumerate(rng.normal(size=len(values) - 1)):
        values[k + 1] = phi * values[k] + push
    assert correlation_time(values) == pytest.approx((1.0 + phi) / (1.0 - phi), rel=0.15)
    assert correlation_time(rng.normal(size=5000)) == pytest.approx(1.0, abs=0.15)
