# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The noise floor of the force with everything slow that a sensor adds."""

from __future__ import annotations

from typing import Any

from concealed_worlds import FORCE_NOISE, nominal, physics, POSITION_NOISE, QUANTUM, recorded
from contact_estimation.diagnosis.observe.model import Model
from contact_estimation.diagnosis.observe.noise import force_noise
from contact_estimation.diagnosis.observe.observed import observe
from contact_estimation.diagnosis.observe.signals import Signals
import numpy as np
import pytest


def noise_of(signals: Signals, **changes: Any) -> float:
    """Estimate the noise floor of a recording."""
    model = Model.of(nominal(**changes))
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
    assert noise_of(recorded(**changes)) == pytest.approx(FORCE_NOISE, rel=0.1)


def test_noise_floor_without_free_flight_comes_from_the_spectrum() -> None:
    signals = recorded()
    touching = (signals.wrench_t > 1.0) & (signals.wrench_t < 2.45)
    t = signals.wrench_t[touching] - signals.wrench_t[touching][0]
    three = [np.tile(row[touching], 3) for row in (signals.force, signals.position)]
    t_three = np.arange(3 * len(t)) * (t[1] - t[0])
    pressed = Signals(t_three, three[0], t_three, three[1], np.empty(0), np.empty((4, 0)))
    assert noise_of(pressed) == pytest.approx(FORCE_NOISE, rel=0.15)


@pytest.mark.slow
def test_position_noise_is_known_to_a_tenth() -> None:
    expected = np.sqrt(POSITION_NOISE**2 + QUANTUM**2 / 12.0)
    seen = [observe(recorded(seed=seed), nominal()).position_noise for seed in (1, 2, 3)]
    assert np.mean(seen) == pytest.approx(expected, rel=0.1)
