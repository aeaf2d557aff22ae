# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The models of a contact that are compared, and how they are fitted."""

from collections import Counter
from dataclasses import replace
from functools import cached_property
from typing import Callable, Mapping, Sequence, TypeVar

import numpy as np

from .candidates import candidates_in, is_credible, is_flexible
from .discrepancy import CHANNELS, force_of_motion, least_material, weighed
from .evidence import Evidence, prior, ranked, Scored, ZEROS
from .fitting import Fit, fit, fit_at, fit_to_end
from .left_out import Linearised, Part, parts_of
from .screening import measure_scales, Screening, Step
from ..observe.model import Model
from ..observe.prepared_recording import PreparedRecording, Recordings
from ..observe.shares import MOST
from ...physics import EFFECTS
from ...physics.numeric import Array


# How many effects are fitted briefly, longer, and scored beside none; half as many beside others.
_TRIED, _FOLLOWED, _SCORED = 12, 8, 6
_OF_FAMILY = 2  # of them; `siblings` has the others
_STARTS, _BRANCHES = 6, 3  # of an effect of which one step tells little: tried, and fitted
_BEGUN, _BRIEF, _LONGER, _TO_THE_END = 2, 4, 8, 25  # steps of fits


class ContactModels:
    """
    Models of a contact: the nominal one with effects of the library.

    parts: that are left out in turn
    """

    def __init__(
        self, recordings: Recordings, base: Fit, leaves: Model | None = None,
        progress: Callable[[str], None] = lambda text: None, parts: Sequence[Part] = (),
    ) -> None:
        self._plain, self._progress = recordings, progress
        self._driven = any(one.driven_by_force(base.model) for one in recordings)
        self._common = weighed(recordings, leaves or base.model)
        self._base = fit_to_end(self._common, fit(self._common, base.model))
        alike = parts and len(parts[0].there) == len(self._base.residuals)
        self.parts = parts if alike else parts_of(self._common, self._base)

    @cached_property
    def _screening(self) -> Screening:
        """Return all starts; a space in which known models are fitted again needs none."""
        return Screening(
            self._common, self._base, candidates_in(self._common, self._base.model),
            measure_scales(self._common, self._base))

    def evidence(self) -> Evidence:
        """Return what models are compared against, with the recalibrated nominal model."""
        instrument, as_force = (
            np.mean([row(one) for one in self._common], axis=0)
            for row in (self._instrument_of, self._force_of_noise))
        return Evidence(self._scored(self._common, self._base), instrument, as_force)

    def _force_of_noise(self, one: PreparedRecording) -> Array:
        """Return the mean square of noise in each channel as that of a force [N^2]."""
        stds = np.zeros(CHANNELS)
        if one.driven_by_force(self._base.model):
            stds[0] = 1.0
            return stds
        for k, channel in enumerate(one.channels(self._base.model)):
            noise = channel.noise_of_means[channel.filled]  # the motion's errors are in it
            stds[k] = 1.0 / np.sqrt(np.mean(noise**-2.0)) if len(noise) else channel.noise
        stds[1] *= force_of_motion(one, self._base.model)
        return stds**2

    def _instrument_of(self, one: PreparedRecording) -> Array:
        """Return the mean square of the discrepancy of every instrument, in that of noise."""
        if one.simulated or one.driven_by_force(self._base.model):
            return np.zeros(CHANNELS)
        size, noise = least_material(one), self._force_of_noise(one)
        return np.asarray(np.where(noise > 0.0, size**2 / np.maximum(noise, 1e-300), 0.0))

    def weighed(self, model: Model) -> Recordings:
        """Return the recordings with the discrepancy of a model."""
        return self._common if self._driven else weighed(self._plain, model)

    def _scored(self, recordings: Recordings, found: Fit) -> Scored:
        """Let a fitted model predict parts left out."""
        model, told = found.model, Linearised(recordings, found, self.parts)
        laws = _laws(model)
        return Scored(
            model.effects,
            tuple('' if name in model.given else EFFECTS[name].family for name in model.effects),
            (len(model.effects), [prior(name) for name in model.effects]),
            told.left_out[0], told.fitted[0], told.counts,
            int(np.count_nonzero(model.free) - np.count_nonzero(self._base.model.free)),
            len(laws),
            sum(is_flexible(recordings, model, name) for name in laws), told,
            as_exact=np.stack((told.left_out[1], told.fitted[1])),
            white=self._driven or told.white)  # a filter that expects large forces is not

    def extensions(self, one: Scored) -> list[Scored]:
        """Fit the most promising candidates beside the effects of a model."""
        present: Model = one.found.found.model
        recordings = self.weighed(present)
        names = [name for name in candidates_in(recordings, present)
                 if EFFECTS[name].family not in one.named]
        self._progress(f'{len(names)} effects')
        here, by_name = fit_at(recordings, present), self._screening.steps(present, names)
        part = 2 if one.named else 1
        rough = ranked(self._credible(recordings, here.cost, by_name, _TRIED // part,
                                      not one.named), lambda found: found.cost)
        longer = ranked([
            fit(recordings, each.model, _LONGER, known=each.residuals)
            for each in _first_of(rough, lambda each: each.name, _FOLLOWED // part)],
            lambda found: found.cost)
        finished = [self._finished(each.model, _LONGER)
                    for each in _first_of(longer, lambda each: each.name, _SCORED // part)]
        return [each for each in finished if each is not None]

    def _credible(
        self, recordings: Recordings, present: float, by_name: Mapping[str, Sequence[Step]],
        count: int, ringing: bool,
    ) -> list[Fit]:
        """Fit the first effects briefly whose values are possible, and all that ring."""
        found, seen = list[Fit](), Counter[str]()
        for name, steps in by_name.items():
            wanted = len(found) < count and seen[EFFECTS[name].family] < _OF_FAMILY
            if wanted or ringing and EFFECTS[name].resonates:
                tried = self._tried(recordings, present, steps)
                if is_credible(recordings, tried.model):
                    found.append(tried)
                    seen[EFFECTS[name].family] += 1
        return found

    def compositions(self, rival: Scored) -> list[Scored]:
        """Fit the nominal model with each relaxation of each elastic law."""
        recordings = self.weighed(self._base.model)
        begun = [fit(recordings, model, _LONGER)
                 for model in self._screening.composed()[:_FOLLOWED]]
        least = fit_at(recordings, rival.found.found.model).cost
        nearest = [one for one in ranked(begun, lambda one: one.cost) if one.cost < least]
        finished = [self._finished(one.model, _TO_THE_END) for one in nearest[:_SCORED // 2]]
        return [one for one in finished if one is not None]

    def siblings(self, one: Scored) -> list[Scored]:
        """Leave out each effect; put laws of its family and of the likeliest one in its place."""
        model = one.found.found.model
        recordings = self.weighed(model)
        own = [name for name in model.effects if name not in model.given]
        found = [self._finished(model.without(name), _TO_THE_END)
                 for name in own if len(own) > 1]
        for name in _laws(model):
            rest = model.without(name)
            taken = one.named - {EFFECTS[name].family}
            steps = self._screening.steps(rest, [
                other for other in candidates_in(recordings, rest)
                if EFFECTS[other].family not in taken])
            families = dict.fromkeys([EFFECTS[other].family for other in (name, *steps)])
            alike = list(families)[:2]  # the likeliest beside its own
            present = fit_at(recordings, rest).cost
            found += [
                self._finished(self._tried(recordings, present, near).model, _TO_THE_END)
                for other, near in steps.items()
                if other != name and EFFECTS[other].family in alike]
        return [each for each in found if each is not None]

    def _tried(self, recordings: Recordings, present: float, steps: Sequence[Step]) -> Fit:
        """Fit an effect briefly, from the best of its steps, or from afar where these fail."""
        rings = EFFECTS[steps[0].name].resonates
        several, near = self._driven or rings, list[Fit]()
        for step in steps[:_STARTS if several else 2]:
            near += [fit_at(recordings, model) for model in (step.model, step.linear)]
            if not several and min(one.cost for one in near) < present:
                break
        else:
            near += [fit_at(recordings, step.start)
                     for step in (steps if rings else steps[:_STARTS])]
        near.sort(key=lambda found: found.cost)
        if rings or near[0].cost >= present:
            alone = len(_laws(steps[0].start)) == 1
            return self._from_afar(recordings, near, 2 * _STARTS if rings and alone else _BRANCHES)
        return fit(recordings, near[0].model, _BRIEF, known=near[0].residuals)

    def _from_afar(self, recordings: Recordings, near: Sequence[Fit], branches: int) -> Fit:
        """Fit an effect of which one step tells little; a driven wall with a short memory."""
        if not self._driven:  # successive halving: K. Jamieson and A. Talwalkar 2016
            begun = min((fit(recordings, one.model, _BEGUN) for one in near[:branches]),
                        key=lambda found: found.cost)
            return fit(recordings, begun.model, _LONGER, known=begun.residuals)
        near = sorted((fit_at(recordings, one.model, briefly=True) for one in near),
                      key=lambda found: found.cost)
        longer = [fit(recordings, one.model, _LONGER, briefly=True) for one in near[:branches]]
        best = min((fit_at(recordings, one.model) for one in longer), key=lambda found: found.cost)
        return fit(recordings, best.model, _BRIEF, known=best.residuals)

    def to_the_end(self, one: Scored) -> Scored | None:
        """Fit a model to the end; None if its values are not possible."""
        return self._finished(one.found.found.model, _TO_THE_END)

    def _finished(self, model: Model, steps: int) -> Scored | None:
        recordings = self.weighed(model)
        found = fit(recordings, model, steps)
        if not self._driven and found.cost < MOST * len(found.residuals):
            # Weighed by a discrepancy of long ago.
            recordings = self.weighed(found.model)
            found = fit(recordings, found.model, steps)
        return self._scored(recordings, found) if is_credible(recordings, found.model) else None

    def without(self, one: Scored, names: Sequence[str]) -> Scored:
        """Fit a model without some of its effects."""
        present: Model = one.found.found.model
        rest = present.without(*names)
        recordings = self.weighed(rest)
        return self._scored(recordings, fit(recordings, rest))

    def as_given(self, model: Model) -> Scored:
        """Score a model at its values: what nothing is fitted to predicts all parts alike."""
        recordings = self.weighed(model)
        scored = self._scored(recordings, fit_at(recordings, model))
        fitted = scored.found.fitted
        return replace(scored, left_out=fitted[0], as_exact=fitted[[1, 1]], parameters=0)


def _laws(model: Model) -> list[str]:
    """List the effects of a model that are neither zeros nor of the nominal model."""
    return [name for name in model.effects if name not in (*ZEROS, *model.given)]


Item = TypeVar('Item')


def _first_of(items: Sequence[Item], name_of: Callable[[Item], str], count: int) -> list[Item]:
    """Return the first items that are not the third of their family."""
    found, seen = list[Item](), Counter[str]()
    for one in items:
        family = EFFECTS[name_of(one)].family
        seen[family] += 1
        if seen[family] <= _OF_FAMILY:
            found.append(one)
    return found[:count]
