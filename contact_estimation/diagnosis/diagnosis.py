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

"""The diagnosis: noise, recalibration, location, selection, held-out proof, verdict."""

from __future__ import annotations

from typing import Callable, Sequence

import numpy as np

from .conclude.conclusion import Conclusion, EXPLAINED, LEFT
from .conclude.finding import Diagnosis
from .conclude.location import guess_port
from .fit.fitting import cost_of, Fit, fit
from .fit.free_run import free_run
from .fit.nuisances import doubt
from .fit.selection import Finding, penalty, select, SHARE, THRESHOLD
from .observe.case import Case, Recording
from .observe.model import Model
from .observe.observed import observe
from .observe.ports import Ports
from ..plant.between_samples import BETWEEN
from ..plant.plant_parameters import PlantParameters

Progress = Callable[[str], None]

_FIRST = 2  # effects that are looked for to tell how a force goes on between its samples


def diagnose(
    recordings: Sequence[Recording], holdouts: Sequence[Recording], nominal: PlantParameters,
    seed: int = 0, progress: Progress = lambda text: None,
) -> Diagnosis:
    """
    Compare recordings with the model that is said to describe them.

    Parameters
    ----------
    recordings : sequence of Recording
        Fitted together.
    holdouts : sequence of Recording
        Never fitted; without any, a part of each recording is held out.
    nominal : PlantParameters
        The simulation's model.
    seed : int
        Of the bootstraps.
    progress : callable
        Told in words what is being done.

    Returns
    -------
    diagnosis : Diagnosis
        Verdict, names, parameters, proof.

    Raises
    ------
    RecordingError
        If a recording has too little data, no contact or a constant signal.

    """
    model = Model.of(nominal)
    progress('noise and alignment')
    cases = [Case.prepare(recording, model, hold=not holdouts) for recording in recordings]
    others = [Case.prepare(recording, model, hold=False) for recording in holdouts]
    progress('recalibration')
    ports = _ports(cases)
    base, at_nominal = _recalibrate(ports, model), cost_of(ports, model)
    finding = None
    if all(port.driven_by_force(model) for port in ports):
        finding = select(ports, base, progress, most=_FIRST)
        between = _between_samples(finding, cases)
        if between != cases[0].port.observed.between:
            cases, others = ([case.with_force(between, model) for case in group]
                             for group in (cases, others))
            ports, finding = _ports(cases), None
            base, at_nominal = _recalibrate(ports, model), cost_of(ports, model)
        elif len(finding.best.model.effects) == _FIRST:
            finding = None  # there may be more of them
    finding = finding or select(ports, base, progress)
    finding, cases = _refine(finding, cases, model, progress)
    ports = _ports(cases)
    odd_robot = _robot_is_odd(finding, ports)
    if odd_robot:
        progress('looking past the robot')
        finding = _past_the_robot(finding, ports, progress)
    # The worst first: it is the one to be located and shown.
    cases.sort(key=lambda case: -cost_of([case.port], finding.base.model) / case.port.count)
    conclusion = Conclusion(model, at_nominal, finding, cases, others, seed, odd_robot)
    return conclusion.draw(progress)


def _ports(cases: Sequence[Case]) -> list[Ports]:
    return [case.port for case in cases]


def _between_samples(finding: Finding, cases: Sequence[Case]) -> str:
    """Tell how the force that drives a wall goes on between samples: as asks for least physics."""
    best, costs = finding.best, {}
    for name in BETWEEN:
        ports = [case.with_force(name, finding.base.model).port for case in cases]
        fits = [fit(ports, found.model) for found in (finding.base, best)]
        costs[name] = min(found.cost + penalty(found.model) for found in fits)
    likeliest = next(iter(BETWEEN))
    least = SHARE * max(costs[likeliest] - best.filled, 0.0)
    costs[likeliest] -= max(THRESHOLD * best.filled, least)
    return min(costs, key=lambda name: costs[name])


def _recalibrate(ports: Sequence[Ports], model: Model) -> Fit:
    rough = fit(ports, model)
    for port in ports:
        doubt(port, rough.model)
    return fit(ports, rough.model)


def _robot_is_odd(finding: Finding, ports: Sequence[Ports]) -> bool:
    """Tell whether much is left in the motion alone, such as of commands that come late."""
    best = finding.best
    if best.cost < (1.0 + LEFT) * best.filled or best.cost < (1.0 - EXPLAINED) * finding.base.cost:
        return False
    return all(guess_port(port, best.model) == 'robot' for port in ports)


def _past_the_robot(
    finding: Finding, ports: Sequence[Ports], progress: Progress
) -> Finding:
    """Take what the motion does not explain for its noise, and look at the force."""
    for port in ports:
        port.distrust_motion(finding.best.model)
    base = _recalibrate(ports, finding.base.model)
    return select(ports, base, progress, with_robot=False)


def _refine(
    finding: Finding, cases: list[Case], model: Model, progress: Progress
) -> tuple[Finding, list[Case]]:
    """
    Smooth the motion anew with what is known now, and look again.

    The free run of a good model follows the sharp bends of the motion, so that less bandwidth is
    needed for the rest and velocities get better; friction near standstill needs that.
    """
    runs = all(case.port.observed.has_dynamics(model.nominal) for case in cases)
    if not finding.best.model.effects or not runs:
        return finding, cases
    progress('smoothing the motion with what was found')
    best, again = finding.best.model, []
    for case in cases:
        o = case.port.observed
        carried = free_run(best, o).position
        if not np.isfinite(carried).all() or np.max(np.abs(carried)) > 1e3 * np.max(np.abs(o.x)):
            return finding, cases  # run away: nothing to learn from it
        better = observe(case.recording.signals, model.nominal, carried, o.between)
        if better.cutoff > o.cutoff:
            return finding, cases
        again.append(Case.of(case.recording, better, model, case.held_out))
    ports = _ports(again)
    base = _recalibrate(ports, finding.base.model)
    named = fit(ports, best)
    if named.cost > finding.best.cost or not named.model.plausible():
        return finding, cases
    left = named.cost - named.filled
    if left > 0.5 * THRESHOLD * named.filled and left > 0.02 * (
            base.cost - base.filled):
        return select(ports, base, progress), again
    return finding._replace(base=base, best=named), again
