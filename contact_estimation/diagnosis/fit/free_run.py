# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The free run of a model, from its command or, for a wall without a robot, the force."""

from dataclasses import replace
import math
from typing import Any, NamedTuple

import numpy as np

from .fitting import Fit, fit, fit_to_end
from ..observe.driven_wall import DrivenWall
from ..observe.model import Model
from ..observe.observed import Observed
from ..observe.prepared_recording import Recordings
from ..observe.shares import LITTLE, SLIGHT
from ...parameters import build, flatten
from ...physics.contact_law import ContactLaw
from ...physics.numeric import Array
from ...plant.driven_wall import run_driven_wall
from ...plant.plant_parameters import PlantParameters
from ...plant.simulation import simulate_on

_PICARD = 40  # rounds at most
_CONVERGED = 1e-4  # of the motion
_STABLE = 1.0  # rate of decay times step; Runge-Kutta is stable up to 2.8
_RESOLVED = 0.2  # [rad] of the oscillation of robot and wall, a step
_MOST_STEPS = 100.0
_NEAR = 1e-6  # [s] that a state moves: the laws are linear in small states
_WALL_STEPS = 2  # Runge-Kutta steps a sample of a wall without a robot


def plant_of(model: Model) -> PlantParameters:
    """Convert a fitted model to the parameters of a plant."""
    values: dict[str, Any] = dict(flatten(model.nominal))
    values['environment.stiffness'] = model.stiffness
    values['environment.damping'] = model.damping
    if model.with_inertia:
        values['environment.inertia'] = model.values[2]
    for name in model.effects:
        for parameter, value in model.effect(name).values().items():
            values[f'physics.{name}.{parameter}'] = value
    return build(PlantParameters, values)


class Run(NamedTuple):
    """A free run, sample by sample."""

    position: Array  # (N,) x [m]
    force: Array  # (N,) output of the force sensor without noise [N]


def steps_a_sample(model: Model, o: Observed) -> int:
    """Return how many Runge-Kutta steps a sample asks for."""
    laws, wall = model.laws(), model.nominal.environment
    least = SLIGHT * float(np.ptp(o.x))
    x = wall.location + 0.5 * max(float(np.max(o.x)) - wall.location, least)
    fast, slow = float(np.max(np.abs(o.v))), 0.1 * model.nominal.sign_velocity
    states = laws.contact.settle(0.0, x, LITTLE * fast, (0.0,) * laws.contact.states)
    touch = [laws.contact.touch(0.0, x, v, states, math).resistance for v in (0.0, slow)]
    drag = [laws.robot.force(x, v, (x, v, 0.0, 0.0), math) for v in (0.0, slow)]
    steepness = (touch[1] - touch[0] + drag[0] - drag[1]) / slow / laws.robot.link_mass
    fastest = max(steepness, _decay(laws.contact, x, fast))
    steps = max(1, math.ceil(min(o.h * fastest / _STABLE, _MOST_STEPS)))
    if laws.robot.joint is not None:
        rate = 1.0 / math.sqrt(laws.robot.joint.compliance * laws.robot.link_mass)
        steps = max(steps, math.ceil(o.h * rate / _RESOLVED))
    if o.pace <= 1.0:
        return steps
    stiffness = max(model.stiffness + laws.robot.stiffness, 0.0)
    return max(steps, math.ceil(o.h * math.sqrt(stiffness / laws.robot.mass) / _RESOLVED))


def _decay(law: ContactLaw, x: float, speed: float) -> float:
    """Return the fastest rate at which an internal state of a wall follows the motion [1/s]."""
    fastest, still = 0.0, (0.0,) * law.states
    for v in (speed, -speed):
        rates = law.rates(0.0, x, v, still)
        for k in range(law.states):
            near = _NEAR * (abs(rates[k]) or 1.0)
            moved = (*still[:k], near, *still[k + 1:])
            fastest = max(fastest, (rates[k] - law.rates(0.0, x, v, moved)[k]) / near)
    return fastest


def free_run(model: Model, observed: Observed) -> Run:
    """Simulate a recording from its command, or a wall without a robot from the measured force."""
    o = observed
    if o.reference is None:
        return Run(_free_wall(model, o), o.force)
    parameters = replace(
        plant_of(model), sample_rate=1.0 / o.h, integration_rate=steps_a_sample(model, o) / o.h)
    v = float(o.v[0]) if o.starts_moving else 0.0
    truths = simulate_on(parameters, o.t, o.reference, float(o.x[0]), v, begin=float(o.t[0]))
    return Run(np.array([truth.position for truth in truths]),
               np.array([truth.sensed for truth in truths]))


def _free_wall(model: Model, o: Observed) -> Array:
    """Iterate; integrate step by step if the wall is too nonlinear for convergence."""
    with np.errstate(all='ignore'):
        wall = DrivenWall(model, o)
        run, further = (wall.free(_PICARD + more)[0] for more in (0, 1))
    least = _CONVERGED * float(np.ptp(o.x))
    if np.isfinite(further).all() and float(np.max(np.abs(further - run))) < least:
        return run
    plant = replace(plant_of(model), integration_rate=_WALL_STEPS / o.h)
    x, v = wall.free(1)[:, 0].tolist()
    return run_driven_wall(plant, o.t, o.driving, x, v, float(o.t[0]))


_ROUNDS = 8  # rounds in which the free run of a wall converges
_WORSE = 4.0  # times the cost with effects at the measured motion: the iteration diverged


def fit_driven_wall(recordings: Recordings, found: Fit) -> tuple[Recordings, Fit]:
    """Fit a wall that a force drives with its effects at its own motion, not the measured one."""
    iterated = [replace(recording, picard_rounds=_ROUNDS) for recording in recordings]
    own = fit_to_end(iterated, fit(iterated, found.model))
    if own.cost <= _WORSE * found.cost and own.model.plausible():
        return iterated, own
    return recordings, found  # the iteration does not converge for a strongly nonlinear wall
