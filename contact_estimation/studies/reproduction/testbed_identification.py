# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Identification of the arm's actual impedance from a step in free flight."""

from __future__ import annotations

import numpy as np

from .testbed_runs import ArmRecording, record_testbed
from .testbed_sensors import RawAcquisition
from ...estimators.offline_estimator import TargetImpedance
from ...estimators.signal_processing_refined import SignalProcessingRefined
from ...reference.setpoints import Reference
from ...signals.contact_sample import ContactRecording

FREE_STEP = 0.015
"""
Step of x_r in free flight [m]; the tip reaches 0.1 m/s, as after the step in contact.

Dry friction of the joints acts as damping that depends on the speed, so that the identified B_t
holds in contact only at similar speeds.
"""

_START, _STEP_AT_S, _RUN_S = -0.10, 0.5, 4.5
_UNIT = TargetImpedance(1.0, 0.0, 0.0)


def identify_arm(target: TargetImpedance, seed: int) -> TargetImpedance:
    """
    Identify the impedance from the decay after a step in free flight.

    The step gives w_n and zeta of M xdd + B xd + K (x - x_r) = 0. The scale follows from
    K_t, which the controller realises exactly: at rest neither inertia nor damping acts.
    """
    recording = _free_step(target, seed)
    contact = recording.contact
    # The tip position replaces the force, in mm: with M = 1, B = K = 0 eqs. (17) and (18) give
    # w_n^2 and 2 zeta w_n.
    moved = ContactRecording(
        contact.stamp_ns, contact.position, contact.velocity,
        -1e3 * np.asarray(recording.tip - recording.tip[0]),
    )
    fit = SignalProcessingRefined(_UNIT).estimate(moved)
    mass = target.stiffness / fit.stiffness
    return TargetImpedance(float(mass), float(mass * fit.damping), target.stiffness)


def _free_step(target: TargetImpedance, seed: int) -> ArmRecording:
    def step(t: float) -> Reference:
        return Reference(_START + (FREE_STEP if t >= _STEP_AT_S else 0.0), 0.0, 0.0, 0.0)

    return record_testbed(target, step, _START, _RUN_S, RawAcquisition(), seed)
