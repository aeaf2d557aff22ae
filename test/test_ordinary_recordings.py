# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Ordinary recordings: slow, paused, in other units, at several places."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

from concealed_worlds import diagnosed, named, nominal, prepared_from, recorded
from contact_estimation.diagnosis.fit.surfaces import Surfaces, surfaces_of
from contact_estimation.diagnosis.observe.observed import observe
from contact_estimation.diagnosis.observe.parts import continuous_parts
from contact_estimation.diagnosis.observe.signals import Recording, Signals
from contact_estimation.diagnosis.result import Diagnosis
from contact_estimation.plant.plant_parameters import PlantParameters
import diagnosed_worlds as touches
import numpy as np
from numpy.typing import NDArray
import pytest

Array = NDArray[np.float64]
NO_REFERENCE = (np.empty(0), np.empty((4, 0)))


def attached(**wall: float) -> PlantParameters:
    """Describe a permanently attached specimen."""
    parameters: dict[str, Any] = {f'environment__{name}': value for name, value in wall.items()}
    return nominal(environment__unilateral=False, **parameters)


def signals_of(t: Array, force: Array, x: Array) -> Signals:
    """Sample force and position of a specimen together."""
    return Signals(t, force, t, x, *NO_REFERENCE)


def relaxing(t: Array, x: Array, K: float, K_1: float, tau: float) -> Array:
    """Compute the force of a standard linear solid, v constant between samples."""
    branch, share = np.zeros(len(t)), np.exp(-(t[1] - t[0]) / tau)
    gain = K_1 * tau / (t[1] - t[0]) * (1.0 - share)
    for k in range(1, len(t)):
        branch[k] = share * branch[k - 1] + gain * (x[k] - x[k - 1])
    return -K * x - branch


def test_a_pause_of_all_topics_makes_two_parts() -> None:
    s = touches.recorded()
    kept = (s.wrench_t < 2.0) | (s.wrench_t > 4.2)
    t = s.wrench_t[kept]
    cut = Signals(t, s.force[kept], t, s.position[kept], t, s.reference[:, kept])
    parts = continuous_parts(Recording('file', cut), touches.nominal())
    assert [one.name for one in parts] == ['file, 0.0 to 2.0 s', 'file, 4.2 to 6.7 s']
    assert observe(parts[1].signals, touches.nominal()).t[0] == parts[1].signals.wrench_t[0] > 4.0


@pytest.mark.slow
def test_relaxation_of_minutes_is_named_at_1_hz() -> None:
    t = np.arange(1800.0)
    x = np.interp(t, (30.0, 40.0, 1200.0, 1230.0), (0.0, 1e-3, 1e-3, 5e-4))
    noise = np.random.default_rng(1).normal(size=(2, len(t)))
    force = relaxing(t, x, 5000.0, 4000.0, 200.0) + 0.01 * noise[0]
    found = diagnosed(signals_of(t, force, x + 5e-7 * noise[1]),
                      attached(stiffness=6000.0, damping=1000.0))
    assert named(found) == ['viscoelastic_relaxation']
    assert found.effects[0].parameters['tau'].value == pytest.approx(200.0, rel=0.05)


@pytest.mark.slow
def test_creep_of_a_sensor_is_named_though_relaxation_would_need_a_force_that_decays() -> None:
    t = np.arange(0.0, 200.0, 0.5)
    x = np.interp(t, (5.0, 7.0, 50.0, 52.0, 90.0, 92.0, 150.0, 152.0),
                  (0.0, 4e-3, 4e-3, 8e-3, 8e-3, 2.8e-3, 2.8e-3, 0.0))
    noise = np.random.default_rng(4).normal(size=(2, len(t)))
    # tau y' + y = F_e, F_e straight between samples; the sensor adds a share of y
    y = relaxing(t, x, 0.0, -50.0, 4.0) - 50.0 * x
    found = diagnosed(signals_of(t, -50.0 * x + 0.17 * y + 2e-3 * noise[0], x + 4e-7 * noise[1]),
                      attached(stiffness=50.0, damping=1.5))
    assert named(found) == ['force_creep']
    assert found.effects[0].parameters['tau'].value == pytest.approx(4.0, rel=0.1)


APART = (1e-3, -1.3e-3, 0.2e-3)
TURNS = ((2.85, 3.2), (5.0, 5.35))
"""Between the contacts, while the tool is away."""


def shift_of(t: Array, places: tuple[float, ...]) -> Array:
    """Return the place of the object: it is moved by a smooth step between two contacts."""
    shift = np.full(len(t), places[0])
    for before, after, (begin, end) in zip(places, places[1:], TURNS):
        shift += (after - before) * 0.5 * (1.0 + np.tanh(
            (t - 0.5 * (begin + end)) / (0.1 * (end - begin))))
    return shift


def moved(places: tuple[float, ...], **changes: Any) -> Signals:
    """Touch an object that lies at another place in each contact, where the robot follows it."""
    s = recorded(**changes)
    reference, t, h = s.reference.copy(), s.reference_t, 1e-4
    before, now, after = (shift_of(t + by, places) for by in (-h, 0.0, h))
    reference[0] += now
    reference[1] += (after - before) / (2.0 * h)
    reference[2] += (after - 2.0 * now + before) / h**2
    return s._replace(
        position=s.position + shift_of(s.joint_t, places), reference=reference)


def surfaces(signals: Signals) -> Surfaces:
    """Measure the surfaces of a recording."""
    return surfaces_of([prepared_from(signals)[0]])


@lru_cache(maxsize=None)
def of_moved(*changes: tuple[str, float]) -> Diagnosis:
    """Diagnose a world whose object is moved."""
    return diagnosed(moved(APART, **dict(changes)))


def test_each_contact_tells_its_place_and_all_together_the_wall() -> None:
    found = surfaces(moved(APART))
    assert found.are_apart
    assert found.fitted == pytest.approx(APART, abs=3e-5)
    assert found.touched == pytest.approx(APART, abs=found.blur)
    assert found.stiffness == pytest.approx(5000.0, rel=2e-3)
    assert found.damping == pytest.approx(120.0, rel=0.02)


@pytest.mark.slow
def test_an_object_that_is_moved_is_told_and_its_wall_found() -> None:
    found = of_moved()
    assert found.verdict == 'recalibrate' and not found.effects
    assert found.recalibrated.stiffness == pytest.approx(5000.0, rel=3e-3)
    check, = (one for one in found.checks if one.name == 'wall_location')
    assert not check.ok and not check.fatal
    assert 'in 3 contacts, expected at one place' in check.text
