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

"""The names of a diagnosis: how sure each is, what else it could be, and where it shows."""

from __future__ import annotations

from math import exp
from typing import Sequence

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from .finding import NamedEffect, Value
from .held_out import as_good
from .location import locate, Location
from ..fit.fitting import Fit, fit
from ..fit.selection import enough, Finding, PRICE, scale_of
from ..observe.case import Case
from ..observe.model import Model, names_of
from ..observe.ports import Ports
from ...parameters.specification import specifications
from ...physics import EFFECTS

Array = NDArray[np.float64]

_TEMPERATURE = 10.0  # serial correlation: costs are worth less than independent samples say
_BY_CHANCE = 4.0  # cost that a parameter more gains
_NEAREST, _MOST_RIVALS = 4, 2
_NEAR = 3.0  # times the best cost: rivals beyond are out of the question


class Naming:
    """
    Words for the effects of a model.

    Parameters
    ----------
    finding : Finding
        Of the search: its rivals.
    cases : sequence of Case
        That were fitted.
    generator : numpy.random.Generator
        Of the bootstraps.

    """

    def __init__(self, finding: Finding, cases: Sequence[Case], generator: Generator) -> None:
        self._finding, self._cases, self._generator = finding, cases, generator
        self._ports = [case.port for case in cases]
        self._refitted: dict[str, list[Fit]] = {}

    def names(self, best: Fit, stds: Array, seen: Ports) -> list[NamedEffect]:
        """
        Name every effect of a model.

        Parameters
        ----------
        best : Fit
            The model.
        stds : ndarray, shape (P,)
            Of all its values.
        seen : Ports
            The recording in which they are located.

        Returns
        -------
        names : list of NamedEffect
            First the one without which most is left.

        """
        dropped = {name: fit(self._ports, best.model.without(name), steps=8)
                   for name in best.model.effects}
        order = sorted(best.model.effects, key=lambda name: -dropped[name].cost)
        return [self._name(best, name, stds, locate(seen, dropped[name].model, EFFECTS[name].port))
                for name in order]

    def rival(self, name: str, other: str) -> Model:
        """
        Give the model with another effect in the place of one.

        Parameters
        ----------
        name, other : str
            An effect that was named, and one that it is indistinguishable from.

        Returns
        -------
        model : Model
            Fitted.

        """
        fits = self._rivals_of(name)
        return next(found.model for found in fits if found.model.effects[-1] == other)

    def _name(self, best: Fit, name: str, stds: Array, location: Location) -> NamedEffect:
        cls = EFFECTS[name]
        place = best.model.place(name)
        units = [spec.unit for spec in specifications(cls.Parameters)]
        values = {
            parameter: Value(value, float(std), unit) for parameter, value, std, unit in zip(
                names_of(name), best.model.values[place], stds[place], units)
        }
        alike = self._alike(best, name)
        return NamedEffect(
            name, cls.port, cls.equation, self._probability(best, name), values, alike, location)

    def _rivals_of(self, name: str) -> list[Fit]:
        """Fit the nearest rivals to the motion as it is smoothed now; the rest are far behind."""
        if name not in self._refitted:
            near = _NEAR * self._finding.best.cost
            rivals = [rival for rival in self._finding.rivals.get(name, [])[:_NEAREST]
                      if rival.cost < near]
            fits = [fit(self._ports, rival.model, steps=8) for rival in rivals]
            plausible = [found for found in fits if found.model.plausible()]
            self._refitted[name] = sorted(plausible, key=lambda found: found.cost)
        return self._refitted[name]

    def _probability(self, best: Fit, name: str) -> float:
        scale = _TEMPERATURE * scale_of(best)
        weights = []
        for rival in self._rivals_of(name):
            more = max(len(rival.model.values) - len(best.model.values), 0)
            if more and rival.cost > best.cost - _BY_CHANCE * more:
                continue  # a law that contains this one says nothing else
            behind = max(rival.cost - best.cost + PRICE * more, 0.0)
            weights.append(exp(-min(behind / (2.0 * scale), 700.0)))
        return 1.0 / (1.0 + sum(weights))

    def _alike(self, best: Fit, name: str) -> list[str]:
        """Name the rivals that predict held-out data as well, with no more parameters."""
        alike = []
        own = len(best.model.values)
        for rival in self._rivals_of(name):
            if len(rival.model.values) > own or name == rival.model.effects[-1]:
                continue
            if rival.cost - best.cost > PRICE * scale_of(best):
                continue
            if enough(rival, best):
                continue
            if all(as_good(case.whole(best.model), case.held_out.samples, best.model,
                           rival.model, self._generator)
                   for case in self._cases if case.held_out is not None):
                alike.append(rival.model.effects[-1])
        return alike[:_MOST_RIVALS]


def advice(names: Sequence[NamedEffect], verdict: str) -> str:
    """
    Say what to run next.

    Parameters
    ----------
    names : sequence of NamedEffect
        That were given.
    verdict : str
        Of the diagnosis.

    Returns
    -------
    advice : str
        In words; '' where nothing is open.

    """
    open_names = [(effect.name, effect.indistinguishable_from) for effect in names
                  if effect.indistinguishable_from]
    if open_names:
        pairs = '; '.join(f'{name} from {" and ".join(others)}' for name, others in open_names)
        return f'To tell {pairs}, run an experiment in which their predictions differ most.'
    if verdict == 'unexplained':
        return ('No effect of the library explains this. Repeat the same contact at half and at '
                'twice the speed and depth: what scales with which tells what is missing.')
    return ''
