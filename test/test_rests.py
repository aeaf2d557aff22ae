# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Rests of a drive, at which its friction holds whatever force there is."""

from __future__ import annotations

from typing import Any

from concealed_worlds import diagnosed, nominal
from contact_estimation.diagnosis.observe.signals import Signals
from contact_estimation.diagnosis.report.json_report import as_dict
from contact_estimation.diagnosis.report.text_report import as_text
from contact_estimation.plant.plant_parameters import PlantParameters
import numpy as np
import pytest

T = np.asarray(0.01 * np.arange(3000), np.float64)
F_C, B_E = 2.0, 8.0
RESTS = ((0.0, 7.0, 1.9), (10.0, 15.5, -1.9), (18.5, 25.0, -1.8))
"""Begin, end [s] and the force to which the drive is loaded meanwhile [N]."""


def drive(pushed: float, stiffness: float = 0.0) -> tuple[Signals, PlantParameters]:
    """Move a drive to and fro between rests at which it is pushed against its friction."""
    resting = np.any([(T >= begin) & (T < end) for begin, end, _ in RESTS], axis=0)
    pause = np.cumsum(~resting) * 0.01
    v = np.where(resting, 0.0, 0.3 * np.sin(1.9 * pause) * np.minimum(1.0, pause))
    x = np.cumsum(v) * 0.01
    held = np.zeros(len(T))
    for begin, end, force in RESTS:
        held += force * pushed * ((T >= begin) & (T < end)) * (T - begin) / (end - begin)
    noise = 0.05 * np.random.default_rng(1).standard_normal(len(T))
    sliding = -F_C * np.sign(v) - B_E * v
    signal = np.asarray(np.where(resting, held, sliding) - stiffness * x + noise, np.float64)
    changes: dict[str, Any] = {'environment__unilateral': False, 'environment__damping': 10.0,
                               'environment__stiffness': stiffness}
    return Signals(T, signal, T, x, np.empty(0), np.empty((4, 0))), nominal(**changes)


def test_friction_is_named_though_it_holds_other_forces_at_rest() -> None:
    found = diagnosed(*drive(pushed=1.0))
    assert found.effects[0].family == 'friction' and found.rests_left_out
    # Samples beside the rests are smoothed across their edges, which costs a tenth of F_c.
    assert found.effects[0].parameters['F_c'].value == pytest.approx(F_C, rel=0.15)
    assert 'Where the drive stands still was left out' in as_text(found)
    assert as_dict(found)['fit']['rests_left_out'] is True
