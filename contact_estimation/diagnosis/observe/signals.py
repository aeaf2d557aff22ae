# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""A recording and its signals, each with stamps of its own."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...exceptions import RecordingError
from ...recordings.free_flight import Tare
from ...recordings.recorded_signals import RecordedSignals

Array = NDArray[np.float64]

LEAST_SAMPLES = 50
_ABSURD = 1e30  # in any unit


class Signals(NamedTuple):
    """
    The content of a recording; times are counted from the first wrench [s].

    Attributes
    ----------
    wrench_t, force : ndarray, shape (N,)
        Measured F_e [N].
    joint_t, position : ndarray, shape (J,)
        x [m].
    reference_t : ndarray, shape (R,)
        Empty without a reference trajectory.
    reference : ndarray, shape (4, R)
        x_r [m], its rate [m/s] and acceleration [m/s^2], F_r [N]; no NaN.

    """

    wrench_t: Array
    force: Array
    joint_t: Array
    position: Array
    reference_t: Array
    reference: Array


@dataclass(frozen=True, eq=False)
class Recording:
    """
    A recording to be diagnosed.

    Attributes
    ----------
    name : str
        For texts.
    signals : Signals
        As recorded.
    stamps_back_s : float
        By how much a stamp lay before that of an earlier message, at most [s].
    damage : str
        What of the file could not be read; '' if all was.
    rests_count : bool
        Whether the stretches count in which a drive is held at rest.
    tare : Tare or None
        What was subtracted from the force.

    """

    name: str
    signals: Signals
    stamps_back_s: float = 0.0
    damage: str = ''
    rests_count: bool = True
    tare: Tare | None = None


def signals_of(recorded: RecordedSignals) -> Signals:
    """Convert recorded stamps to seconds from the first wrench."""
    start = int(recorded.wrench.stamp_ns[0])

    def seconds(stamps: NDArray[np.int64]) -> Array:
        return np.asarray((stamps - start) * 1e-9, np.float64)

    wrench, joints = recorded.wrench, recorded.joint_states
    reference = recorded.reference_trajectory
    return Signals(
        seconds(wrench.stamp_ns), wrench.values[0], seconds(joints.stamp_ns), joints.values[0],
        seconds(reference.stamp_ns), reference.values,
    )


def without_reference(recording: Recording) -> Recording:
    """Return a recording of which the contact alone is diagnosed, whatever moves the tip."""
    return replace(recording, signals=recording.signals._replace(
        reference_t=np.zeros(0), reference=np.zeros((4, 0))))


def check_signals(signals: Signals) -> None:
    """Check that the signals have enough samples, are finite and not constant."""
    for name, stamps in (('wrench', signals.wrench_t), ('joint_states', signals.joint_t)):
        if len(stamps) < LEAST_SAMPLES:
            raise RecordingError(
                f'{name} has {len(stamps)} samples, expected at least {LEAST_SAMPLES} with '
                'different stamps; stamp every header, record longer or at a higher rate, or take '
                'the time of reception with --stamps received'
            )
    for name, values in (
        ('wrench', signals.force), ('joint_states', signals.position),
        ('reference_trajectory', signals.reference),
    ):
        if not np.isfinite(values).all():
            raise RecordingError(
                f'{name} must have finite values only, got NaN or infinity; remove these samples'
            )
        absurd = np.count_nonzero(np.abs(values) > _ABSURD)
        if absurd:
            raise RecordingError(
                f'{name} must have possible values only, got {absurd} beyond {_ABSURD:g}; remove '
                'these samples'
            )
    for name, values in (('wrench', signals.force), ('joint_states', signals.position)):
        if float(np.ptp(values)) == 0.0:
            raise RecordingError(
                f'{name} is constant at {values[0]:g}, expected a signal that changes; check '
                'topic, axis and joint; under a constant load record the measured force, not the '
                'command, and the loading'
            )
