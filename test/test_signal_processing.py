# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Signal processing as written shows the paper's errors; refined, it does not."""

from __future__ import annotations

from functools import lru_cache
from math import pi, sqrt

from contact_estimation.estimators import OFFLINE_ESTIMATORS
from contact_estimation.estimators.offline_estimator import OfflineEstimate, TargetImpedance
from contact_estimation.estimators.signal_processing import (
    damping_ratio, dominant_frequency, environment_of, settling_time)
from contact_estimation.exceptions import EstimationError
from contact_estimation.signals.contact_sample import ContactRecording
from contact_estimation.studies.reproduction.case import B_E, K_E
from contact_estimation.studies.reproduction.simulation_cases import step_recording
import numpy as np
import pytest

TARGET = TargetImpedance()
recorded = lru_cache(maxsize=None)(step_recording)


def response(w_d: float, decay: float, offset: float = 0.0, count: int = 2000) -> ContactRecording:
    """Make the force of a step response at 500 Hz, after 0.2 s of rest."""
    t = 0.002 * np.arange(count)
    ring = np.exp(-decay * t) * (np.cos(w_d * t) + decay / w_d * np.sin(w_d * t))
    force = np.concatenate([np.zeros(100), 50.0 * (1.0 - ring)]) + offset
    stamps = np.arange(len(force), dtype=np.int64) * 2_000_000
    return ContactRecording(stamps, np.zeros(len(force)), np.zeros(len(force)), -force)


def estimate(name: str, recording: ContactRecording) -> OfflineEstimate:
    """Run one of the methods with the paper's target impedance."""
    return OFFLINE_ESTIMATORS[name](TARGET).estimate(recording)


def test_one_and_a_half_cycles_mean_the_printed_damping_ratio() -> None:
    assert damping_ratio(1.5) == pytest.approx(0.303, abs=5e-4)


@pytest.mark.parametrize('zeta', [0.1, 0.3, 0.7])
def test_damping_ratio_inverts_the_settling_of_an_envelope(zeta: float) -> None:
    settling = 2.996 / zeta  # eq. (9), with w_n = 1
    cycles = settling * sqrt(1.0 - zeta**2) / (2.0 * pi)
    assert damping_ratio(cycles) == pytest.approx(zeta, rel=1e-9)


def test_environment_is_what_the_robot_leaves_of_the_joint_impedance() -> None:
    mass, damping, stiffness = 20.0, 50.0 + 200.0, 2000.0 + 4800.0
    w_n = sqrt(stiffness / mass)
    zeta = damping / (2.0 * sqrt(stiffness * mass))
    assert environment_of(w_n, zeta, TARGET) == pytest.approx((4800.0, 200.0))


def test_frequency_is_tied_to_a_bin_of_1024_points() -> None:
    t = np.linspace(0.0, 2.998, 1500)
    w_d = dominant_frequency(t, np.sin(2.0 * pi * 2.76 * t) + 50.0)
    assert w_d / (2.0 * pi) == pytest.approx(6 * 500.0 / 1024)


def test_settling_time_is_the_last_instant_outside_five_percent() -> None:
    t = np.linspace(0.0, 3.998, 2000)
    force = 50.0 + np.where(t <= 1.0, 2.6, 0.0)
    assert settling_time(t, force) == pytest.approx(1.0)


@pytest.mark.slow
def test_as_written_it_shows_the_paper_s_stiffness_error() -> None:
    errors = [100.0 * (estimate('signal_processing', recorded(s)).stiffness / K_E - 1.0)
              for s in range(3)]
    assert all(12.0 < error < 15.0 for error in errors)


@pytest.mark.slow
@pytest.mark.parametrize('seed', range(3))
def test_refined_it_is_within_three_standard_deviations(seed: int) -> None:
    found = estimate('signal_processing_refined', recorded(seed))
    assert abs(found.stiffness - K_E) < min(3.0 * found.stiffness_std, 0.015 * K_E)
    assert abs(found.damping - B_E) < min(3.0 * found.damping_std, 0.03 * B_E)


@pytest.mark.parametrize('offset', [0.0, 5.0, -5.0])
def test_refined_it_is_exact_without_noise_whatever_the_offset(offset: float) -> None:
    w_d, decay = 17.1, 6.25
    found = estimate('signal_processing_refined', response(w_d, decay, offset))
    assert found.stiffness == pytest.approx(20.0 * (w_d**2 + decay**2) - 2000.0, rel=1e-4)
    assert found.damping == pytest.approx(40.0 * decay - 50.0, rel=1e-4)


@pytest.mark.parametrize('name', OFFLINE_ESTIMATORS)
def test_short_recording_is_refused(name: str) -> None:
    with pytest.raises(EstimationError, match='needs 1024 samples after a step of the force'):
        estimate(name, response(17.1, 6.25, count=800))
