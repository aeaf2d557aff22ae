# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Contacts at different places are told as such, and what they hide is found all the same."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

from concealed_worlds import diagnosed, named, nominal, physics, prepared_from, recorded
from contact_estimation.diagnosis.conclude.diagnose import diagnose
from contact_estimation.diagnosis.conclude.result import Diagnosis
from contact_estimation.diagnosis.fit.surfaces import (
    Contact,
    on_one_surface,
    Surfaces,
    surfaces_of,
)
from contact_estimation.diagnosis.observe.signals import Recording, Signals
import numpy as np
from numpy.typing import NDArray
import pytest

Array = NDArray[np.float64]

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


@pytest.mark.parametrize('changes', [
    {}, physics('coulomb_friction', 3.0), physics('plastic_set', 0.1),
    physics('moving_environment', 0.002, 0.3, 0.0), physics('viscous_flow', 0.002),
    physics('stiffness_drift', -0.03)])
def test_contacts_of_one_place_are_not_apart(changes: dict[str, Any]) -> None:
    assert not surfaces(recorded(**changes)).are_apart


def test_a_cable_that_pushes_in_free_flight_is_no_surface() -> None:
    s = recorded()
    pushing = (s.wrench_t > 2.8) & (s.wrench_t < 3.1)
    pushed = surfaces(s._replace(force=s.force - 8.0 * pushing))
    assert len(pushed.fitted) == 3 and not pushed.are_apart


def test_an_object_that_is_moved_is_told_and_its_wall_found() -> None:
    found = of_moved()
    assert found.verdict == 'recalibrate' and not found.effects
    assert found.recalibrated.stiffness == pytest.approx(5000.0, rel=3e-3)
    check, = (one for one in found.checks if one.name == 'wall_location')
    assert not check.ok and not check.fatal
    assert 'in 3 contacts, expected at one place' in check.text


def test_what_a_moved_object_hides_is_named() -> None:
    found = of_moved(('physics__coulomb_friction__F_c', 3.0))
    assert named(found) == ['coulomb_friction']
    assert found.effects[0].parameters['F_c'].value == pytest.approx(3.0, rel=0.02)


def test_recordings_of_different_places_are_diagnosed_together() -> None:
    parts = [Recording(str(k), moved((place,), **physics('coulomb_friction', 3.0)))
             for k, place in enumerate((0.0, 2e-3))]
    found = diagnose(parts, nominal())
    assert named(found) == ['coulomb_friction']
    assert 'in 6 contacts' in ' '.join(one.text for one in found.checks if not one.ok)


def test_objects_of_different_stiffness_are_told() -> None:
    parts = [Recording(str(K_e), recorded(environment__stiffness=K_e)) for K_e in (5e3, 8e3)]
    found = diagnose(parts, nominal())
    assert found.verdict == 'unexplained' and not found.effects
    springs = surfaces_of([prepared_from(one.signals)[0] for one in parts]).springs
    assert springs == pytest.approx(3 * [5e3] + 3 * [8e3], rel=0.05)
    assert found.next_experiment.startswith(
        f'Each contact fits a spring and a damper of its own, with K_e = {springs[0]:.4g}, ')


def test_position_and_reference_are_moved_alike_and_only_away_from_the_surface() -> None:
    s = moved(APART)
    found = surfaces(s)
    one = on_one_surface(s, found.contacts, found.fitted.tolist(), 0.0)
    at_joints = np.interp(s.joint_t, s.reference_t, one.reference[0] - s.reference[0])
    assert one.position - s.position == pytest.approx(at_joints, abs=5e-5)
    rate = np.gradient(one.reference[0] - s.reference[0], s.reference_t)
    assert one.reference[1] - s.reference[1] == pytest.approx(rate, abs=2e-3)
    shift = one.position - s.position
    for contact, place in zip(found.contacts, found.fitted):
        touching = (s.joint_t >= contact.begin) & (s.joint_t <= contact.end)
        np.testing.assert_allclose(shift[touching], -place, atol=1e-12)
    changing = np.abs(np.gradient(shift)) > 1e-9
    assert np.max(one.position[changing]) < 2e-3


def test_signals_without_a_contact_stay() -> None:
    s = recorded()
    assert on_one_surface(s, (), (), 0.0) is s
    contact = Contact(0, 1.0, 2.0)
    np.testing.assert_allclose(
        on_one_surface(s, (contact,), (1e-3,), 0.0).position, s.position - 1e-3)
