# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""How clearly a motion can show a lag of the force, whatever the check."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class LagEvidence(NamedTuple):
    """Chi-squared of what a lagged force leaves beside other explanations of it."""

    over_wall: float  # beside another stiffness, damping and location of the wall
    over_mass: float  # the same and a mass that moves with the wall


def lag_evidence(
    t: NDArray[np.float64], x: NDArray[np.float64], v: NDArray[np.float64],
    contact: NDArray[np.bool_], wall: tuple[float, float], lag_s: float, noise_std: float,
) -> LagEvidence:
    """
    Return the evidence of a lag in a motion, with all else of the wall unknown.

    No check that allows for another wall can do better: this one knows the noise, and tries one
    lag alone.

    t, x, v (N,): time [s], position [m] and rate [m/s]
    contact (N,): samples that count
    wall: True K_e [N/m] and B_e [N s/m]
    lag_s: of the force, positive if it comes late [s]
    noise_std: of the force [N]
    """
    late = np.interp(t - lag_s, t, x), np.interp(t - lag_s, t, v)
    force = (wall[0] * late[0] + wall[1] * late[1])[contact]
    explained = np.stack([x, v, np.ones(len(t)), np.gradient(v, t)], 1)[contact]
    return LagEvidence(*(
        _left(force, explained[:, :columns]) / noise_std**2 for columns in (3, 4)))


def _left(force: NDArray[np.float64], columns: NDArray[np.float64]) -> float:
    """Return the sum of squares that no combination of the columns explains."""
    columns = columns / (np.sqrt(np.mean(columns**2, axis=0)) + 1e-15)
    rest = force - columns @ np.linalg.lstsq(columns, force, rcond=None)[0]
    return float(rest @ rest)
