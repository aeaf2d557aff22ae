# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Concealed worlds of whole arms: drawn, recorded, diagnosed blind, scored."""

from collections import Counter
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, Callable, Mapping, NamedTuple, Sequence

import numpy as np

from .running import TrialFiles
from .trial import nominal_model
from ...kinematics.arm_dynamics import ArmDynamics, PER_LINK
from ...parameter_files import parameter_sections
from ...physics import EFFECTS
from ...physics.contact_law import ContactLaw
from ...physics.joint_effects import JOINT_EFFECTS
from ...physics.numeric import Array
from ...plant.arm_models import arm_description, ARM_MODELS, PRESSING, TIP
from ...plant.arm_simulation import ArmLaw, ArmSensors, Impedance, simulate_arm, SimulatedArm
from ...plant.plant_parameters import WallParameters
from ...recordings.encoding import encode_arm, WrenchEncoder
from ...recordings.writing import write_messages
from ...reference.arm_excitation import ArmTrajectory, exciting_trajectory, pressing_motion

Draw = Callable[['_Arm', np.random.Generator], ArmLaw]

CLEAN, UNKNOWN = 'nothing', 'unknown'
_DURATION_S, _TRIES = 30.0, 4
_LINKS_OFF = 0.025  # standard deviation of the links' masses: nearly all within 5 %


class _Arm(NamedTuple):
    """An arm and its motion, which scale what is concealed."""

    arm: ArmDynamics
    motion: ArmTrajectory
    load: Array

    @property
    def size(self) -> Array:
        """Range of each joint's torque, a twentieth of the largest at least [N m]."""
        span = np.ptp(self.load, axis=0)
        return np.maximum(span, 0.05 * span.max())

    @property
    def reversing(self) -> Array:
        """Time in which each joint's load is on its rarer side, times the size."""
        up = (self.load > 0.0).mean(axis=0)
        return np.asarray(np.minimum(up, 1.0 - up) * self.size)

    def joint(self, rng: np.random.Generator) -> int:
        """Draw a joint."""
        return int(rng.integers(len(self.arm.joints)))

    def loaded(self, rng: np.random.Generator) -> int:
        """Draw a joint that carries a third of the largest torque."""
        return int(rng.choice(np.flatnonzero(self.size > self.size.max() / 3.0)))


def _payload(one: _Arm, rng: np.random.Generator) -> ArmLaw:
    """Draw a compact body at the flange, a twelfth to a fifth of what moves."""
    mass = rng.uniform(0.08, 0.2) * float(one.arm.masses[1:].sum())
    c = rng.uniform(0.03, 0.1, 3) * rng.choice([-1.0, 1.0], 3)
    J = mass * ((c @ c) * np.eye(3) - np.outer(c, c) + 0.001 * np.eye(3))
    inertia = [J[0, 0], J[0, 1], J[1, 1], J[0, 2], J[1, 2], J[2, 2]]
    return ArmLaw('payload', [mass, *(mass * c), *inertia], len(one.arm.joints) - 1)


def _rotor(one: _Arm, rng: np.random.Generator) -> ArmLaw:
    """Draw a rotor whose torque is a tenth of its joint's range at least."""
    j = one.joint(rng)
    fast = float(np.std(one.motion.a[:, j]))
    return ArmLaw('reflected_inertia', [rng.uniform(0.06, 0.2) * one.size[j] / fast], j)


def _flexible(one: _Arm, rng: np.random.Generator) -> ArmLaw:
    """Draw a compliance that changes the torques of its joint by some per cent."""
    j = one.loaded(rng)
    return ArmLaw('joint_flexibility', [rng.uniform(0.03, 0.08) / np.abs(one.load[:, j]).max()], j)


def _delay(one: _Arm, rng: np.random.Generator) -> ArmLaw:
    """Draw a delay that moves 1 to 3 % of the torque."""
    rate = np.gradient(one.load, one.motion.t, axis=0).std(axis=0) / one.load.std(axis=0)
    return ArmLaw('force_delay', [rng.uniform(0.01, 0.03) * 2.0 / float(np.median(rate))])


def _at(name: str, where: str, low: float, high: float, both: bool = False) -> Draw:
    """Draw the first coefficient, as a share of the range of its joint's torque."""
    def draw(one: _Arm, rng: np.random.Generator) -> ArmLaw:
        j = getattr(one, where)(rng)
        size = rng.uniform(low, high) * (rng.choice([-1.0, 1.0]) if both else 1.0)
        unit = 1.0 if name == 'force_gain' else one.size[j]
        theta = size * unit * np.eye(len(JOINT_EFFECTS[name].coefficients))[0]
        return ArmLaw(name, theta.tolist(), j, 1e-3 if name == 'coulomb_friction' else 0.0)
    return draw


KINDS: Mapping[str, Draw] = {
    'coulomb_friction': _at('coulomb_friction', 'joint', 0.15, 0.3),
    'payload': _payload,
    'reflected_inertia': _rotor,
    'force_bias': _at('force_bias', 'joint', 0.1, 0.25, True),
    'force_gain': _at('force_gain', 'loaded', 0.12, 0.3, True),
    'joint_flexibility': _flexible,
    'backlash': lambda one, rng: ArmLaw(  # in the joint whose load changes its sign most
        'backlash', [rng.uniform(0.03, 0.08)], int(np.argmax(one.reversing))),
    'force_delay': _delay,
    'base_tilt': lambda one, rng: ArmLaw('base_tilt', [
        float(sign * np.radians(rng.uniform(1.5, 4.0))) for sign in rng.choice([-1, 1], 2)]),
    'joint_spring': _at('joint_spring', 'loaded', 0.06, 0.2),
}
"""What is concealed, beside nothing, and a torque that is no function of the state."""

_STIFFNESS, _DAMPING, _SURFACE = 4800.0, 60.0, 0.012  # of the wall [N/m], [N s/m], [m]
_DEPTH, _DOWN = 0.03, np.array([0.0, 0.0, -1.0])
_WALL_LAWS: Mapping[str, Callable[[np.random.Generator], float]] = {
    'dead_zone': lambda rng: rng.uniform(0.002, 0.005),
    'cubic_stiffness': lambda rng: rng.uniform(0.3, 0.8) * _STIFFNESS / _DEPTH**2,
    'quadratic_damping': lambda rng: rng.uniform(300.0, 800.0),
}
_LOADED = _at('coulomb_friction', 'loaded', 0.15, 0.3)
_STIFF = 0.2  # of the compliance in free motion: what presses with 60 N would move centimetres

PRESSED = (CLEAN, 'coulomb_friction', 'dead_zone', 'joint_flexibility', CLEAN, 'payload',
           'cubic_stiffness', 'force_gain', CLEAN, 'quadratic_damping')
"""What is concealed in arms that press on a wall: in their joints, or in the wall."""


class Engine(NamedTuple):
    """What simulates arms: the descriptions of some by name, and `simulate_arm` or the like."""

    arms: Mapping[str, Callable[[], str]]
    simulate: Callable[..., SimulatedArm]  # of the description, then as `simulate_arm`


def _own(urdf: str, *given: Any) -> SimulatedArm:
    return simulate_arm(*given)


OWN = Engine({name: partial(arm_description, name) for name in ARM_MODELS}, _own)


def _drawn(
    kind: str, number: int, seed: int, pressing: bool, engine: Engine
) -> tuple[str, SimulatedArm, dict[str, Any]]:
    """Return description, recording and truth of one world."""
    rng = np.random.default_rng((seed, number))
    names, first = list(engine.arms), number + number // (len(KINDS) + 2)
    for k in range(len(names)):
        name = names[(first + k) % len(names)]
        urdf = engine.arms[name]()
        arm = ArmDynamics(urdf)
        motion = (pressing_motion(arm, TIP, np.array(PRESSING[name]), _DOWN, rng) if pressing else
                  exciting_trajectory(arm, int(rng.integers(2**31)), _DURATION_S, tries=_TRIES))
        one = _Arm(arm, motion, arm.torque(motion.q, motion.v, motion.a))
        if kind != 'backlash' or one.reversing.any():
            break  # no gap shows where the load stays on one side
    n = len(arm.joints)
    links = np.clip(1.0 + _LINKS_OFF * rng.normal(size=n), 0.95, 1.05)
    true = arm.with_parameters(arm.neutral * np.repeat(links, PER_LINK))
    laws = _everywhere(one, rng)
    impedance, effects = _pressed(kind, rng) if pressing else (None, [])
    extra = None
    if kind in KINDS:
        laws.append(_concealed(kind, one, rng, pressing))
        effects = [_name_of(laws[-1], arm)]
    elif kind == UNKNOWN:
        j, extra = _disturbed(one, rng)
        effects = [{'name': UNKNOWN, 'place': arm.joints[j]}]
    sensors = ArmSensors(float(rng.choice([100.0, 200.0, 250.0])),
                         rng.uniform(0.002, 0.01, n) * one.size, 1e-5)
    states = engine.simulate(urdf, true, motion, laws, sensors, number, extra, impedance)
    return urdf, states, {'kind': kind, 'arm': name, 'effects': effects}


def _everywhere(one: _Arm, rng: np.random.Generator) -> list[ArmLaw]:
    """Draw what every arm has: friction, and zeros of its torques."""
    n = len(one.arm.joints)
    dry, viscous = (rng.uniform(0.01, 0.05, n) * one.size for _ in range(2))
    return [ArmLaw(name, [value], j, shape) for name, shape, values in (
        ('coulomb_friction', 1e-3, dry), ('viscous_friction', 0.0, viscous),
        ('force_bias', 0.0, rng.normal(size=n) * 0.005 * one.size))
        for j, value in enumerate(values)]


def _pressed(kind: str, rng: np.random.Generator) -> tuple[Impedance, list[dict[str, Any]]]:
    """Return control and wall, and what is concealed in the wall."""
    laws = [EFFECTS[name](**{key: float(draw(rng)) for key in EFFECTS[name].neutral()})
            for name, draw in _WALL_LAWS.items() if name == kind]
    wall = ContactLaw(_STIFFNESS, _DAMPING, _SURFACE, 0.0, True, laws)
    return (Impedance(_DOWN, wall, noise=np.array(3 * [0.3] + 3 * [0.02])),
            [{'name': law.name, 'family': law.family, 'place': None} for law in laws])


def _concealed(kind: str, one: _Arm, rng: np.random.Generator, pressing: bool) -> ArmLaw:
    """Draw a law of a joint or of what the arm carries."""
    law = (_LOADED if pressing and kind == 'coulomb_friction' else KINDS[kind])(one, rng)
    soft = pressing and kind == 'joint_flexibility'
    return replace(law, theta=[_STIFF * law.theta[0]]) if soft else law


def _name_of(law: ArmLaw, arm: ArmDynamics) -> dict[str, Any]:
    return {'name': law.effect, 'family': JOINT_EFFECTS[law.effect].family,
            'place': None if law.place is None or law.effect == 'payload'
            else arm.joints[law.place], 'parameters': [float(x) for x in law.theta]}


def _disturbed(one: _Arm, rng: np.random.Generator) -> tuple[int, Array]:
    """Draw a joint, and torques (N, n) that are no function of the state."""
    j, t, extra = one.joint(rng), one.motion.t, np.zeros_like(one.motion.q)
    wave = sum(np.sin(2.0 * np.pi * f * t + rng.uniform(0.0, 6.0))
               for f in rng.uniform(0.15, 0.9, 6))
    extra[:, j] = rng.uniform(0.1, 0.2) * one.size[j] * wave / np.std(wave)
    return j, extra


class PlannedArm(NamedTuple):
    """A trial of an arm, not drawn yet; see `running.Planned`."""

    name: str
    kind: str  # what is concealed
    number: int
    seed: int
    pressing: bool
    engine: Engine

    def files(self, folder: Path) -> TrialFiles:
        """Return the paths of its files."""
        return TrialFiles.of(folder, self.name, nominal='.urdf', truth='.json')

    def write(self, files: TrialFiles) -> dict[str, Any]:
        """Draw the trial, write what is handed over, and return the truth."""
        urdf, states, truth = _drawn(self.kind, self.number, self.seed, self.pressing, self.engine)
        files.nominal.write_text(urdf)
        dynamics = ArmDynamics(urdf)
        write_arm_recording(files.recording, dynamics.joints, states)
        if self.pressing:
            tip = dynamics.pose(np.array(PRESSING[truth['arm']]), TIP)[1]
            wall = WallParameters(_STIFFNESS, _DAMPING, _SURFACE - float(tip[2]))
            files.nominal.with_suffix('.nominal.yaml').write_text(nominal_model(wall, None))
            files.nominal.with_suffix('.params.yaml').write_text(parameter_sections(
                any_node={'kinematics.base': 'base', 'kinematics.tip': TIP,
                          'contact.normal': _DOWN.tolist()}))
        return truth

    def options(self, files: TrialFiles) -> list[str]:
        """Return the options of `diagnose` that hand over all but the recording."""
        wall = ['--nominal', str(files.nominal.with_suffix('.nominal.yaml')),
                '--params', str(files.nominal.with_suffix('.params.yaml'))]
        return ['--nominal-robot', str(files.nominal), *(wall if self.pressing else [])]


def plan_arms(
    count: int, seeds: Sequence[int], pressing: bool = False, engine: Engine = OWN
) -> list[PlannedArm]:
    """Plan trials; pressing: on a wall, under an impedance that the diagnosis is not told."""
    kinds = PRESSED if pressing else [*KINDS, CLEAN, UNKNOWN]
    return [PlannedArm(f'{"press" if pressing else "arm"}_{seed}_{k:03d}', kinds[k % len(kinds)],
                       k, seed, pressing, engine) for seed in seeds for k in range(count)]


def write_arm_recording(path: Path, joints: Sequence[str], states: SimulatedArm) -> None:
    """Write joint states and wrenches as an .mcap file."""
    encoder, stamps = WrenchEncoder(TIP), [round(1e9 * t) for t in states.t]
    write_messages(path, [
        *((stamp, 'joint_states', encode_arm(stamp, joints, *row))
          for stamp, *row in zip(stamps, states.q, states.v, states.tau)),
        *((stamp, 'wrench', encoder.encode(stamp, *wrench))
          for stamp, wrench in zip(stamps, states.wrench.tolist()))])


def scored(truth: Mapping[str, Any], answer: Mapping[str, Any], world: str) -> dict[str, Any]:
    """Score an answer: the first name beyond friction, which every arm has: family and place."""
    report = answer['report'] or {'effects': [], 'joints': [], 'verdict': answer['error']}
    contact = report.get('contact') or {'effects': [], 'verdict': ''}
    effects = report['effects'] + [{**one, 'joints': [], 'place': 'the wall'}
                                   for one in contact['effects']]
    verdict = contact['verdict'] if contact['verdict'] == 'unexplained' else report['verdict']
    beyond = [one for one in effects if one['family'] != 'friction']
    friction = [one for one in effects if one['family'] == 'friction']
    wanted = truth['effects'][0] if truth['effects'] else None
    first = beyond[0] if beyond else None
    if answer['report'] is None:
        outcome = 'failed'
    elif wanted is None:
        outcome = 'accused' if first or verdict == 'unexplained' else 'right'
    elif wanted['name'] == UNKNOWN:
        bad = [one['name'] for one in report['joints'] if one['verdict'] == 'unexplained']
        outcome = 'right' if wanted['place'] in bad else 'wrong' if first else 'silent'
    elif first is None and wanted['family'] != 'friction':
        outcome = 'silent'
    else:
        first = first or (friction[0] if friction else {'family': '', 'joints': []})
        place = wanted['place'] in (None, *first['joints'])
        outcome = 'right' if first['family'] == wanted['family'] and place else 'wrong'
    named = [f'{one["name"]} at {one["place"]}' for one in (beyond or friction[:1])]
    return {'world': world, 'kind': truth['kind'], 'outcome': outcome, 'named': named,
            'place': wanted and wanted['place'], 'arm': truth['arm'], 'verdict': verdict}


def arm_text(outcomes: Sequence[Mapping[str, Any]]) -> str:
    """Return a table of outcomes by what was concealed, and the worlds that were not right."""
    lines = [f'{"concealed":<20}{"worlds":>7}{"right":>7}{"wrong":>7}{"silent":>8}{"accused":>9}']
    kinds = list(dict.fromkeys(one['kind'] for one in outcomes))
    for kind in [*kinds, 'all']:
        some = [one for one in outcomes if kind in ('all', one['kind'])]
        counts = Counter(one['outcome'] for one in some)
        lines.append(f'{kind:<20}{len(some):>7}{counts["right"]:>7}{counts["wrong"]:>7}'
                     f'{counts["silent"]:>8}{counts["accused"]:>9}')
    missed = [one for one in outcomes if one['outcome'] != 'right']
    lines += [f'{one["world"]} ({one["arm"]}): {one["kind"]} at {one["place"]}, {one["outcome"]}: '
              f'{one["verdict"]}, {", ".join(one["named"]) or "no name"}' for one in missed]
    return '\n'.join(lines)
