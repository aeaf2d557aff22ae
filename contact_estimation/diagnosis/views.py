# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
How recordings are looked at: what is between samples, where surfaces are, which samples count.

A view is one more axis of the comparison of models: each alternative is compared with the view
that is best so far, and pays the prior of a law.
"""

from dataclasses import replace
from typing import Callable, Iterator, NamedTuple, Sequence

import numpy as np

from .checks.check import Check
from .fit.beam import Compared, refit, search
from .fit.discrepancy import discounted, without_ripple
from .fit.evidence import Scored
from .fit.fitting import Fit, fit
from .fit.free_run import free_run
from .fit.left_out import predict, Spared
from .fit.space import ContactModels
from .fit.surfaces import on_one_surface, Surfaces, surfaces_of
from .observe.model import Model
from .observe.observed import observe
from .observe.prepared_recording import prepare, PreparedRecording, Recordings
from .observe.signals import Recording, with_held_reference
from .stamp_offset import Offset, offset_of
from ..physics import EFFECTS
from ..plant.driven_wall import BETWEEN

Progress = Callable[[str], None]

CAUSED = frozenset({'timing', 'inertia', 'relaxation'})
"""Families that stamps which are off look like."""

_STRAIGHT = next(iter(BETWEEN))  # the usual course of a force between samples
_DIVERGED = 1e3  # times the range of the motion: a free run that tells nothing
_REFITTED = 4  # models that are fitted again to a motion smoothed by the best of them
_AS_LIKELY = 1.0  # nats: no evidence either way


class Given(NamedTuple):
    """What is diagnosed, after all checks."""

    nominal: Model  # the model under diagnosis
    # fitted, held_out: to fit, and to test on; without the latter a part of the former is held out
    fitted: Sequence[Recording]
    held_out: Sequence[Recording]
    checks: list[Check]  # of all recordings

    def with_each(self, change: Callable[[Recording], Recording]) -> 'Given':
        """Return the same with every recording changed."""
        return self._replace(fitted=[change(one) for one in self.fitted],
                             held_out=[change(one) for one in self.held_out])


class View(NamedTuple):
    """A way to look at recordings."""

    given: Given  # what is diagnosed, with what the view changes in the signals
    # course between samples of a force that drives a wall; a key of BETWEEN
    between: str = _STRAIGHT
    holds_reference: bool = False  # whether the robot holds its reference between setpoints
    places: tuple[float, ...] = ()  # where each contact begins, if at different places [m]
    moving: bool = False  # whether samples at rest are left out
    offset: Offset | None = None  # by which the stamps of a topic are put right

    @property
    def changes(self) -> int:
        """Return the number of assumptions that are less usual; courses of a force are alike."""
        return self.holds_reference + len(self.places) + (self.offset is not None)


class Seen(NamedTuple):
    """Models compared in a view."""

    view: View  # how the recordings are looked at
    recordings: Recordings  # fitted together, without a discrepancy
    base: Fit  # the recalibrated model
    models: ContactModels  # the models
    compared: Compared  # what was found
    holdouts: Recordings = ()  # recordings that are held out whole
    spared: Sequence[Spared] = ()  # held-out data by which models are compared, too

    @property
    def best(self) -> Scored:
        """Return the most likely model."""
        return self.compared.models[0]

    @property
    def best_model(self) -> Model:
        """Return it as it was fitted."""
        model: Model = self.best.found.found.model
        return model

    def without(self, one: Scored, names: Sequence[str]) -> Scored:
        """Fit a model without some of its effects."""
        return predict(self.models.without(one, names), self.spared)

    def as_given(self) -> Scored:
        """Return the nominal model at its values."""
        return predict(self.models.as_given(self.view.given.nominal), self.spared)

    @property
    def driven(self) -> bool:
        """Return whether a force drives a wall."""
        return any(one.driven_by_force(self.base.model) for one in self.recordings)

    @property
    def leaves(self) -> Model | None:
        """Return the model whose discrepancy all models share; None if each has its own."""
        return self.best_model if self.driven else None


def compare(view: View, progress: Progress) -> Seen:
    """Compare models in a view."""
    recordings, base = recalibrated(_prepared(view), view.given.nominal)
    models = ContactModels(recordings, base, progress=progress)
    seen = Seen(view, recordings, base, models, search(models, progress))
    again = seen.driven and seen.best.effects
    return _continued(seen, progress) if again else _smoothed(seen, progress)


def _continued(seen: Seen, progress: Progress) -> Seen:
    """Search on from known models; for a driven wall with the discrepancy of the best of them."""
    models, known = seen.models, seen.compared
    if seen.driven and seen.best.effects:
        models = ContactModels(
            seen.recordings, seen.base, seen.best_model, progress, models.parts)
        known = refit(models, known.models[:_REFITTED])
    compared = search(models, progress, known)
    return _smoothed(seen._replace(models=models, compared=compared), progress)


def _prepared(view: View) -> Recordings:
    """Smooth the recordings of a view."""
    given, hold = view.given, not view.given.held_out
    prepared: Recordings = [prepare(one, given.nominal, hold) for one in given.fitted]
    if view.between != _STRAIGHT:
        prepared = [one.with_force_between_samples(view.between, given.nominal)
                    for one in prepared]
    return prepared


def recalibrated(recordings: Recordings, model: Model) -> tuple[Recordings, Fit]:
    """Fit the nominal model, then discount what is uncertain of it there and fit it again."""
    rough = fit(recordings, model)
    recordings = [discounted(without_ripple(one, rough.model), rough.model) for one in recordings]
    return recordings, fit(recordings, rough.model)


def _smoothed(seen: Seen, progress: Progress) -> Seen:
    """Smooth the motion by the best model, and fit the most likely models again."""
    # The free run of a good model follows the sharp bends of the motion, so that the difference
    # needs less bandwidth and velocities get more accurate; friction near standstill needs that.
    runs = all(one.observed.has_dynamics(seen.base.model.nominal) for one in seen.recordings)
    if not seen.best.effects or not runs:
        return seen
    progress('smoothing with the best model')
    sharper = _smoothed_with(seen.best_model, seen)
    if sharper is None:
        return seen
    recordings, base = recalibrated(sharper, seen.base.model)
    models = ContactModels(recordings, base, seen.leaves, progress, seen.models.parts)
    again = seen._replace(
        recordings=recordings, base=base, models=models,
        compared=refit(models, seen.compared.models[:_REFITTED]))
    return again if again.compared.score > seen.compared.score else seen


def _smoothed_with(model: Model, seen: Seen) -> Recordings | None:
    """Smooth with the free run of a model; None if it diverges or needs more bandwidth."""
    nominal, again = seen.view.given.nominal, list[PreparedRecording]()
    for raw, one in zip(seen.view.given.fitted, seen.recordings):
        o = one.observed
        carried = free_run(model, o).position
        largest = _DIVERGED * np.max(np.abs(o.x))
        if not np.isfinite(carried).all() or np.max(np.abs(carried)) > largest:
            return None
        better = replace(observe(raw.signals, nominal.nominal, carried, o.between), held=o.held)
        if better.cutoff > o.cutoff:
            return None
        again.append(PreparedRecording.of(one.name, better, nominal, one.held_out))
    return again


def best_view(given: Given, progress: Progress) -> Seen:
    """Compare the models in the usual view, and in others that promise more."""
    seen = compare(View(given), progress)
    for alternatives in (_between, _held_reference, _surfaces, _stamps):
        for view in alternatives(seen):
            progress('another view')
            other = _refitted(view, seen, progress)
            if _gain(other, seen) <= -_AS_LIKELY:
                continue
            other = _continued(other, progress)
            if _promises(other, seen):
                seen = other
    return seen


def _between(seen: Seen) -> Iterator[View]:
    """Yield other courses of a force that drives a wall."""
    if seen.driven:
        for name in BETWEEN:
            if name != seen.view.between:
                yield seen.view._replace(between=name)


def _held_reference(seen: Seen) -> Iterator[View]:
    """Yield the view in which a robot holds its reference between setpoints."""
    if all(one.observed.reference is not None for one in seen.recordings):
        yield seen.view._replace(
            given=seen.view.given.with_each(with_held_reference), holds_reference=True)


def _surfaces(seen: Seen) -> Iterator[View]:
    """Yield the view in which each contact has a surface of its own."""
    given, nominal = seen.view.given, seen.view.given.nominal
    if not nominal.nominal.environment.unilateral:
        return
    every = [*given.fitted, *given.held_out]
    surfaces = surfaces_of(seen.recordings if len(every) == 1 else [
        prepare(one, nominal, hold=False) for one in every])
    if surfaces.are_apart:
        yield seen.view._replace(given=_on_one_surface(given, surfaces),
                                 places=tuple(surfaces.fitted.tolist()))


def _on_one_surface(given: Given, surfaces: Surfaces) -> Given:
    """Move the contacts to the surface of the model."""
    moved, location = [], given.nominal.nominal.environment.location
    for number, one in enumerate((*given.fitted, *given.held_out)):
        of_it = [k for k, contact in enumerate(surfaces.contacts) if contact.recording == number]
        moved.append(replace(one, signals=on_one_surface(
            one.signals, [surfaces.contacts[k] for k in of_it],
            [float(surfaces.fitted[k]) for k in of_it], location)))
    count = len(given.fitted)
    return given._replace(fitted=moved[:count], held_out=moved[count:])


def _stamps(seen: Seen) -> Iterator[View]:
    """Yield views with the stamps of a topic put right, if they are off by more than a filter."""
    if not all(one.observed.has_dynamics(seen.base.model.nominal) for one in seen.recordings):
        return
    lawful, given = _lawful(seen), seen.view.given
    for topic in ('wrench', 'joint_states'):
        offset = offset_of(topic, given.fitted, lawful)
        if offset is not None:
            yield seen.view._replace(given=given.with_each(offset.put_right), offset=offset)


def _lawful(seen: Seen) -> Scored:
    """Return the best model without what stamps that are off, or a held reference, look like."""
    caused = [name for name in seen.best.effects if EFFECTS[name].family in CAUSED]
    return seen.models.without(seen.best, caused) if caused else seen.best


def _refitted(view: View, seen: Seen, progress: Progress) -> Seen:
    """Fit the best models known so far, or one with fewer effects, again in another view."""
    recordings, base = recalibrated(_prepared(view), view.given.nominal)
    models = ContactModels(recordings, base, seen.leaves, progress, seen.models.parts)
    fewer = [one for one in seen.compared.models
             if len(one.effects) == 1 and one.key < seen.best.key]
    known = [*seen.compared.models[:_REFITTED], _lawful(seen), *fewer]
    return Seen(view, recordings, base, models, refit(models, known))


def _gain(other: Seen, seen: Seen) -> float:
    """Return how much more a view scores, for the same noise and idealisation of laws."""
    # A drive has its own noise in each view. What a law leaves is a part of what is left in the
    # view with fewer changes: a change that explains must not make laws more exact.
    scores, of_other, of_seen = [], other.compared.evidence.noise, seen.compared.evidence.noise
    level = seen.compared.evidence.level
    for one in (other, seen):
        evidence = one.compared.evidence
        if of_other is not None and of_seen is not None and not seen.driven and (
                of_other.shape == of_seen.shape):
            evidence = replace(evidence, noise=np.minimum(of_other, of_seen), level=level)
        best = max(evidence.score(model) for model in one.compared.models)
        scores.append(best - one.view.changes * evidence.constants.law)
    return scores[0] - scores[1]


def _promises(other: Seen, seen: Seen) -> bool:
    """Return whether a view is likelier, or a course of the force as likely and leaves less."""
    gain = _gain(other, seen)
    if other.view.between == seen.view.between or gain < -_AS_LIKELY:
        return gain > 0.0
    left = [float(np.sum(one.best.counts * one.best.left_out)) for one in (other, seen)]
    return gain > 0.0 or left[0] < left[1]
