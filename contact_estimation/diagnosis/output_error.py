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
from .free_run import free_run, Run
from .model import Model
from .ports import huber, Ports

Array = NDArray[np.float64]

_STEP = 1e-3  # relative, of the finite differences
_CLOSE = 2.5  # standard deviations of the position noise, within which a run is refined
_PICARD = 8  # rounds in which the free run of a wall converges


def refine(ports: Sequence[Ports], found: Fit) -> Fit:
    """
    Take a Gauss-Newton step on the output error.

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
        The start itself where that does not make the output error smaller, or where the command is
        not known well enough for a free run to follow the motion.

    """
    if not found.model.nominal.environment.unilateral:
        return _refine_wall(ports, found)
    model, free = found.model, found.model.free
    low, high = (bound[free] for bound in model.bounds)
    values = np.array(model.values)
    runs = [free_run(model, port.observed) for port in ports]
    if not all(_runs_true(port, run) for port, run in zip(ports, runs)):
        return found
    here = _errors(ports, runs)
    cost = float(here @ here)
    size = np.where(values != 0.0, np.abs(values), 1.0)
    columns = []
    for k in np.flatnonzero(free):
        moved = values.copy()
        moved[k] += _STEP * size[k]
        columns.append((_errors_at(ports, model.at(moved)) - here) / _STEP)
    change = np.linalg.lstsq(np.array(columns).T, -here, rcond=1e-9)[0] * size[free]
    tried = values.copy()
    tried[free] = np.clip(values[free] + change, low, high)
    there = _errors_at(ports, model.at(tried))
    if float(there @ there) < cost:
        values = tried
    refined = found._replace(model=model.at(values))
    return refined if refined.model.plausible() else found


def _runs_true(port: Ports, run: Run) -> bool:
    error = (port.observed.raw_position - run.position)[port.use]
    return float(np.std(error)) < _CLOSE * port.motion_noise


def _refine_wall(ports: Sequence[Ports], found: Fit) -> Fit:
    for port in ports:
        port.rounds = _PICARD
    refined = fit(ports, found.model)
    if refined.cost <= found.cost and refined.model.plausible():
        return refined
    for port in ports:  # the iteration does not converge where the wall is far from linear
        port.rounds = 1
    return found


def _errors_at(ports: Sequence[Ports], model: Model) -> Array:
    return _errors(ports, [free_run(model, port.observed) for port in ports])


def _errors(ports: Sequence[Ports], runs: Sequence[Run]) -> Array:
    parts = []
    for port, run in zip(ports, runs):
        o = port.observed
        parts.append(port.average('motion', o.raw_position - run.position, port.motion_noise))
        parts.append(port.average('force', o.force - run.force, port.force_noise))
    return huber(np.concatenate(parts))
