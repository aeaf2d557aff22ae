# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from math import nan

from contact_estimation.estimators.multiple_model import CONTACT, FREE
from contact_estimation.estimators.multiple_model.contact import ContactFilter
import numpy as np
import pytest
from wall_worlds import Array


def judged(contact_filter: ContactFilter, forces: Array, places: Array | None = None) -> list[int]:
    states = []
    places = np.full(len(forces), -1.0) if places is None else places
    for force, x in zip(forces.tolist(), places.tolist()):
        contact_filter.take((2e-3,), (force,), (x,), nan, nan)
        states.append(contact_filter.state)
    return states


def started(draw: np.random.Generator, noise: float = 0.5) -> ContactFilter:
    contact_filter = ContactFilter()
    contact_filter.start(noise * draw.standard_normal(20), True)
    judged(contact_filter, noise * draw.standard_normal(500))
    return contact_filter


@pytest.mark.parametrize('seed', [1, 5])
def test_a_pull_and_a_touch_after_it_are_judged_at_once_as_one_by_one(seed: int) -> None:
    k, found = np.arange(1500), []
    x = np.where(k < 1000, 1e-3 * np.sin(0.02 * k) - 0.02, 2e-5 * (k - 1000))
    pull = np.where(k < 200, 0.0, np.where(k < 1000, -8.0 - 6.0 * np.sin(0.05 * k), -8.0))
    force = pull + np.maximum(0.1 * (k - 1000), 0.0) + 0.5 * np.random.default_rng(
        seed).standard_normal(1500)
    for size in (1, 400):
        contact_filter, done, changes = ContactFilter(), 0, []
        contact_filter.start(force[:20], True)
        while done < 1500:
            part, before = slice(done, done + size), contact_filter.state
            done += contact_filter.take(
                [2e-3] * size, force[part].tolist(), x[part].tolist(), 0.0, 1e-3)
            if contact_filter.state != before:
                changes.append((done, contact_filter.state))
        found.append((changes, contact_filter.level))
    assert found[0] == found[1] and found[0][0][-1][1] == CONTACT


def test_noise_alone_is_no_contact() -> None:
    draw = np.random.default_rng(5)
    assert set(judged(started(draw), 0.5 * draw.standard_normal(100_000))) == {FREE}


def test_slow_touch_is_found_before_eight_deviations_and_never_early() -> None:
    for slope in [5.0, 20.0, 100.0]:
        for seed in range(5):
            draw = np.random.default_rng(seed)
            contact_filter = started(draw)
            ramp = np.maximum(np.arange(3000) * 2e-3 - 1.0, 0.0) * slope
            force = 0.5 * (ramp + draw.standard_normal(len(ramp)))
            states = np.array(judged(contact_filter, force, 1e-3 * ramp - 1.0))
            first = int(np.flatnonzero(states == CONTACT)[0])
            assert 0.0 < ramp[first] < 8.0, (slope, seed)
            assert not np.any(states[first:] == FREE), (slope, seed)
