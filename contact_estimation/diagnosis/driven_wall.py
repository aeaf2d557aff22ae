# Copyright 2026 contact_estimation authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""A permanently attached wall that moves under the measured force."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .model import Model
from .observed import Observed
from .observer import discretise, run, run_velocity

Array = NDArray[np.float64]

_ENOUGH = 1e-9  # of the largest position: Picard's iteration has converged


def driven_wall(model: Model, observed: Observed, rounds: int) -> Array:
    """
    Solve M_e x'' + B_e v + K_e delta = -F_e - effects, F_e straight between samples.

    The linear part is solved exactly. What the effects add is taken at the measured motion, then,
    `rounds` times, at the motion just predicted (Picard's iteration), which makes it a free run.
    What the sensor adds is taken off the reading, to first order.

    Parameters
    ----------
    model : Model
        With M_e > 0.
    observed : Observed
        Measured force and motion.
    rounds : int
        1 leaves the effects at the measured motion.

    Returns
    -------
    x : ndarray, shape (N,)
        Position [m].

    """
    laws, o = model.laws(), observed
    M, B, K = laws.contact.inertia, model.damping, model.stiffness
    sensed = o.force
    for effect in laws.chain:
        sensed = 2.0 * sensed - effect.sense_along(o.t, sensed, o.a)
    system, start = discretise(M, B, K, o.h), float(o.x[0])
    x, v, a = o.x, o.v, o.a
    for _ in range(rounds if laws.contact.effects else 1):
        extra = -laws.contact.force(o.t, x, v, a) - (M * a + B * v + K * x)
        push = -sensed - extra
        before, x = x, run(system, push, start, K)
        if rounds > 1:
            v = run_velocity(system, push, start, K)
            a = (push - B * v - K * x) / M
            if float(np.max(np.abs(x - before))) < _ENOUGH * float(np.max(np.abs(x))):
                break
    return x
