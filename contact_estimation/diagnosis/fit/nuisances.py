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

"""What nobody knows of a right model, and what must therefore not be taken for physics."""

from __future__ import annotations

from math import sqrt

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import median_filter

from ..observe.model import Model
from ..observe.ports import OBSERVER_CUTOFF, Ports

Array = NDArray[np.float64]

NUISANCES = (
    ('impedance_mismatch', (1.0, 1.0, 1.002)),
    ('command_delay', (3e-5,)),
    ('force_delay', (3e-5,)),
)
"""What no laboratory knows better: M_t to 0.2 %, stamps to 0.03 ms."""

_MOST_STEPS = 200
_LEAST_STEP = 0.1  # standard deviations of the motion
_STANDS_OUT = 10.0  # times the median: else it is not a step
_AROUND = 5  # samples among which it stands out
_UNIFORM = 1.0 / sqrt(12.0)  # standard deviation of an instant within a sample


def doubt(port: Ports, model: Model) -> None:
    """
    Let a recording discount from now on what `NUISANCES` could explain.

    So are the instant, within a sample, at which the reference steps, and whether the robot
    holds the wanted acceleration between samples or follows straight lines.

    Parameters
    ----------
    port : Ports
        The recording.
    model : Model
        Fitted, at which the derivatives are taken.

    """
    port.discount(None)
    if port.driven_by_force(model):
        return  # a wall's whole motion tells when the force came, and how it went on
    here = port.residuals(model, robust=False)
    robot = port.observed.reference is not None
    columns = [
        port.residuals(model.with_effect(name, values), robust=False) - here
        for name, values in NUISANCES
        if name not in model.effects and (robot or name == 'force_delay')
    ]
    if robot:
        columns += [_on_motion(port, answer)
                    for answer in (_held_acceleration(port, model),
                                   *_steps_of_reference(port, model))]
    port.discount(np.array(columns).T)


def _on_motion(port: Ports, innovations: Array) -> Array:
    """Give the residuals that innovations of the motion alone leave."""
    motion = port.average('motion', innovations, port.motion_noise)
    return np.concatenate((np.zeros(len(motion)), motion))


def _held_acceleration(port: Ports, model: Model) -> Array:
    """Give the innovations of a robot that holds the wanted acceleration over each sample."""
    reference, mass = port.observed.reference, model.laws().robot.mass
    assert reference is not None
    answer = port.answer_to(-0.5 * mass * np.gradient(reference[2]), model)
    assert answer is not None
    return answer


def _steps_of_reference(port: Ports, model: Model) -> list[Array]:
    """Give the innovations that a step of the reference leaves when it comes a little off."""
    o, robot = port.observed, model.laws().robot
    assert o.reference is not None
    x_r, v_r, a_r = o.reference[:3]
    pushes = np.diff(robot.mass * a_r + robot.damping * v_r + robot.stiffness * x_r)
    jumps = pushes - median_filter(pushes, _AROUND)
    size = np.abs(jumps) * o.h  # impulse of a whole sample [N s]
    least = max(_LEAST_STEP * port.motion_noise * OBSERVER_CUTOFF * robot.mass,
                _STANDS_OUT * float(np.median(size)))
    steps = np.argsort(-size)[:_MOST_STEPS]
    pulse = np.zeros(len(o.t))
    pulse[0] = 1.0
    answer = port.answer_to(pulse, model)
    assert answer is not None
    answers = []
    for k in steps[size[steps] > least].tolist():
        for first in (k, k + 1):  # how it is spread over the sample takes two pulses to tell
            moved = np.zeros(len(o.t))
            moved[first:] = answer[:len(o.t) - first] * jumps[k] * _UNIFORM
            answers.append(moved)
    return answers
