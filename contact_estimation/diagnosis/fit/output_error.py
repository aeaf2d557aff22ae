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

from .fitting import differentiate_by, Fit, fit, fit_to_end
from .free_run import free_run, Run
from ..observe.model import Model
from ..observe.ports import huber, Ports

Array = NDArray[np.float64]

_STEP = 1e-3  # relative, of the finite differences
_CLOSE = 4.0  # standard deviations of the position noise, within which a run is refined
_AT_NOISE = 1.5  # times the noise: a free run that misses no more is right
_PICARD = 8  # rounds in which the free run of a wall converges
_AGAIN, _SLOWLY = 3, 0.99  # a search that ran out of steps goes on
_WORSE = 4.0  # times: a wall's free run may miss more than with its effects at measured motion


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
        The start itself where that does not make the output error smaller, or where the command is
        not known well enough for a free run to follow the motion.

    """
    if not found.model.nominal.environment.unilateral:
        return _refine_wall(ports, found)
    runs = [free_run(found.model, port.observed) for port in ports]
    if not all(_close(port, run, _CLOSE) for port, run in zip(ports, runs)):
        return found
    model, here = found.model, _errors(ports, runs)
    for _ in range(_AGAIN):
        tried = _better(ports, model, here)
        there = _errors_at(ports, tried)
        if float(there @ there) >= float(here @ here):
            break
        slowly = float(there @ there) > _SLOWLY * float(here @ here)
        model, here = tried, there
        if slowly:
            break
    return found._replace(model=model) if model.plausible() else found


def _better(ports: Sequence[Ports], model: Model, here: Array) -> Model:
    """Take a Gauss-Newton step from a model with the errors `here`."""
    values, size = model.coordinates, model.steps

    def errors(these: Array) -> Array:
        return _errors_at(ports, model.with_free(these))

    jacobian = differentiate_by(values, size, errors, here, _STEP)
    change = np.linalg.lstsq(jacobian, -here, rcond=1e-9)[0] * size
    return model.with_free(np.clip(values + change, *model.ranges))


def runs_true(ports: Sequence[Ports], model: Model) -> bool:
    """
    Tell whether a model, run free from its command, predicts motion and force to their noise.

    Parameters
    ----------
    ports : sequence of Ports
        Recordings with a robot.
    model : Model
        Refined.

    Returns
    -------
    true : bool
        Nothing is missing then, whatever the ports leave.

    """
    for port in ports:
        o, run = port.observed, free_run(model, port.observed)
        touching = port.use & o.measured
        force_error = float(np.std((o.force - run.force)[touching]))
        if not _close(port, run, _AT_NOISE) or force_error > _AT_NOISE * port.force_noise:
            return False
    return True


def _close(port: Ports, run: Run, bound: float) -> bool:
    error = (port.observed.raw_position - run.position)[port.use]
    return float(np.std(error)) < bound * port.motion_noise


def _refine_wall(ports: Sequence[Ports], found: Fit) -> Fit:
    for port in ports:
        port.rounds = _PICARD
    refined = fit_to_end(ports, fit(ports, found.model))
    if refined.cost <= _WORSE * found.cost and refined.model.plausible():
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
