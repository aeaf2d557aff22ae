# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""A trial on a rig: a law of the literature, well above nuisances and noise, or none."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from math import exp, hypot, log, pi
from typing import Any

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray
from scipy.signal import butter, filtfilt

from .concealment import active_intervals, conceal, rms_ratio
from .foreign_law import ForeignLaw, Magnitudes, Values
from .foreign_laws import ALL_LAWS
from .rig import Rig, simulate_rig
from .rig_worlds import draw_rig, STAGES
from .worlds import draw_nominal_wall, Run
from ...plant.plant_parameters import RobotParameters, WallParameters

Array = NDArray[np.float64]

MIN_DEGREE, MAX_DEGREE = 2.0, 10.0
"""Range of the degree by which a law stands out, log-uniform."""

_ACCEPTED = (0.7 * MIN_DEGREE, 1.3 * MAX_DEGREE)
_MAX_RIGS = 12
_SIMULATIONS = 5  # of one search
_FIRST_STRENGTH = 0.2
_CONVERGED = 0.25  # relative deviation from the requested degree that ends a search
_MAX_FORCE = 4.0  # of the planned force range; more is an impact
_SEARCH_HZ, _FINAL_HZ = 1000.0, 2000.0  # integration rates
_SLOW_STEPS, _SLOW_HZ = 4, 20.0  # least integration steps a sample and a second of slow rigs
_ROBOT_HZ = 15.0  # corner of the filter of the residual of eq. (1)


@dataclass(frozen=True)
class RigTrial:
    """Everything drawn for one trial on a rig."""

    rig: Rig  # True world without the law
    law: str  # key of ALL_LAWS; '' in a clean world
    values: Values  # parameters of the law
    nominal: WallParameters  # wall of the nominal model
    degree: float  # how many times the misfit of a spring-damper exceeds that without the law

    def make_law(self) -> ForeignLaw | None:
        """Return the law with its parameters."""
        return ALL_LAWS[self.law](self.values) if self.law else None


def draw_rig_trial(law: str, rng: Generator) -> RigTrial:
    """Draw a trial on a rig."""
    stages = ALL_LAWS[law].stages if law else tuple(STAGES)
    requested = exp(rng.uniform(log(MIN_DEGREE), log(MAX_DEGREE)))
    nearest: tuple[float, RigTrial] | None = None
    for _ in range(_MAX_RIGS):
        rig = draw_rig(str(rng.choice(list(stages))), rng)
        rate = integration_rate(rig, final=False)
        without = simulate_rig(rig, None, rate, np.random.default_rng(0))
        if not law:
            return RigTrial(rig, '', {}, _nominal(rig.wall, rng, exact=0.4), 1.0)
        if not _is_usable(rig, without):
            continue
        values, degree = _search(rig, law, without, requested, rng)
        missed = abs(log(degree / requested))
        if nearest is None or missed < nearest[0]:
            nominal = _nominal(rig.wall, rng, exact=0.1)
            nearest = missed, RigTrial(rig, law, values, nominal, degree)
        if _ACCEPTED[0] < degree < _ACCEPTED[1]:
            break
    assert nearest is not None, 'most rigs are usable'
    return nearest[1]


def _nominal(wall: WallParameters, rng: Generator, exact: float) -> WallParameters:
    """Draw the wall of the nominal model; a mass is off by up to 20 %."""
    drawn = draw_nominal_wall(wall, rng, exact)
    known = drawn.stiffness == wall.stiffness and drawn.damping == wall.damping
    error = 0.0 if known else float(rng.uniform(-0.2, 0.2))
    return replace(drawn, inertia=float(f'{wall.inertia * (1.0 + error):.6g}'),
                   unilateral=wall.unilateral)


def _search(
    rig: Rig, name: str, without: Run, requested: float, rng: Generator
) -> tuple[Values, float]:
    """Search the strength of a law at which it stands out as requested."""
    cls, rate = ALL_LAWS[name], integration_rate(rig, final=False)
    strength = cls.draw(magnitudes_of(rig, without), rng)

    def values_at(s: float) -> Values:
        return {key: float(f'{value:.6g}') for key, value in strength(s).items()}

    def degree_of(s: float) -> float:
        law = cls(values_at(s))
        run = simulate_rig(rig, law, rate, np.random.default_rng(0))
        if not _is_usable(rig, run):
            return 1e3
        return degree(cls.port, rig, run, without)

    found = conceal(degree_of, requested, _FIRST_STRENGTH, _SIMULATIONS, _CONVERGED)
    return values_at(found.strength), found.degree


def integration_rate(rig: Rig, final: bool = True) -> float:
    """Return the rate of integration steps, a multiple of the sample rate [Hz]."""
    rate = rig.sensors.rate
    if rig.stage == 'slow':
        return rate * max(_SLOW_STEPS, round(_SLOW_HZ / rate))
    return rate * max(1, round((_FINAL_HZ if final else _SEARCH_HZ) / rate))


def magnitudes_of(rig: Rig, run: Run) -> Magnitudes:
    """Compute the orders of magnitude of a rig."""
    pressing = np.abs(run.force) > 0.0
    control, mass = 0.0, 0.0
    if rig.robot is not None:
        control, mass = float(np.max(np.abs(run.control(rig.robot)))), rig.robot.mass
    depth = run.x - rig.wall.location
    force = float(np.percentile(np.abs(run.force), 99.5))
    speed = float(np.percentile(np.abs(run.v[pressing]), 98)) if pressing.any() else 1e-3
    return Magnitudes(
        depth=float(np.max(depth)), speed=max(speed, 1e-9), force=force, control=control,
        duration=float(run.t[-1]), stiffness=rig.wall.stiffness, damping=rig.wall.damping,
        mass=mass or rig.wall.inertia or 1e-3 * force)


def _is_usable(rig: Rig, run: Run) -> bool:
    """Return whether the force stays within its range and a robot touches long enough."""
    if rig.robot is None:
        return True
    force = rig.wall.stiffness * rig.depth
    return run.contact_s > 2.0 and bool(np.max(np.abs(run.force)) < _MAX_FORCE * force)


# -- how far the law stands out ---------------------------------------------------------------


def degree(port: str, rig: Rig, run: Run, without: Run) -> float:
    """Compute how far a law stands out."""
    noise = rig.sensors.force_std
    if port == 'robot' and rig.robot is not None:
        noise = hypot(noise, _motion_noise(rig, rig.robot))
    return rms_ratio(noise, rig_residual(port, rig, run), rig_residual(port, rig, without))


def rig_residual(port: str, rig: Rig, run: Run) -> Array:
    """
    Compute the residual in which a law at a port shows.

    Returns residual (N,): of eq. (1) below 15 Hz at the robot, else of a refitted spring-damper
    (and mass, if the world has one) [N]; NaN where it is not defined.
    """
    a = np.gradient(run.v, run.t)
    if port == 'robot' and rig.robot is not None:
        balance = rig.robot.mass * a - run.control(rig.robot) - run.sensed
        b_a = butter(2, _ROBOT_HZ, fs=1.0 / float(run.t[1]))
        return np.asarray(filtfilt(*b_a, balance))
    d, attached = run.x - rig.wall.location, not rig.wall.unilateral
    columns = [run.v] + ([d] if rig.wall.stiffness else []) + ([a] if rig.wall.inertia else [])
    phi: Array = -np.column_stack(columns)
    fitted = np.ones(len(d), bool) if attached else (run.force < 0.0) & (d > 0.0)
    theta = np.linalg.lstsq(phi[fitted], run.sensed[fitted], rcond=None)[0]
    if attached:
        return np.asarray(run.sensed - phi @ theta)
    return np.asarray(run.sensed - np.where(d > 0.0, np.minimum(0.0, phi @ theta), 0.0))


def _motion_noise(rig: Rig, robot: RobotParameters) -> float:
    """Propagate white position noise through eq. (1), below the corner of its filter [N]."""
    omega = 2.0 * pi * np.linspace(0.0, _ROBOT_HZ, 100)
    gain = np.hypot(robot.stiffness - robot.mass * omega**2, robot.damping * omega)
    share = 2.0 * _ROBOT_HZ / rig.sensors.rate
    return rig.sensors.position_std * float(np.sqrt(share * np.mean(gain**2)))


# -- truth ------------------------------------------------------------------------------------


def rig_truth(trial: RigTrial, run: Run, force_floor: float) -> dict[str, Any]:
    """Collect the ground truth of a trial on a rig with a white noise of this RMS [N]."""
    rig = trial.rig
    cls = ALL_LAWS.get(trial.law)
    families = list(cls.families) if cls else []
    unknown = None
    if cls and not families:
        shown = rig_residual(cls.port, rig, run)
        first, last = trial.values.get('first', 0.0), trial.values.get('last', np.inf)
        shown = np.where((run.t >= first) & (run.t <= last), shown, 0.0)
        unknown = {'name': trial.law, 'port': cls.port, 'parameters': dict(trial.values),
                   'intervals_s': active_intervals(shown, run.t)}
    verdict = 'unexplained' if unknown else 'physics_missing' if cls else 'recalibrate'
    keeps_spring, keeps_damper = (
        getattr(cls, name, True) for name in ('keeps_spring', 'keeps_damper'))
    return {
        'law': trial.law, 'port': cls.port if cls else '', 'families': families,
        'parameters': dict(trial.values), 'effects': [], 'unknown': unknown, 'verdict': verdict,
        'stiffness': rig.wall.stiffness if keeps_spring else None,
        'damping': rig.wall.damping if keeps_damper else 0.0,
        'concealed': trial.degree, 'force_floor_n': force_floor, 'experiment': rig.experiment.name,
        'stage': rig.stage, 'sensing': asdict(rig.sensors), 'nuisances': asdict(rig.nuisances),
    }
