# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Contacts at different places are told as such, and what they hide is found all the same."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

from concealed_worlds import diagnosed, prepared_from, recorded
from contact_estimation.diagnosis.conclude.result import Diagnosis
from contact_estimation.diagnosis.fit.surfaces import Surfaces, surfaces_of
from contact_estimation.diagnosis.observe.signals import Signals
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


def test_an_object_that_is_moved_is_told_and_its_wall_found() -> None:
    found = of_moved()
    assert found.verdict == 'recalibrate' and not found.effects
    assert found.recalibrated.stiffness == pytest.approx(5000.0, rel=3e-3)
    check, = (one for one in found.checks if one.name == 'wall_location')
    assert not check.ok and not check.fatal
    assert 'in 3 contacts, expected at one place' in check.text
