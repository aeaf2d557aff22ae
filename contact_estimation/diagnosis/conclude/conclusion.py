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

"""Everything after the search: what holds on held-out data, and how to say it."""

from __future__ import annotations

from dataclasses import replace
from typing import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from .dependence import dependences
from .finding import Diagnosis, NamedEffect, pair_of, Value
from .held_out import by_part, errors_of, improvement_interval, measure_part, Part
from .location import locate, Location
from .naming import advice, Naming
from ..fit.fitting import cost_of, Fit, fit
from ..fit.flexible import memory, predictable_share
from ..fit.free_run import free_run
from ..fit.nuisances import doubt
from ..fit.output_error import refine, runs_true
from ..fit.selection import Finding, penalty, scale_of, THRESHOLD
from ..fit.uncertainty import standard_deviations
from ..observe.case import Case
from ..observe.model import Model, names_of
from ..observe.noise import motion_noise
from ..observe.ports import Ports
from ...physics import EFFECTS

Array = NDArray[np.float64]
Progress = Callable[[str], None]

LEFT = 0.5
"""Mean square of the residuals beyond that of the noise, from which on something is missing."""

EXPLAINED = 0.9
"""Least share of the misfit that effects must explain to be named at all."""

FULLY = 0.97
"""Share of the misfit from which on what is left is the method's own error."""

_PREDICTABLE = 0.1  # share of the residual that a smoother foretells: structure, not noise
_SIGNIFICANT = 3.0  # standard deviations
_UNSEEN = 2.0  # mean square on held-out data, in those of the noise, that no estimate explains
_UNSEEN_EXPLAINED = 0.5  # least share of the misfit there that names must explain
_MEMORY = 0.25  # correlation of neighbouring residuals: structure that no smoother foretells


class Conclusion:
    """
    What holds on held-out data, and how to say it.

    Parameters
    ----------
    model : Model
        Nominal.
    at_nominal : float
        Its cost.
    finding : Finding
        Of the search.
    cases : list of Case
        That were fitted; the first is the one to be located and shown.
    others : list of Case
        Held-out recordings.
    seed : int
        Of the bootstraps.
    odd_robot : bool
        Whether the motion was left out, because no effect explains it.

    """

    def __init__(
        self, model: Model, at_nominal: float, finding: Finding, cases: list[Case],
        others: list[Case], seed: int, odd_robot: bool,
    ) -> None:
        self._nominal, self._at_nominal = model, at_nominal
        self._finding, self._cases, self._others = finding, cases, others
        self._odd_robot = odd_robot
        self._ports = [case.port for case in cases]
        self._generator = np.random.default_rng(seed)

    def draw(self, progress: Progress) -> Diagnosis:
        """
        Prove on held-out data, then say.

        Parameters
        ----------
        progress : callable
            Told in words what is being done.

        Returns
        -------
        diagnosis : Diagnosis
            Verdict, names, parameters, proof.

        """
        whole = self._with_held_out()
        best, open_end, predictable = self._what_is_left(whole, progress)
        verdict, base = self._verdict(best, open_end), self._finding.base
        if not open_end and all(
                port.observed.has_dynamics(base.model.nominal) for port in self._ports):
            progress('output error')
            same = not best.model.effects
            base = refine(self._ports, base) if same else base
            best = base if same else self._without_idle(refine(self._ports, best))
        progress('held-out parts')
        models = [self._nominal, base.model, best.model]
        parts, runs = self._held_out(models)
        force, motion = errors_of(parts)
        stds = standard_deviations(self._ports, best)
        naming = Naming(self._finding, self._cases, self._generator)
        names = naming.names(best, stds, whole[0])
        location = self._where(verdict, names, base, best, whole[0])
        rivals = {other: naming.rival(effect.name, other)
                  for effect in names for other in effect.indistinguishable_from}
        improvement = improvement_interval(parts, self._generator)
        progress('on what the rest depends')
        shown = dict(zip(('nominal', 'recalibrated', 'corrected'), models))
        left = {name: dependences(whole[0], shown[name], self._generator)
                for name in pair_of(bool(names))}
        return Diagnosis(
            verdict=verdict, effects=names, location=location, nominal=models[0],
            recalibrated=models[1], corrected=models[2],
            stiffness=Value(best.model.stiffness, stds[0], 'N/m'),
            damping=Value(best.model.damping, stds[1], 'N s/m'),
            noise_floor=float(np.mean([port.force_noise for port in self._ports])),
            force=force, motion=motion, improvement=improvement, holdouts=by_part(parts),
            next_experiment=advice(names, verdict), rivals=rivals,
            evidence=self._finding.candidates, left=best.cost / best.filled,
            predictable=predictable, dependences=left, shown=self._cases[0].recording.name,
            ports=self._ports, free_runs=runs,
        )

    def _what_is_left(
        self, whole: Sequence[Ports], progress: Progress
    ) -> tuple[Fit, bool, float]:
        """Tell what deserves to be named, whether more is missing, what can be foretold."""
        best, base = self._finding.best, self._finding.base
        named, lets_go = bool(best.model.effects), self._lets_go(best.model)
        with_robot = self._ports[0].observed.reference is not None
        explained = _explained(base.cost, best.cost, base.filled)
        predictable, open_end = 0.0, False
        if best.cost > (1.0 + LEFT) * base.filled:
            progress('what is left')
            predictable = max(predictable_share(port, best.model) for port in self._ports)
            structured = predictable > _PREDICTABLE or _MEMORY < max(
                memory(port, best.model) for port in self._ports)
            # A real wall that a force drives is known to more digits than laws are.
            open_end = structured and (with_robot or not named or explained < FULLY)
        if named and lets_go:
            open_end = False  # what is left is when, within a sample, it let go
        elif named and with_robot:
            unseen = self._unseen(whole, best.model)
            open_end = open_end or any(part > _UNSEEN for part in unseen)
            # Where a robot sticks, velocities are not known well enough for the ports.
            open_end = open_end and not runs_true(whole, refine(self._ports, best).model)
            if any(after > _UNSEEN and _explained(before, after, 1.0) < _UNSEEN_EXPLAINED
                   for before, after in zip(self._unseen(whole, base.model), unseen)):
                explained = 0.0
        if named and open_end and explained < EXPLAINED:
            best = base  # a false name is worse than no name
        best = self._significant(best)
        if not best.model.effects:
            open_end = open_end or any(
                part > _UNSEEN for part in self._unseen(whole, best.model))
        return best, open_end or (self._odd_robot and not lets_go), predictable

    def _where(
        self, verdict: str, names: Sequence[NamedEffect], base: Fit, best: Fit, port: Ports
    ) -> Location | None:
        """Locate what is missing, or what is still missing beside the names."""
        if verdict not in ('physics_missing', 'unexplained'):
            return None
        shown = best.model if verdict == 'unexplained' and best.model.effects else base.model
        acting = names[0].port if names and shown is base.model else None
        if self._odd_robot:  # its motion was taken for noise: not here
            o = port.observed
            port = replace(port, motion_noise=motion_noise(self._nominal, o, port.force_noise))
            acting = 'robot'
        return locate(port, shown, acting)

    def _with_held_out(self) -> list[Ports]:
        """Look at the recordings with the held-out parts, which have served their purpose then."""
        whole = [case.whole(self._finding.base.model) for case in self._cases]
        for port in whole:
            doubt(port, self._finding.base.model)
        return whole

    def _unseen(self, whole: Sequence[Ports], model: Model) -> list[float]:
        """Give the mean square, in that of the noise, at each port of each held-out part."""
        unseen: list[float] = []
        for case, port in zip(self._cases, whole):
            if case.held_out is None:
                continue
            there = port.blocks((case.held_out.samples & port.use).astype(float)) > 0.5
            parts = port.split(port.residuals(model))[:, there]
            unseen += np.mean(parts**2, axis=1).tolist() if there.any() else []
        return unseen

    def _lets_go(self, model: Model) -> bool:
        """Tell whether the force vanishes amid contacts, and an effect is named that does so."""
        named = [getattr(EFFECTS[name], 'lets_go', False) for name in model.effects]
        return any(named) and all(port.dropped is not None for port in self._ports)

    def _significant(self, best: Fit) -> Fit:
        """Drop effects whose every parameter could as well be that of no effect."""
        stds = standard_deviations(self._ports, best)
        for name in best.model.effects:
            place, neutral = best.model.place(name), EFFECTS[name].neutral
            away = [abs(value - neutral.get(parameter, 0.0)) > _SIGNIFICANT * std
                    for parameter, value, std in zip(
                        names_of(name), best.model.values[place], stds[place])]
            if not any(away):
                return self._significant(fit(self._ports, best.model.without(name)))
        return best

    def _without_idle(self, best: Fit) -> Fit:
        """Leave out an effect that the output error has made vanish, and fit the others anew."""
        cost = cost_of(self._ports, best.model)
        for name in best.model.effects:
            rest = best.model.without(name)
            price = penalty(best.model) - penalty(rest)
            if rest.effects and cost_of(self._ports, rest) <= cost + price:
                return self._without_idle(refine(self._ports, fit(self._ports, rest)))
        return best

    def _verdict(self, best: Fit, open_end: bool) -> str:
        if open_end:
            return 'unexplained'
        if best.model.effects:
            return 'physics_missing'
        base, count = self._finding.base, self._finding.base.filled
        gained = self._at_nominal - base.cost
        return 'consistent' if gained < THRESHOLD * count * scale_of(base) else 'recalibrate'

    def _held_out(self, models: Sequence[Model]) -> tuple[list[Part], dict[str, Array]]:
        parts: list[Part] = []
        first: dict[str, Array] = {}
        for case in [*self._cases, *self._others]:
            with_motion = case.port.observed.has_dynamics(models[0].nominal)
            runs = None
            if with_motion:
                different = models if models[2] is not models[1] else models[:2]
                runs = [free_run(model, case.port.observed).position for model in different]
                runs = [*runs, runs[1]][:3]
                first = first or dict(zip(('nominal', 'recalibrated', 'corrected'), runs))
            if case in self._others:
                everything = np.ones(len(case.port.observed.t), bool)
                parts.append(measure_part(
                    case.recording.name, case.port, everything, models, runs))
            elif case.held_out is not None:
                parts.append(measure_part(
                    self._part_name(case), case.whole(models[1]), case.held_out.samples, models,
                    runs))
        return parts, first

    def _part_name(self, case: Case) -> str:
        assert case.held_out is not None
        several = len(self._cases) > 1
        return f'{case.recording.name}, {case.held_out.name}' if several else case.held_out.name


def _explained(before: float, after: float, noise: float) -> float:
    """Give the share of the misfit above the noise that has gone; 1 where there was none."""
    return 1.0 - (after - noise) / (before - noise) if before > noise else 1.0
