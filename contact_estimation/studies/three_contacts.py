# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
Eq. (6) on a simulated tool that touches a floor with two points and a wall with a third.

python -m contact_estimation.studies three_contacts --output DIR
"""

from __future__ import annotations

import json
from math import cos, pi, sin
from pathlib import Path
from typing import Any, Mapping, NamedTuple, Sequence

import numpy as np

from ..commands.command_line import command, Parser
from ..estimators.contact_points import (
    Array, contact_forces, ContactGeometry, point_motions, ToolMotion, total_wrench)
from ..estimators.contact_points_estimator import (
    ContactPointsEstimate, ContactPointsEstimator, ContactPointsParameters, ContactPointsSample)
from ..figures import require_matplotlib
from ..reference.reference_generator import quintic

K_E, B_E, MU = 4800.0, 200.0, 0.3
RATE = 500.0
DURATION = 10.0
POINTS = ('front foot', 'rear foot', 'nose')
GEOMETRY = ContactGeometry(
    points=np.array([[0.03, 0.0, -0.04], [-0.03, 0.0, -0.04], [0.05, 0.0, 0.01]]),
    surfaces=np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.15, 0.0, 0.0]]),
    normals=np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 1.0], [-1.0, 0.0, 0.0]]),
)

FORCE_NOISE = 1.0  # +- [N], uniform, as the paper's
POSITION_NOISE, VELOCITY_NOISE = 1e-5, 1e-4  # standard deviations [m], [m/s]

_START = (0.0, 0.0, 0.055)
_PITCH = 0.12  # [rad]: the front foot touches first
# (axis, begin [s], duration [s], way [m or rad]); axis 3 is the pitch
_MOVES = (
    (2, 0.4, 1.2, -0.0165),  # down: the front foot touches
    (3, 2.2, 0.8, -_PITCH),  # level: the rear foot touches too
    (0, 3.2, 1.6, 0.106),  # slide along the floor until the nose touches the wall
    (1, 5.2, 1.6, 0.08),  # slide along both
    (0, 7.4, 0.6, -0.04),  # away from the wall
    (2, 8.6, 0.8, 0.04),  # up
)
# (axis, begin, end [s], amplitude [m], angular frequency [rad/s]): begins and ends at rest
_SWINGS = (
    (2, 1.7, 1.7 + 4.0 * pi / 10.0, 1e-3, 20.0),
    (2, 3.0, 3.0 + 18.0 * pi / 10.0, 1e-3, 20.0),
    (0, 5.0, 5.0 + 16.0 * pi / 23.0, 1e-3, 23.0),
)


class Instant(NamedTuple):
    """One instant of the simulation."""

    t: float  # time [s]
    sample: ContactPointsSample  # measured force and motion
    delta: Array  # (3,) True penetrations [m]
    forces: Array  # (3, 3) True force at each point [N]


def motion_at(t: float) -> ToolMotion:
    """Return the prescribed pose and twist of the tool; t: time [s]."""
    place, rate = [*_START, _PITCH], [0.0] * 4
    for axis, begin, duration, way in _MOVES:
        x, v, _ = quintic(0.0, way, duration, t - begin)
        place[axis] += x
        rate[axis] += v
    for axis, begin, end, amplitude, omega in _SWINGS:
        if begin < t < end:
            phase = omega * (t - begin)
            place[axis] += amplitude * (1.0 - cos(phase)) * (1.0 if axis == 0 else -1.0)
            rate[axis] += amplitude * omega * sin(phase) * (1.0 if axis == 0 else -1.0)
    c, s = cos(place[3]), sin(place[3])
    rotation = np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
    return ToolMotion(
        np.array(place[:3]), rotation, np.array(rate[:3]), np.array([0.0, rate[3], 0.0])
    )


def simulate(seed: int = 0) -> list[Instant]:
    """Simulate the measurements of force sensor and robot."""
    noise = np.random.default_rng(seed)
    return [_instant(k, noise) for k in range(round(DURATION * RATE))]


def _instant(k: int, noise: np.random.Generator) -> Instant:
    motion = motion_at(k / RATE)
    points = point_motions(GEOMETRY, motion)
    forces = contact_forces(GEOMETRY, points, K_E, B_E, MU)
    force, _ = total_wrench(points.arms, forces)
    measured = motion._replace(
        position=motion.position + noise.normal(0.0, POSITION_NOISE, 3),
        velocity=motion.velocity + noise.normal(0.0, VELOCITY_NOISE, 3),
    )
    felt = force + noise.uniform(-FORCE_NOISE, FORCE_NOISE, 3)
    sample = ContactPointsSample(round(k * 1e9 / RATE), felt, measured)
    return Instant(k / RATE, sample, points.delta, forces)


VARIANTS: dict[str, ContactPointsParameters] = {
    'friction estimated': ContactPointsParameters(),
    'friction known': ContactPointsParameters(initial_friction=MU, friction_std=0.0),
    'friction left out': ContactPointsParameters(initial_friction=0.0, friction_std=0.0),
}
ALL_TOUCH_S = 6.8
"""Time at which all points slide [s]."""


class Errors(NamedTuple):
    """Signed errors of one estimate: K and B in percent, mu as it is."""

    stiffness_percent: float
    damping_percent: float
    friction: float


def estimate(instants: Sequence[Instant], variant: str) -> list[ContactPointsEstimate]:
    """Run one variant of the estimator over a simulation."""
    estimator = ContactPointsEstimator(GEOMETRY, VARIANTS[variant])
    return [estimator.update(instant.sample) for instant in instants]


def errors_of(estimate: ContactPointsEstimate) -> Errors:
    """Return the errors of an estimate against the simulated parameters."""
    return Errors(
        100.0 * (estimate.stiffness / K_E - 1.0), 100.0 * (estimate.damping / B_E - 1.0),
        estimate.friction - MU,
    )


_INK, _TRUE = '#1f2933', '#c2410c'
_COLOURS = ('#0b6e99', '#6b8e23', '#8e5aa8')
_LIMITS = {'stiffness': (0.7 * K_E, 1.3 * K_E), 'damping': (0.0, 2.2 * B_E),
           'friction': (-0.05, 0.5)}


def plot_three_contacts(
    instants: Sequence[Instant],
    runs: Mapping[str, Sequence[ContactPointsEstimate]],
    path: Path,
) -> None:
    """Plot the force at each point, the measured force and the estimates of each variant."""
    pyplot = require_matplotlib()
    figure, axes = pyplot.subplots(5, 1, figsize=(9.0, 11.0), sharex=True, layout='constrained')
    figure.suptitle('Three contact points, eq. (6)', color=_INK, x=0.01, ha='left', fontsize=12)
    t = np.array([i.t for i in instants])
    _plot_points(axes[0], t, instants)
    _plot_force(axes[1], t, instants)
    for axis, name, true, label in (
        (axes[2], 'stiffness', K_E, 'K_e [N/m]'),
        (axes[3], 'damping', B_E, 'B_e [N s/m]'),
        (axes[4], 'friction', MU, 'mu'),
    ):
        _plot_estimates(axis, t, runs, name, true)
        axis.set_ylabel(label)
    axes[4].set_xlabel('time [s]')
    for axis in axes:
        axis.spines[['top', 'right']].set_visible(False)
        axis.grid(color='#e4e7eb', linewidth=0.6)
        axis.legend(frameon=False, fontsize=8, loc='upper left', ncols=4)
    figure.savefig(path, dpi=130)
    pyplot.close(figure)


def _plot_points(axis: Any, t: np.ndarray, instants: Sequence[Instant]) -> None:
    forces = np.array([np.linalg.norm(i.forces, axis=1) for i in instants])  # (T, 3) [N]
    for column, (name, colour) in enumerate(zip(POINTS, _COLOURS)):
        axis.plot(t, forces[:, column], color=colour, linewidth=1.0, label=name)
    axis.set_ylabel('force at a point [N]')


def _plot_force(axis: Any, t: np.ndarray, instants: Sequence[Instant]) -> None:
    felt = np.array([i.sample.force for i in instants])  # (T, 3) [N]
    for column, (name, colour) in enumerate(zip('xyz', _COLOURS)):
        axis.plot(t, felt[:, column], color=colour, linewidth=0.6, label=f'F_{name} measured')
    axis.set_ylabel('sum, with noise [N]')


def _plot_estimates(
    axis: Any, t: np.ndarray, runs: Mapping[str, Sequence[ContactPointsEstimate]], name: str,
    true: float,
) -> None:
    axis.axhline(true, color=_TRUE, linewidth=1.0, label=f'true {true:g}')
    for (variant, estimates), colour in zip(runs.items(), _COLOURS):
        value = np.array([getattr(e, name) for e in estimates])
        axis.plot(t, value, color=colour, linewidth=1.2, label=variant)
    axis.set_ylim(*_LIMITS[name])


def run(options: Any) -> int:
    """Simulate, estimate, print the results and plot them."""
    instants = simulate(options.seed)
    runs = {variant: estimate(instants, variant) for variant in VARIANTS}
    print(f'eq. (6), {len(POINTS)} points, {DURATION:g} s at {RATE:g} Hz, seed {options.seed}: '
          f'K_e {K_E:g} N/m, B_e {B_E:g} N s/m, mu {MU:g}')
    _print_touches(instants)
    _print_estimates(runs, round(ALL_TOUCH_S * RATE), f'at {ALL_TOUCH_S:g} s, all three sliding')
    _print_estimates(runs, -1, 'after the last contact')
    if options.output:
        folder = Path(options.output)
        folder.mkdir(parents=True, exist_ok=True)
        plot_three_contacts(instants, runs, folder / 'three_contacts.png')
        summary = {name: _summary(estimates[-1]) for name, estimates in runs.items()}
        (folder / 'three_contacts.json').write_text(json.dumps(summary, indent=1) + '\n')
        print(f'wrote {folder / "three_contacts.png"} and three_contacts.json')
    return 0


def _print_touches(instants: Sequence[Instant]) -> None:
    for point, name in enumerate(POINTS):
        presses = [i.t for i in instants if np.any(i.forces[point])]
        most = max(float(np.linalg.norm(i.forces[point])) for i in instants)
        print(f'  {name:<12} touches from {presses[0]:.2f} to {presses[-1]:.2f} s, '
              f'at most {most:.1f} N')


def _print_estimates(
    runs: Mapping[str, Sequence[ContactPointsEstimate]], place: int, when: str
) -> None:
    print(f'{when}:')
    for name, estimates in runs.items():
        e, off = estimates[place], errors_of(estimates[place])
        print(f'  {name:<19} K {e.stiffness:7.1f} +- {e.stiffness_std:.1f} N/m '
              f'({off.stiffness_percent:+.2f} %)  B {e.damping:6.1f} +- {e.damping_std:.1f} N s/m '
              f'({off.damping_percent:+.2f} %)  mu {e.friction:.4f} +- {e.friction_std:.4f}')


def _summary(e: ContactPointsEstimate) -> dict[str, float]:
    return {**{name: getattr(e, name) for name in ('stiffness', 'damping', 'friction')},
            **{f'{k}_error' if k == 'friction' else k.replace('_percent', '_error_percent'): v
               for k, v in errors_of(e)._asdict().items()}}


def make_parser() -> Parser:
    """Return the parser of the command line of the example."""
    parser = Parser(
        prog='three_contacts',
        description='Estimate K_e, B_e and friction from the force on a tool with three contact '
        'points that touch, slide and release (eq. 6), with friction estimated, known and '
        'ignored.',
    )
    parser.add_argument('--output', metavar='DIR', help='folder for figure and JSON')
    parser.add_argument('--seed', type=int, default=0, help='seed of the noise (0)')
    return parser


main = command(make_parser, run)
