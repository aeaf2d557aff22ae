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
Measure the indicator of model fit: reports of five wrong models, false alarms on right ones.

The worlds are those of the estimators study. Each mismatch appears at the strength given in its
name, and scaled so that the residual which the best spring and damper leaves is 5 times the noise.
"""

from __future__ import annotations

from dataclasses import replace
from math import inf
from typing import Any, Callable, NamedTuple

import numpy as np

from .study_worlds import Array, Course, make_world, RATE, Scenario, SCENARIOS, Sensor, World
from .table import print_table
from ..commands.command_line import command, Parser
from ..commands.progress import Progress
from ..estimation.parameters import EstimationParameters
from ..estimation.pipeline import EstimationPipeline
from ..estimators import ESTIMATORS
from ..exceptions import ParameterRangeError, UnknownNameError

LEVEL = 5.0
"""Residual over noise from which a mismatch must be reported."""

_IN_TIME_S = 2.0
_HEALTHY_HOLD_S = 20.0
_STRATA = 40  # of the stiffness
_SLOW = 4e-4  # speed below which friction is smaller [m/s]
_WALL_HZ = 0.7
_EDGE_S = 0.1
_FARTHEST = 3e-3  # of the surface from x_e: the tool must come free [m]


class Disturbance(NamedTuple):
    """
    What a wall does besides being a spring and a damper at x_e.

    Attributes
    ----------
    force : ndarray, shape (N,)
        Added to K_e delta + B_e v [N].
    shift : ndarray or float
        By which the surface is moved [m].

    """

    force: Array
    shift: Array | float = 0.0


def _friction(course: Course) -> Disturbance:
    return Disturbance(5.0 * np.tanh(course.rate / _SLOW))


def _depth_damping(course: Course) -> Disturbance:
    """Damping proportional to depth, equal to B_e at the mean depth, in place of B_e."""
    depth = course.delta / np.mean(course.delta[course.delta > 0.0])
    return Disturbance(course.damping * (depth - 1.0) * course.rate)


def _moving_wall(course: Course) -> Disturbance:
    phase = 2.0 * np.pi * _WALL_HZ * course.t
    shift, rate = 1e-3 * np.sin(phase), 2e-3 * np.pi * _WALL_HZ * np.cos(phase)
    return Disturbance(-course.stiffness * shift - course.damping * rate, shift)


def _mass(course: Course) -> Disturbance:
    return Disturbance(2.0 * np.gradient(course.rate, course.t))


def _offset(course: Course) -> Disturbance:
    return Disturbance(5e-4 * course.stiffness, -5e-4)


MISMATCHES: dict[str, tuple[Callable[[Course], Disturbance], str]] = {
    'friction of 5 N': (_friction, 'friction'),
    'Hunt-Crossley damping': (_depth_damping, 'Hunt-Crossley'),
    'wall moving by 1 mm': (_moving_wall, 'move'),
    'wall mass of 2 kg': (_mass, 'mass'),
    'x_e off by 0.5 mm': (_offset, 'environment.location'),
}
"""Disturbance, and the word by which the indicator names it."""


class DisturbedWall:
    """
    The force of a wall with a mismatch.

    Parameters
    ----------
    disturb : callable
        Of MISMATCHES.
    level : float or None
        The disturbance is scaled so that the best spring and damper leaves this many times the
        noise, as far as the tool still comes free; None: not scaled.

    Attributes
    ----------
    level : float
        What the best spring and damper leaves of the last course, over the noise.

    """

    def __init__(
        self, disturb: Callable[[Course], Disturbance], level: float | None = None
    ) -> None:
        self._disturb, self._wanted, self.level = disturb, level, 0.0

    def __call__(self, course: Course, sensor: Sensor) -> Array:
        """
        Return the force on the wall before it is clipped at 0 [N].

        Parameters
        ----------
        course : Course
            Of the tool.
        sensor : Sensor
            Whose noise counts.

        """
        force, shift = self._disturb(course)
        level = _unexplained(course, force) / sensor.noise
        scale = self._wanted / level if self._wanted else 1.0
        most = float(np.max(np.abs(shift)))
        scale = min(scale, _FARTHEST / most) if most else scale
        self.level = scale * level
        pressing = course.stiffness * course.delta + course.damping * course.rate + scale * force
        return np.where(course.delta > scale * shift, pressing, 0.0)


def _unexplained(course: Course, force: Array) -> float:
    """Return the rms of what a spring and damper leaves in 2 s of contact, the edge left out."""
    since = course.t - course.contacts[0][0]
    inside = (since > _EDGE_S) & (since < _IN_TIME_S)
    columns = np.column_stack([course.delta, course.rate])[inside]
    columns /= np.sqrt(np.mean(columns**2, axis=0))
    theta = np.linalg.lstsq(columns, force[inside], rcond=None)[0]
    return float(np.sqrt(np.mean((force[inside] - columns @ theta) ** 2)))


def make_parser() -> Parser:
    """Build the command line of the study."""
    parser = Parser(
        prog='benchmarks.model_fit_study',
        description='Measure the indicator of model fit in the worlds of the estimators study: '
        'how often and when five mismatches are reported, as they are and at 5 times the noise, '
        'and false alarms in hours of healthy contact.',
    )
    parser.add_argument('--hours', type=float, default=1.0, help='healthy hours simulated (1)')
    parser.add_argument('--worlds', type=int, default=12, help='of each mismatch (12)')
    parser.add_argument('--estimator', help='one of ' + ', '.join(ESTIMATORS) + ' (the default)')
    parser.add_argument('--seed', type=int, default=0, help='of all worlds (0)')
    return parser


def run(options: Any) -> int:
    """
    Run the study and print it.

    Parameters
    ----------
    options : argparse.Namespace
        Options of `make_parser`.

    Returns
    -------
    code : int
        0.

    Raises
    ------
    ContactEstimationError
        If an option is not valid.

    """
    for name, least in (('hours', 0.0), ('worlds', 1), ('seed', 0)):
        if not getattr(options, name) >= least:
            raise ParameterRangeError(
                f'--{name} must be >= {least:g}, got {getattr(options, name):g}')
    name = options.estimator or EstimationParameters().estimator
    if name not in ESTIMATORS:
        raise UnknownNameError.among('estimator', name, ESTIMATORS)
    print_table(f'{name}: mismatches in {options.worlds} worlds each', [
        _row(mismatch, level, name, options) for mismatch in MISMATCHES for level in (None, LEVEL)
    ])
    print_table(f'{name}: healthy walls', [_healthy_row(name, options.hours, options.seed)])
    return 0


def _row(mismatch: str, level: float | None, name: str, options: Any) -> dict[str, Any]:
    """Report on the worlds in which the mismatch is at least LEVEL times the noise."""
    disturb, word = MISMATCHES[mismatch]
    wall = DisturbedWall(disturb, level)
    scenario = replace(SCENARIOS['excited'], contacts=1, pressing=wall)
    reports = []
    for index in range(options.worlds):
        world = make_world(scenario, index, options.worlds, options.seed)
        if wall.level >= 0.99 * LEVEL:
            reports.append(first_report(world, name))
    delays = np.array([delay for delay, _ in reports])
    return {
        'mismatch': mismatch,
        'residual': f'{level:g} x noise' if level else f'>= {LEVEL:g} x noise',
        'worlds': len(reports),
        'within 2 s': int(np.sum(delays <= _IN_TIME_S)),
        'median s': float(np.median(delays)) if len(delays) else None,
        'named': sum(word in text for _, text in reports),
    }


def first_report(world: World, name: str) -> tuple[float, str]:
    """
    Return when a mismatch is reported, and what the worst report says.

    Parameters
    ----------
    world : World
        With one contact.
    name : str
        Of the estimator.

    Returns
    -------
    delay : float
        From the touch-down [s]; inf if nothing is reported.
    text : str
        Of the worst report.

    """
    pipeline = EstimationPipeline(EstimationParameters(estimator=name, sample_rate=RATE))
    delay = inf
    for sample in world.samples:
        pipeline.process((sample,))
        if pipeline.model_fit.count and delay == inf:
            delay = sample.stamp_ns * 1e-9 - world.contacts[0][0]
    return delay, pipeline.model_fit.worst.text


def _healthy_row(name: str, hours: float, seed: int) -> dict[str, Any]:
    """Count the alarms in worlds with two contacts each, every second one excited."""
    parameters = EstimationParameters(estimator=name, sample_rate=RATE)
    scenario = Scenario('healthy', excited=None, hold_s=_HEALTHY_HOLD_S)
    progress = Progress('benchmarks.model_fit_study')
    seconds, alarms, greatest, index = 0.0, 0, 0.0, 0
    while seconds < 3600.0 * hours:
        world = make_world(scenario, index % _STRATA, _STRATA, seed + index // _STRATA)
        pipeline = EstimationPipeline(parameters)
        for estimate in pipeline.process(world.samples):
            greatest = max(greatest, estimate.model_fit)
        seconds, index = seconds + float(world.t[-1]), index + 1
        alarms += pipeline.model_fit.count
        progress.show(seconds / (3600.0 * hours), f'{alarms} alarms')
    progress.done()
    return {'hours': seconds / 3600.0, 'walls': index, 'false alarms': alarms,
            'greatest residual x noise': greatest}


main = command(make_parser, run)


if __name__ == '__main__':
    raise SystemExit(main())
