# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Laws of the literature, made by name and run on given motion."""

from __future__ import annotations

from typing import Any

from contact_estimation.studies.foreign_laws import ALL_LAWS
from contact_estimation.studies.foreign_laws.law import Signals
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

DT = 1e-3  # [s]
STEP = np.concatenate((np.zeros(100), np.full(4000, 10.0)))  # of a force [N]


def law_of(name: str, **values: float) -> Any:
    """Make a law."""
    return ALL_LAWS[name](values)


def response(law: Any, d: Array, dt: float = DT) -> Array:
    """Return the force of a contact law along depths that all count as contact."""
    state, v = law.start(dt, len(d)), np.gradient(d, dt)
    forces = []
    for k, (depth, rate) in enumerate(zip(d.tolist(), v.tolist())):
        force, state = law.respond(k * dt, depth, rate, dt, state)
        forces.append(force)
    return np.array(forces)


def ramps(*depths: float, speed: float = 0.02) -> Array:
    """Return straight lines between depths at a speed."""
    parts = [np.linspace(a, b, max(2, round(abs(b - a) / speed / DT)), endpoint=False)
             for a, b in zip(depths[:-1], depths[1:])]
    return np.concatenate([*parts, depths[-1:]])


def signals(force: Array, a: Array | None = None) -> Signals:
    """Return signals with a force and an acceleration."""
    t: Array = DT * np.arange(len(force), dtype=float)
    still = np.zeros(len(force))
    return Signals(t, still, still, still if a is None else a, force)
