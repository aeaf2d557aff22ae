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

"""
The last refinement: output error of the free run.

The ports take the measured motion for true, which costs a little accuracy where the motion is
sharpest. Run free from its command, the model needs no measured motion; its errors against
measured position and force are noise when the values are right (Ljung 1999, section 3.3).
"""

from __future__ import annotations

from typing import Sequence

import numpy as np
from numpy.typing import NDArray

from .fitting import Fit, fit
from .free_run import free_run
from .model import Model
from .ports import huber, Ports

Array = NDArray[np.float64]

_STEP = 1e-3  # relative, of the finite differences
_ROUNDS = 2
_CLOSE = 2.5  # standard deviations of the position noise, within which a run is refined
_PICARD = 8  # rounds in which the free run of a wall converges


def refine(ports: Sequence[Ports], found: Fit) -> Fit:
    """
    Take Gauss-Newton steps on the output error.

    Parameters
    ----------
    ports : sequence of Ports
        Recordings with a robot, or of a permanently attached wall.
    found : Fit
        Start.

    Returns
    -------
    refined : Fit
        With the values of least output error; cost and residuals are still those of the ports.
        The start itself where no step makes the output error smaller, or where the command is
        not known well enough for a free run to follow the motion.

    """
    if not found.model.nominal.environment.unilateral:
        return _refine_wall(ports, found)
    model, free = found.model, found.model.free
    low, high = (bound[free] for bound in model.bounds)
    values = np.array(model.values)
    if not all(_runs_true(port, model) for port in ports):
        return found
    here = _errors(ports, model)
    cost = float(here @ here)
    for _ in range(_ROUNDS):
        size = np.where(values != 0.0, np.abs(values), 1.0)
        columns = []
        for k in np.flatnonzero(free):
            moved = values.copy()
            moved[k] += _STEP * size[k]
            columns.append((_errors(ports, model.at(moved)) - here) / _STEP)
        change = np.linalg.lstsq(np.array(columns).T, -here, rcond=1e-9)[0] * size[free]
        tried = values.copy()
        tried[free] = np.clip(values[free] + change, low, high)
        there = _errors(ports, model.at(tried))
        if float(there @ there) >= cost:
            break
        gained = cost - float(there @ there)
        values, here, cost = tried, there, float(there @ there)
        if gained < 1e-3 * cost:
            break
    return found._replace(model=model.at(values))


def _runs_true(port: Ports, model: Model) -> bool:
    o = port.observed
    error = (o.raw_position - free_run(model, o).position)[port.use]
    return float(np.std(error)) < _CLOSE * port.motion_noise


def _refine_wall(ports: Sequence[Ports], found: Fit) -> Fit:
    for port in ports:
        port.rounds = _PICARD
    return fit(ports, found.model)


def _errors(ports: Sequence[Ports], model: Model) -> Array:
    parts = []
    for port in ports:
        run, o = free_run(model, port.observed), port.observed
        parts.append(port.average('motion', o.raw_position - run.position, port.motion_noise))
        parts.append(port.average('force', o.force - run.force, port.force_noise))
    return huber(np.concatenate(parts))
