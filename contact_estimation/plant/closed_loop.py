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

"""Plant and estimation session closed over the reference, without ROS and as fast as it goes."""

from __future__ import annotations

from dataclasses import dataclass
from math import isnan

from .plant_parameters import PlantParameters
from .sensors import Sensors
from .world import ReferenceAt, Truth, World
from ..estimation.result import Result
from ..estimation.session import ContactSession
from ..exceptions import ParameterRangeError
from ..reference.experiment import Experiment
from ..reference.setpoints import Reference


@dataclass(frozen=True)
class ClosedLoopRun:
    """
    What a run has given, one entry a sample.

    Attributes
    ----------
    truths : list of Truth
        The world.
    results : list of Result
        Samples, estimates and references.

    """

    truths: list[Truth]
    results: list[Result]

    @property
    def last_contact(self) -> int | None:
        """Index of the last sample with true F_e < 0; None without contact."""
        touching = (k for k in range(len(self.truths) - 1, -1, -1) if self.truths[k].force < 0.0)
        return next(touching, None)


def extrapolate(since: float, reference: Reference) -> ReferenceAt:
    """
    Follow a reference until the next comes: its parabola for two sample periods at most.

    Parameters
    ----------
    since : float
        Time from which it holds [s].
    reference : Reference
        x_r with derivatives and F_r.

    Returns
    -------
    reference_at : callable
        Time [s] to (x_r, its rate, its acceleration, F_r).

    """
    x, v, a, F_r = reference

    def at(t: float) -> tuple[float, float, float, float]:
        tau = t - since
        return x + tau * (v + 0.5 * tau * a), v + tau * a, a, F_r

    return at


def push(force: float) -> ReferenceAt:
    """
    Push a bare arm until the next control force comes.

    Parameters
    ----------
    force : float
        Control force [N].

    Returns
    -------
    reference_at : callable
        Time [s] to (x_r, its rate, its acceleration, F_r): at rest but for the force.

    """
    return lambda t: (0.0, 0.0, 0.0, force)


def run_closed_loop(
    plant: PlantParameters, session: ContactSession, experiment: Experiment, duration: float
) -> ClosedLoopRun:
    """
    Run the experiment.

    The reference made of sample k is followed from sample k + 1 on, as over ROS. A bare arm
    (`robot.control` is force) is pushed by the estimator's control force: that of sample k, held
    from sample k to k + 1, as a robot's own servo at the sample rate does.

    Parameters
    ----------
    plant : PlantParameters
        The simulated world.
    session : ContactSession
        Fresh.
    experiment : Experiment
        What is wanted.
    duration : float
        Time to run [s].

    Returns
    -------
    run : ClosedLoopRun
        One entry a sample.

    Raises
    ------
    ParameterRangeError
        If a bare arm meets an estimator that does not control.

    """
    bare = plant.robot.control == 'force'
    if bare:
        require_control(session)
    period = 1.0 / plant.sample_rate
    period_ns = round(1e9 * period)
    begin = experiment.desired(0.0)
    world, sensors = World(plant, begin.position), Sensors(plant)
    reference = Reference(begin.position, 0.0, 0.0, 0.0)
    run, pushed = ClosedLoopRun([], []), push(0.0)
    for k in range(round(duration * plant.sample_rate)):
        follow = pushed if bare else extrapolate(k * period, reference)
        truth = world.truth(follow)
        force, position, velocity = sensors.measure(truth)
        session.add_desired((k + 1) * period_ns, experiment.desired((k + 1) * period))
        session.add_motion(k * period_ns, position, velocity)
        (result,) = session.add_wrench(k * period_ns, force)
        run.truths.append(truth)
        run.results.append(result)
        if bare:
            follow = pushed = push(session.pipeline.estimator.control_force)
        world.advance(period, follow)
        if result.reference is not None:
            reference = result.reference
    return run


def require_control(session: ContactSession) -> None:
    """
    Refuse a bare arm that nobody would control.

    Parameters
    ----------
    session : ContactSession
        With the estimator that runs.

    Raises
    ------
    ParameterRangeError
        If its estimator makes no control force.

    """
    if isnan(session.pipeline.estimator.control_force):
        raise ParameterRangeError(
            'robot.control force needs an estimator that makes a control force: expected mrac, '
            f'got {session.parameters.estimator}; use it, or robot.control impedance'
        )
