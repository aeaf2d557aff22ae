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
Which effects the recordings call for: forward search, exchange, pruning.

An effect is taken only if it explains more than chance and the limits of the method do (threshold
calibrated on clean worlds, see `THRESHOLD`), and a fair share of what is left to explain.
"""

from __future__ import annotations

from typing import Callable, NamedTuple, Sequence

import numpy as np

from .fitting import cost_of, Fit, fit, fit_to_end, step
from .scales import measure_scales
from ..observe.model import Model
from ..observe.ports import Ports
from ...physics import EFFECTS
from ...physics.robot_effect import RobotEffect

THRESHOLD = 0.1
"""Least gain of an effect, as a share of the number of residuals: calibrated false alarms."""

PRICE = 25.0
"""Of a parameter more, in units of cost; BIC would ask 8, but laws contain one another."""

SHARE = 0.3
"""Least share of the misfit above the noise that a further effect must explain."""

_MOST_EFFECTS = 3
_FOLLOWED, _TO_END = 6, 2  # candidates that go on in each round, and to the end
_FAR = 2.0  # times the noise: power of the residuals

Progress = Callable[[str], None]


class Finding(NamedTuple):
    """
    What a search has found.

    Attributes
    ----------
    base : Fit
        Recalibrated, without effects.
    best : Fit
        With the effects taken; `base` itself where none was.
    rivals : dict of str to list of Fit
        For each effect taken, fits with another in its place, best first.
    candidates : dict of str to float
        Share of the cost that one effect alone takes away, by name: the evidence.

    """

    base: Fit
    best: Fit
    rivals: dict[str, list[Fit]]
    candidates: dict[str, float]


def scale_of(found: Fit) -> float:
    """
    Measure how much larger than the noise the residuals are.

    Parameters
    ----------
    found : Fit
        The best known.

    Returns
    -------
    scale : float
        Variance, at least 1.

    """
    return max(1.0, found.cost / found.filled)


def penalty(model: Model) -> float:
    """
    Price the parameters of the effects, higher than BIC does: laws contain one another.

    Parameters
    ----------
    model : Model
        With effects.

    Returns
    -------
    penalty : float
        In units of cost for residuals of variance 1.

    """
    return PRICE * float(np.count_nonzero(model.free) - model.base_count)


def candidates_for(model: Model, with_robot: bool) -> list[str]:
    """
    List the effects that may be added.

    Parameters
    ----------
    model : Model
        What there is already.
    with_robot : bool
        Whether the recording has a reference trajectory.

    Returns
    -------
    names : list of str
        Robot effects only with a robot, unilateral ones only with such a wall.

    """
    wall = model.nominal.environment
    names = []
    for name, cls in EFFECTS.items():
        if name in model.effects:
            continue
        if issubclass(cls, RobotEffect) and not with_robot:
            continue
        if not wall.unilateral and cls.needs_touch:
            continue
        if cls.base_parameter == 'inertia' and model.with_inertia:
            continue
        names.append(name)
    return names


def search(
    ports: Sequence[Ports], base: Fit, names: Sequence[str], progress: Progress
) -> list[Fit]:
    """
    Fit each candidate beside what the model has already.

    Parameters
    ----------
    ports : sequence of Ports
        Recordings, fitted together.
    base : Fit
        Without the candidates.
    names : sequence of str
        Candidates.
    progress : callable
        Told the name of each.

    Returns
    -------
    fits : list of Fit
        Plausible ones, best first by penalised cost; the followed ones are fitted to the end.

    """
    scales = measure_scales(ports, base)
    started: list[tuple[float, Model]] = []
    for name in names:
        progress(name)
        begun = [base.model.with_effect(name, values) for values in EFFECTS[name].starts(scales)]
        found = fit(ports, _approach(ports, begun), steps=4)
        started.append((found.cost, found.model))
    started.sort(key=lambda pair: pair[0] + penalty(pair[1]))
    fits = [fit(ports, model, steps=8) for _, model in started[:_FOLLOWED]]
    fits.sort(key=lambda found: found.cost)
    fits[:_TO_END] = [fit_to_end(ports, found) for found in fits[:_TO_END]]
    rest = [Fit(model, cost, base.residuals, base.filled)
            for cost, model in started[_FOLLOWED:]]
    fits = [found for found in fits + rest if found.model.plausible()]
    scale = scale_of(min(fits, key=lambda found: found.cost)) if fits else 1.0
    return sorted(fits, key=lambda found: found.cost + scale * penalty(found.model))


def _approach(ports: Sequence[Ports], begun: Sequence[Model]) -> Model:
    """Tell from where to search: near the best of the starts."""
    steps = [step(ports, model) for model in begun]
    best = min(range(len(steps)), key=lambda k: steps[k][0])
    near = steps[best][1]
    driven = all(port.driven_by_force(near) for port in ports)
    if not driven or cost_of(ports, near) < _FAR * sum(port.count for port in ports):
        return near
    # Far off the truth a wall that resonates is led astray by its own memory, and one step is
    # too long where a law bends much.
    brief = fit(ports, begun[best], steps=8, briefly=True).model
    return min((*begun, near, brief), key=lambda model: cost_of(ports, model))


def select(
    ports: Sequence[Ports], base: Fit, progress: Progress = lambda name: None,
    most: int = _MOST_EFFECTS, with_robot: bool = True,
) -> Finding:
    """
    Search for the effects that a recording calls for.

    Parameters
    ----------
    ports : sequence of Ports
        Recordings, fitted together.
    base : Fit
        Recalibrated model without effects.
    progress : callable
        Told what is being tried.
    most : int
        Effects that may be taken.
    with_robot : bool
        Whether those of the robot may be among them, where there is one.

    Returns
    -------
    finding : Finding
        What was taken, and what else was tried.

    """
    with_robot = with_robot and any(port.observed.reference is not None for port in ports)
    best, evidence = base, {}
    rivals: dict[str, list[Fit]] = {}
    for count in range(most):
        if count > 0 and best.cost < best.filled * (1.0 + 0.5 * THRESHOLD):
            break  # nothing is left to explain
        names = candidates_for(best.model, with_robot)
        fits = search(ports, best, names, progress)
        if count == 0:
            evidence = {found.model.effects[-1]: 1.0 - found.cost / base.cost for found in fits}
        if not fits or not enough(best, fits[0]):
            break
        rivals[fits[0].model.effects[-1]] = fits[1:]
        best = fits[0]
        if count > 0:
            best, rivals = exchange(ports, best, rivals, with_robot, progress)
    best, rivals = prune(ports, best, rivals)
    best = fit(ports, best.model) if best.model.effects else base
    return Finding(base, best, rivals, evidence)


def enough(before: Fit, after: Fit) -> bool:
    """
    Tell whether an effect more is worth it.

    Parameters
    ----------
    before, after : Fit
        Without and with it.

    Returns
    -------
    enough : bool
        The gain is significant and a fair share of what was unexplained.

    """
    gain = before.cost - after.cost
    scale = scale_of(after)
    count = after.filled
    excess = max(before.cost - count, 0.0)
    least = scale * (THRESHOLD * count + penalty(after.model) - penalty(before.model))
    return gain > least and gain > SHARE * excess


def exchange(
    ports: Sequence[Ports], best: Fit, rivals: dict[str, list[Fit]], with_robot: bool,
    progress: Progress,
) -> tuple[Fit, dict[str, list[Fit]]]:
    """
    Undo early choices: replace each effect by any other beside the rest.

    Parameters
    ----------
    ports, best, rivals, with_robot, progress
        As in `select`.

    Returns
    -------
    best : Fit
        No single exchange makes it better.
    rivals : dict
        For each effect, what could stand in its place.

    """
    for name in best.model.effects[:-1]:
        rest = fit(ports, best.model.without(name))
        names = candidates_for(rest.model, with_robot)
        fits = search(ports, rest, names, progress)
        # A wider law always fits a little better: it has to pay for its parameters.
        least = 10.0 + (penalty(fits[0].model) - penalty(best.model) if fits else 0.0)
        if fits and fits[0].cost < best.cost - scale_of(best) * least:
            best = fits[0]
            rivals.pop(name, None)
            rivals[best.model.effects[-1]] = fits[1:]
        else:
            rivals[name] = [found for found in fits if found.model.effects[-1] != name]
    return best, rivals


def prune(
    ports: Sequence[Ports], best: Fit, rivals: dict[str, list[Fit]]
) -> tuple[Fit, dict[str, list[Fit]]]:
    """
    Drop what has become superfluous; parameters as `exchange`.

    Returns
    -------
    best : Fit
        Dropping any effect hurts.
    rivals : dict
        Of those that are left.

    """
    while len(best.model.effects) > 1:
        shorter = [fit(ports, best.model.without(name)) for name in best.model.effects]
        least = min(shorter, key=lambda found: found.cost)
        if enough(least, best):
            break
        (gone,) = set(best.model.effects) - set(least.model.effects)
        rivals.pop(gone, None)
        best = least
    return best, {name: rivals.get(name, []) for name in best.model.effects}
