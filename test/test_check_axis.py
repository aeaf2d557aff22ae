# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Tests that a strongly nonlinear contact is no other axis of the sensor."""

from contact_estimation.diagnosis.checks.evidence import Evidence
from contact_estimation.diagnosis.checks.signs_and_axes import axis
from contact_estimation.diagnosis.observe.signals import Signals
from contact_estimation.plant.plant_parameters import PlantParameters, WallParameters
import numpy as np
from numpy.typing import NDArray

T = np.arange(0.0, 40.0, 0.02)
DEPTH = 4e-3 * (1.0 - np.abs(T - 20.0) / 20.0)  # pressed and released once
MODEL = PlantParameters(environment=WallParameters(stiffness=250.0, damping=0.0))


def found_with(force: NDArray[np.float64]) -> bool:
    """Return whether the axis is accepted."""
    noise = 1e-3 * np.random.default_rng(5).standard_normal(len(T))
    signals = Signals(T, -force + noise, T, DEPTH, np.empty(0), np.empty((4, 0)))
    return axis(Evidence(signals, MODEL)).ok


def test_a_dome_that_buckles_is_accepted() -> None:
    bottom = 60.0 * np.maximum(DEPTH - 3.8e-3, 0.0) / 4e-3
    dome = np.sin(4.0 * np.pi * DEPTH / 4e-3) + bottom
    assert abs(np.corrcoef(dome, DEPTH)[0, 1]) < 0.2
    assert found_with(0.1 * dome)


def test_a_force_that_differs_on_the_way_out_is_refused() -> None:
    wanders = np.sin(2.0 * np.pi * (T - 20.0) / 10.0)
    assert abs(np.corrcoef(wanders, DEPTH)[0, 1]) < 0.2
    assert not found_with(wanders)
