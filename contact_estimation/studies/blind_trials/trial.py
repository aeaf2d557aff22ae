# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""A trial: a random world, one law or none concealed in it, a nominal model without it."""

from dataclasses import asdict, dataclass
from math import exp, inf, log
from pathlib import Path
from typing import Any

import numpy as np
from numpy.random import Generator

from .concealment import active_intervals, conceal, degree, residual
from .draws import digits, draw_nominal
from .running import TrialFiles
from .scoring import CLEAN, CLEAN_RIG, FOREIGN, LIBRARY, of_families, UNKNOWN
from .settings import Setting
from .world import measure, Measurement, Run, World
from ...parameter_files import parameter_sections
from ...physics.prior import log_uniform, Values
from ...plant.plant_parameters import RobotParameters, WallParameters
from ...recordings.encoding import JointStateEncoder, TrajectoryEncoder, WrenchEncoder
from ...recordings.writing import write_messages

_MIN_CONTACT_S = 2.0
_EXACT, _EXACT_CLEAN = 0.1, 0.4  # probability that K_e and B_e are those of the nominal model
_ANY_STRENGTH = 0.01, 0.3
_USELESS = 1e3  # degree
_EPOCH_NS = 1_760_000_000_000_000_000
_JOINT = 'contact_axis'
_TRANSPORT_NS = 150_000  # from stamp to log time


@dataclass(frozen=True)
class Trial:
    """Everything drawn for one trial."""

    setting: Setting
    world: World  # True world without the law
    law: str  # '' in a clean world
    values: Values  # parameters of the law
    nominal: WallParameters  # wall of the nominal model
    degree: float  # of concealment; 1 in a clean world

    def simulate(self, rng: Generator) -> Run:
        """Simulate the world with its law as precisely as is recorded."""
        return self.setting.simulate(self.world, self.law, self.values, rng)

    def truth(self, run: Run, force_floor: float) -> dict[str, Any]:
        """Return what is sealed; force_floor: RMS of the recorded force noise [N]."""
        world, law, by_name = self.world, self.setting.law(self.law), self.setting.by_name
        if by_name:
            kind, names = (LIBRARY, [self.law]) if self.law else (CLEAN, [])
        else:
            names = sorted(of_families(law.families))
            kind = FOREIGN if names else UNKNOWN if self.law else CLEAN_RIG
        verdict = 'physics_missing' if names else 'unexplained' if self.law else 'recalibrate'
        if kind == CLEAN and self.nominal == world.wall:
            verdict = 'consistent'
        return {
            'kind': kind, 'law': self.law, 'port': law.port, 'families': list(law.families),
            'acceptable_names': names, 'parameters': dict(self.values), 'verdict': verdict,
            'stiffness': None if law.replaces_spring else world.wall.stiffness,
            'damping': 0.0 if law.replaces_damper else world.wall.damping,
            'concealed': digits(self.degree), 'force_floor_n': force_floor,
            'experiment': world.experiment.name, 'stage': world.stage,
            'intervals_s': self._intervals(run) if kind == UNKNOWN else None,
            'sensing': asdict(world.sensors),
            'nuisances': asdict(world.nuisances) if world.is_rig else None,
        }

    def _intervals(self, run: Run) -> list[tuple[float, float]]:
        """Return when the law shows [s]."""
        shown = residual(self.setting.law(self.law).in_motion, self.world, run)
        first, last = self.values.get('first', 0.0), self.values.get('last', inf)
        return active_intervals(np.where((run.t >= first) & (run.t <= last), shown, 0.0), run.t)


def draw_trial(setting: Setting, law: str, rng: Generator) -> Trial:
    """Draw a trial: of several worlds the one in which the law is nearest to a random degree."""
    low, high = setting.degrees
    # A clean rig draws a degree, too: the worlds of a seed stay what they are.
    requested = exp(rng.uniform(log(low), log(high))) if law or not setting.by_name else 1.0
    nearest: tuple[float, Trial] | None = None
    exceeded = 0
    for _ in range(setting.worlds):
        world = setting.draw(law, rng)
        without = setting.simulate(world, '', {})
        if not _is_usable(setting, world, without):
            continue
        if not law:
            return _trial(setting, world, '', {}, 1.0, rng)
        in_motion = setting.law(law).in_motion
        strength = setting.strength(law, world, without, rng)

        def degree_of(s: float) -> float:
            run = setting.simulate(world, law, strength(s))
            if world.is_rig and not _is_usable(setting, world, run):
                return _USELESS
            return degree(in_motion, world, run, without)

        found = conceal(degree_of, requested, setting.search)
        missed = not setting.is_accepted(found.degree, requested)
        exceeded += missed and found.is_exceeded
        if exceeded == setting.exceeding_worlds:  # such as backlash, hidden or plain to see
            s = log_uniform(rng, *_ANY_STRENGTH)
            return _trial(setting, world, law, strength(s), degree_of(s), rng)
        distance = abs(log(found.degree / requested))
        if nearest is None or distance < nearest[0]:
            nearest = distance, _trial(
                setting, world, law, strength(found.strength), found.degree, rng)
        if not missed:
            break
    assert nearest is not None, 'most worlds are usable'
    return nearest[1]


def _trial(
    setting: Setting, world: World, law: str, values: Values, degree: float, rng: Generator
) -> Trial:
    """Draw the nominal model."""
    values = {name: digits(value) for name, value in values.items()}
    nominal = draw_nominal(setting.modelled(law, values, world), rng,
                           _EXACT if law else _EXACT_CLEAN, setting.mass_error)
    return Trial(setting, world, law, values, nominal, degree)


def _is_usable(setting: Setting, world: World, run: Run) -> bool:
    """Return whether a robot touches long enough, and without an impact."""
    if world.robot is None:
        return True
    return run.contact_s > _MIN_CONTACT_S and bool(
        np.max(np.abs(run.force)) < setting.most_force(world))


# -- files ------------------------------------------------------------------------------------


def write_trial(trial: Trial, files: TrialFiles, rng: Generator) -> dict[str, Any]:
    """Simulate a trial, write recording and nominal model, and return the truth."""
    world, run = trial.world, trial.simulate(rng)
    measurement = measure(run, world.sensors, rng)
    _write_recording(files.recording, measurement, world.sensors.velocity_noise is not None,
                     world.robot is not None)
    files.nominal.write_text(nominal_model(trial.nominal, world.robot))
    return trial.truth(run, measurement.force_floor)


def nominal_model(wall: WallParameters, robot: RobotParameters | None) -> str:
    """Write the nominal model: the wall as modelled, the true robot."""
    environment = {'stiffness': wall.stiffness, 'damping': wall.damping, 'location': wall.location}
    values: dict[str, Any] = {'environment': environment}
    if not wall.unilateral:
        environment.update(inertia=wall.inertia, unilateral=False)
    if robot is not None:
        values['robot'] = {
            'mass': robot.mass, 'damping': robot.damping, 'stiffness': robot.stiffness}
    return parameter_sections(plant_node=values)


def _write_recording(
    path: Path, measurement: Measurement, with_velocity: bool, with_reference: bool
) -> None:
    wrench = WrenchEncoder('tool')
    joint = JointStateEncoder('base', _JOINT, with_velocity)
    reference = TrajectoryEncoder('base', _JOINT)
    topics = (
        (measurement.force, 'wrench', lambda stamp, force: wrench.encode(stamp, force, 0.0, 0.0)),
        (measurement.joint, 'joint_states', lambda stamp, motion: joint.encode(stamp, *motion)),
        (measurement.reference, 'reference_trajectory',
         lambda stamp, r: reference.encode(stamp, r[0], r[1], r[2], 0.0)))
    write_messages(path, [
        (_EPOCH_NS + stamp, role, encode(_EPOCH_NS + stamp, value))
        for signal, role, encode in topics[:3 if with_reference else 2]
        for stamp, value in zip(signal.stamps.tolist(), signal.values.tolist())], _TRANSPORT_NS)
