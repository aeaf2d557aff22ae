# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Where the diagnosis says that a mismatch sits."""

from __future__ import annotations

from concealed_worlds import physics, prepared_from, recorded
from contact_estimation.diagnosis.conclude.location import guess_port, intervals, locate
from contact_estimation.diagnosis.fit.fitting import fit
from contact_estimation.diagnosis.fit.model_uncertainty import discounted
from contact_estimation.diagnosis.observe.model import Model
from contact_estimation.diagnosis.observe.prepared_recording import PreparedRecording
from contact_estimation.diagnosis.observe.signals import Signals
import numpy as np
import pytest

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


def recalibrated(signals: Signals) -> tuple[PreparedRecording, Model]:
    """Fit stiffness and damping alone."""
    recording, model = prepared_from(signals)
    recording = discounted(recording, model)
    return recording, fit([recording], model).model


@pytest.mark.slow
def test_port_of_an_effect_is_guessed_from_its_residuals() -> None:
    for name, values, expected in WORLDS:
        recording, model = recalibrated(recorded(**physics(name, *values)))
        assert guess_port(recording, model) == expected, (name, values, expected)


@pytest.mark.slow
def test_resonance_is_located_around_its_frequency() -> None:
    place = locate(*recalibrated(recorded(**physics('environment_resonance', 0.4, 9.0, 0.05))))
    assert place.port == 'contact'
    assert place.band_hz[0] < 9.0 < place.band_hz[1] < 12.0


def test_intervals_are_where_the_energy_is() -> None:
    recording, _ = prepared_from(recorded())
    step = recording.observed.h * recording.block
    energy = np.ones(round(7.0 / step))
    energy[round(2.0 / step):round(2.5 / step)] = 20.0
    energy[round(2.6 / step):round(3.0 / step)] = 20.0
    energy[round(5.0 / step):round(5.4 / step)] = 20.0
    found = intervals(recording, energy)
    assert np.array(found) == pytest.approx(np.array([[2.0, 3.0], [5.0, 5.4]]), abs=0.1)
