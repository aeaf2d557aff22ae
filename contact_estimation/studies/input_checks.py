# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Count false warnings of the input checks in healthy loops, and time the true ones."""

from __future__ import annotations

from itertools import cycle, islice, product
from math import inf, nan
from typing import Any, Callable, Mapping, NamedTuple, Sequence

import numpy as np

from .measuring import print_table
from ..commands.command_line import as_json, command, Parser, write_results
from ..commands.progress import Progress
from ..estimators import MULTIPLE_MODEL, ONLINE_ESTIMATORS
from ..parameters import build
from ..pipeline.parameters import EstimationParameters
from ..pipeline.session import ContactSession
from ..plant.closed_loop import run_closed_loop
from ..plant.plant_parameters import PAPER_NOISE, PlantParameters
from ..reference.experiments import experiment_named
from ..signals.contact_sample import ContactSample

EXPERIMENTS = ('sine', 'prbs', 'multisine', 'none', 'rich')
WALLS = ((1000.0, 40.0), (5000.0, 100.0), (4800.0, 200.0), (20000.0, 200.0))
_DURATION_S = 12.0
_IN_TIME_S = 2.0
_NS = 1_000_000
# True of the motion that was chosen: it warns of no mistake in the inputs.
_ADVICE = ('surface_unchecked',)
_OF_ROWS = ('joint_rate', 'sample_rate')  # no mistakes where rates are measured


class Message(NamedTuple):
    """One joint state and one wrench."""

    # joint_ns, wrench_ns: stamps [ns]; -1: no such message
    joint_ns: int
    # position, velocity: [m], [m/s]
    position: float
    velocity: float
    wrench_ns: int
    forces: tuple[float, float, float]  # F_e along x, y and z [N]


Change = Callable[[int, Message], Message]


class Mistake(NamedTuple):
    """What is commonly wrong, and the check that must say so."""

    text: str  # for the table
    expected: tuple[str, ...]  # names of checks; one of them must warn
    change: Change  # from number and message to the wrong message
    parameters: Mapping[str, Any] = {}  # of the estimator


def _moved(metres: float) -> Change:
    return lambda k, m: m._replace(position=m.position + metres)


def _late(milliseconds: int) -> Mistake:
    return Mistake(
        f'wrench {abs(milliseconds)} ms {"late" if milliseconds > 0 else "early"}',
        ('stamp_skew', 'stamp_skew_or_mass'),
        lambda k, m: m._replace(wrench_ns=m.wrench_ns + milliseconds * _NS))


def _in_bursts(k: int, message: Message) -> Message:
    """Stamp five wrenches when a buffer is read, 0.2 ms apart."""
    return message._replace(wrench_ns=message.wrench_ns - k % 5 * (2 * _NS - 200_000))


def _thinned(every: int) -> Change:
    return lambda k, m: m if k % every == 0 else m._replace(joint_ns=-1)


MISTAKES = (
    Mistake('wall at 0.4 m, location 0', ('surface',), _moved(0.4)),
    Mistake('wall at 10 mm, location 0', ('surface',), _moved(0.01)),
    Mistake('wall at -0.1 m, location 0', ('surface',), _moved(-0.1)),
    Mistake('force sign flipped', ('force_sign',),
            lambda k, m: m._replace(forces=(-m.forces[0], 0.0, 0.0))),
    Mistake('force on z, axis x', ('force_axis',),
            lambda k, m: m._replace(forces=(0.0, 0.0, m.forces[0]))),
    Mistake('position sign flipped', ('force_sign',),
            lambda k, m: m._replace(position=-m.position, velocity=-m.velocity)),
    *map(_late, (5, -5, 10, -10, 50, -50)),
    Mistake('every second force zero', ('two_forces',),
            lambda k, m: m if k % 2 else m._replace(forces=(0.0, 0.0, 0.0))),
    Mistake('stamps of the wrench in bursts', ('stamp_bursts',), _in_bursts),
    Mistake('joint states at 50 Hz', ('joint_rate',), _thinned(10)),
    Mistake('joint that stands still', ('joint_still',),
            lambda k, m: m._replace(position=0.01, velocity=0.0)),
    Mistake('noise 12 times the configured', ('force_noise',), lambda k, m: m,
            {'contact.force_noise': 0.05}),
    Mistake('sensor reads 20 N in free flight', ('force_bias',),
            lambda k, m: m._replace(forces=(m.forces[0] + 20.0, 0.0, 0.0))),
    Mistake('sample_rate 1000 for 500 Hz', ('sample_rate',), lambda k, m: m,
            {'sample_rate': 1000.0}),
)


def healthy_session(
    estimator: str, experiment: str, wall: tuple[float, float], seed: int
) -> tuple[ContactSession, list[ContactSample]]:
    """Run one closed loop in which nothing is wrong; wall: K_e [N/m] and B_e [N s/m]."""
    plant = build(PlantParameters, {
        **PAPER_NOISE, 'environment.stiffness': wall[0], 'environment.damping': wall[1],
        'seed': seed})
    session = ContactSession(build(EstimationParameters, {'estimator': estimator}))
    run = run_closed_loop(plant, session, experiment_named(experiment), _DURATION_S)
    return session, [result.sample for result in run.results]


def seconds_to_warning(
    samples: Sequence[ContactSample], mistake: Mistake, estimator: str
) -> float:
    """Return the time from contact to the report [s]; inf: none, NaN: it is no mistake here."""
    if estimator == MULTIPLE_MODEL and mistake.expected[0] in _OF_ROWS:
        return nan
    session = ContactSession(
        build(EstimationParameters, {'estimator': estimator, **mistake.parameters}),
        generate_reference=False)
    noise = np.random.default_rng(0).normal(0.0, 0.6, (len(samples), 2)).tolist()
    for k, (stamp, x, v, F) in enumerate(samples):
        message = Message(stamp + 1000 * _NS, x, v, stamp + 1000 * _NS, (F, *noise[k]))
        joint_ns, x, v, wrench_ns, forces = mistake.change(k, message)
        if joint_ns >= 0:
            session.add_motion(joint_ns, x, v)
        session.checks.wrenches.append((wrench_ns, *forces))
        session.add_wrench(wrench_ns, forces[0])
    touch = _touch_ns(samples) + 1000 * _NS
    found = [one.first_ns for one in session.checks.found.values()
             if one.warned.name in mistake.expected]
    return max(0.0, (min(found) - touch) * 1e-9) if found else inf


class _Example(NamedTuple):
    """A healthy loop on which the mistakes are made."""

    estimator: str
    experiment: str
    samples: list[ContactSample]

    @property
    def title(self) -> str:
        return f'{self.estimator}, {self.experiment}'


def run(options: Any) -> int:
    """Run healthy loops and mistakes, and print both tables."""
    progress = Progress('input_checks')
    said, examples = _healthy_loops(options.loops, options.seed, progress)
    times = []
    for k, mistake in enumerate(MISTAKES):
        times.append([seconds_to_warning(one.samples, mistake, one.estimator)
                      for one in examples])
        progress.show(0.5 + 0.5 * (k + 1) / len(MISTAKES), mistake.text)
    progress.done()
    false = [one for one in said if one['check'] not in _ADVICE]
    advice = [one for one in said if one['check'] in _ADVICE]
    print(f'{len(false)} false warnings in {options.loops} healthy loops')
    for title, some in (('false warnings', false), ('advice', advice)):
        if some:
            print_table(title, some)
    write_results(options, {'json': lambda: as_json({
        'healthy_loops': options.loops, 'false_warnings': false, 'advice': advice,
        'seconds': {mistake.text: [t if t < inf else None for t in row]
                    for mistake, row in zip(MISTAKES, times)}})})
    late = _print_times(examples, times)
    return int(bool(false or late))


def _healthy_loops(
    count: int, seed: int, progress: Progress
) -> tuple[list[dict[str, Any]], list[_Example]]:
    """Return all warnings of healthy loops, and those loops on which mistakes are made."""
    said, examples = [], []
    for k, (wall, experiment) in enumerate(islice(cycle(product(WALLS, EXPERIMENTS)), count)):
        estimator = ONLINE_ESTIMATORS[k % len(ONLINE_ESTIMATORS)]
        session, samples = healthy_session(estimator, experiment, wall, seed + k)
        if wall == WALLS[1]:
            examples.append(_Example(estimator, experiment, samples))
        world = {'estimator': estimator, 'experiment': experiment, 'K_e': wall[0]}
        said += [{**world, 'check': one.warned.name, 'warning': one.warned.text}
                 for one in session.checks.ordered_warnings()]
        progress.show((k + 1) / (2 * count), f'{k + 1} healthy loops')
    return said, examples


def _print_times(examples: Sequence[_Example], times: Sequence[Sequence[float]]) -> int:
    """Print the seconds from contact to each warning; return how many are late."""
    print_table('seconds from contact to warning', [
        {'mistake': mistake.text, 'check': mistake.expected[0],
         **{one.title: _seconds(t) for one, t in zip(examples, row)}}
        for mistake, row in zip(MISTAKES, times)])
    late = sum(t > _IN_TIME_S for row in times for t in row)
    print(f'{late} of {sum(map(len, times))} mistakes not reported within {_IN_TIME_S:g} s of '
          'contact')
    return late


def _touch_ns(samples: Sequence[ContactSample]) -> int:
    return next(s.stamp_ns for s in samples if s.force < -4.0)


def _seconds(value: float) -> str:
    return '-' if value != value else f'{value:.2f}' if value < inf else 'never'


def make_parser() -> Parser:
    """Return the parser of the command line."""
    parser = Parser(
        prog='studies input_checks',
        description='Count false warnings in healthy loops; time the warnings of mistakes.')
    parser.add_argument('--loops', type=int, default=20, help='healthy loops (20)')
    parser.add_argument('--seed', type=int, default=0, help='of the first loop (0)')
    parser.add_argument('--json', help='write the figures as JSON')
    return parser


main = command(make_parser, run)
