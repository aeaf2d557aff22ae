# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The magnitudes of motion and forces in recordings."""

from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from typing import Any, NamedTuple, Sequence

import numpy as np
from scipy.fft import next_fast_len

from .compositions import compose
from .evidence import prior, ranked_by
from .fitting import differentiate_by, Fit, residual_function, sum_of_squares
from ..observe.model import Model, names_of
from ..observe.prepared_recording import PreparedRecording, Recordings
from ..observe.residuals import bends, force_residual, huber
from ...physics import EFFECTS
from ...physics.moving_environment import MANY_PERIODS
from ...physics.numeric import Array, Flags
from ...physics.prior import Scales, Tone

Tones = tuple[Tone, ...]

_LEAST = 1e-30  # in any unit
_PEAKS, _HIGHEST_HZ = 3, 12.0
_STRONG, _ALIKE = 40, 1e-3  # frequencies that are tried in pairs; relative singular value
_BINS = 1024, 16384  # of the way, at least eight in a period; the finer tell shorter periods alone
_SPACED_S, _FINER = 0.02, 4  # samples of the residual; grid of the spectrum, over 1 / duration


def measure_scales(recordings: Recordings, base: Fit) -> Scales:
    """Measure depth, speed, forces and the periodic part of the contact residual."""
    model, laws = base.model, base.model.laws()
    depth = speed = force = control = pull = duration = _LEAST
    for recording in recordings:
        o = recording.observed
        inside = laws.touching(o) if laws.contact.unilateral else o.t >= 0.0
        if not inside.any():
            continue
        depth = max(depth, float(np.max(np.abs(o.x[inside] - model.nominal.environment.location))))
        speed = max(speed, float(np.percentile(np.abs(o.v[inside]), 98)))
        force = max(force, float(np.max(np.abs(o.force))))
        pull = max(pull, float(np.percentile(o.force, 99.8)))
        duration = max(duration, float(o.t[-1]))
        if o.reference is not None:
            u = laws.robot.impedance_force(o.x, o.v, o.reference)
            control = max(control, float(np.max(np.abs(u))))
    spectrum, beat = _spectrum(recordings[0], base)
    return Scales(
        depth, speed, force, control, pull, duration, max(model.stiffness, _LEAST),
        max(model.damping, _LEAST), laws.robot.mass, spectrum,
        min(recording.observed.h for recording in recordings), beat,
        any(recording.driven_by_force(model) for recording in recordings))


def _spectrum(recording: PreparedRecording, base: Fit) -> tuple[Tones, Tones]:
    """Find the largest peaks of the contact residual, and the two tones that fit it best."""
    o = recording.observed
    laws = base.model.laws()
    if not laws.contact.unilateral:
        return (), ()
    residual = force_residual(recording, base.model)
    use = recording.use & o.measured & (laws.contact.force(o.t, *laws.at_wall(o)) < 0.0)
    stride = max(1, round(_SPACED_S * o.pace / o.h))
    use, r = use[::stride], residual[::stride]
    count = int(np.count_nonzero(use))
    if count < 50:
        return (), ()
    r = np.where(use, r - r[use].mean(), 0.0)
    finer = next_fast_len(_FINER * len(r))
    frequencies = np.fft.rfftfreq(finer, stride * o.h)
    sums = np.fft.rfft(r, finer) * np.exp(-2j * np.pi * frequencies * o.t[0])
    inside = (frequencies >= 0.5 / float(o.t[-1])) & (frequencies < _HIGHEST_HZ / o.pace)
    frequencies, amplitudes = frequencies[inside], 2.0 / count * sums[inside]
    strong = np.sort(frequencies[np.argsort(-np.abs(amplitudes))[:_STRONG]])
    return _peaks(frequencies, amplitudes), _beat(o.t[::stride][use], r[use], strong)


def _peaks(frequencies: Any, amplitudes: Any) -> Tones:
    """Find the largest peaks of a spectrum whose frequencies are `_FINER` than resolved."""
    found = list[Tone]()
    for k in np.argsort(-np.abs(amplitudes)).tolist():
        if all(abs(frequencies[k] - other) > _FINER * (frequencies[1] - frequencies[0])
               for other, _ in found):
            found.append((float(frequencies[k]), complex(amplitudes[k])))
        if len(found) == _PEAKS:
            break
    return tuple(found)


def measure_waves(recording: PreparedRecording, model: Model) -> Tones:
    """Find the largest peaks in the spectrum of the contact residual over the way."""
    o, wall = recording.observed, model.nominal.environment
    use = recording.use & o.measured
    stroke = float(np.ptp(o.x[use])) if use.any() else 0.0
    if wall.unilateral or not stroke:
        return ()
    found, fewest = list[Tone](), MANY_PERIODS
    way, left = (o.x[use] - float(o.x[use].min())) / stroke, force_residual(recording, model)[use]
    middle = float(o.x[use].min()) - wall.location
    for bins in _BINS:
        place = np.minimum(way * bins, bins - 1).astype(int)
        visits = np.bincount(place, minlength=bins)
        there = np.flatnonzero(visits)
        # On average over the way there and the way back friction and inertia are nearly nothing.
        mean = np.bincount(place, left)[there] / visits[there]
        # Empty bins would repeat slow misfits at the rate of the samples.
        mean = np.interp(np.arange(bins), there, mean - mean.mean())
        inside = slice(round(_FINER * fewest) + 1, _FINER * bins // 8)
        frequencies = np.fft.rfftfreq(_FINER * bins, stroke / bins)[inside]
        sums = np.fft.rfft(mean, _FINER * bins)[inside]
        sums *= np.exp(-2j * np.pi * frequencies * (middle + 0.5 * stroke / bins))
        found += _peaks(frequencies, 2.0 / bins * sums)
        fewest = bins / 8
    return tuple(found)


def _beat(t: Array, r: Array, frequencies: Array) -> Tones:
    """Fit all pairs of tones of some frequencies; return the best."""
    angles = 2.0 * np.pi * t[:, None] * frequencies
    columns = np.column_stack([np.cos(angles), np.sin(angles), np.ones(len(t))])
    gram, push, count = columns.T @ columns, columns.T @ r, len(frequencies)
    pairs = np.array(list(combinations(range(count), 2)), int).reshape(-1, 2)
    chosen = np.column_stack([pairs, pairs + count, np.full(len(pairs), 2 * count)])
    grams, pushes = gram[chosen[:, :, None], chosen[:, None, :]], push[chosen]
    # Two tones of one frequency are one: the rest of their difference would be huge.
    inverses = np.linalg.pinv(grams, rcond=_ALIKE, hermitian=True)
    weights = np.einsum('kij,kj->ki', inverses, pushes)
    explained = np.einsum('ki,ki->k', weights, 2.0 * pushes - np.einsum(
        'kij,kj->ki', grams, weights))
    if not np.any(explained > 0.0):
        return ()
    best = int(np.argmax(explained))
    tones = frequencies[pairs[best]].tolist()
    cosines, sines = weights[best, :2].tolist(), weights[best, 2:4].tolist()
    return tuple((tone, complex(cosine, -sine))
                 for tone, cosine, sine in zip(tones, cosines, sines))


_FARTHEST = 1.0  # typical sizes by which one step may change a value that shapes a law
_LEAST_CHANGE = -0.99  # relative, of a value that a law is linear in and that is above 0


class _Start(NamedTuple):
    """A start of an effect beside the nominal model."""

    model: Model  # the nominal model with the effect
    change: Array  # (R,) of the residuals
    # (R, p) their derivatives by its free values, for changes by their typical sizes
    columns: Array

    @property
    def name(self) -> str:
        """Return the name of the effect."""
        return self.model.effects[-1]


class Step(NamedTuple):
    """A step from a start."""

    foretold: float  # cost there, foretold by the derivatives
    model: Model  # there
    linear: Model  # where only the values are stepped that the law is linear in
    start: Model  # from where

    @property
    def name(self) -> str:
        """Return the name of the last effect."""
        return self.model.effects[-1]


@dataclass(frozen=True, eq=False)
class Screening:
    """All starts of all effects, beside the nominal model."""

    recordings: Recordings  # with a common discrepancy
    base: Fit  # the recalibrated model
    names: Sequence[str]  # the effects
    scales: Scales  # magnitudes of motion and forces

    def _straight(self, model: Model, values: Array) -> Array:
        """Return residuals that are neither bent nor have a long memory."""
        return residual_function(self.recordings, model, robust=False, briefly=True)(values)

    @cached_property
    def _starts(self) -> list[_Start]:
        return self._starts_of(
            [name for name in self.names if not EFFECTS[name].starts_anew], self.scales)

    def _starts_of(self, names: Sequence[str], scales: Scales) -> list[_Start]:
        """Evaluate the starts of effects beside the nominal model."""
        models = [self.base.model.with_effect(name, values)
                  for name in names for values in EFFECTS[name].prior(scales).starts]
        return [self._start(model, self._here) for model in models]

    @cached_property
    def _here(self) -> Array:
        return self._straight(self.base.model, self.base.model.coordinates)

    def _start(self, model: Model, here: Array) -> _Start:
        own = _of_newest(model)
        first = model.coordinates
        there = self._straight(model, first)

        def by_own(values: Array) -> Array:
            every = first.copy()
            every[own] = values
            return self._straight(model, every)

        columns = differentiate_by(
            first[own], model.steps[own], by_own, there, most=model.ranges[1][own])
        return _Start(model, there - here, columns)

    def steps(self, present: Model, names: Sequence[str]) -> dict[str, list[Step]]:
        """Take one Gauss-Newton step from each start, beside a model."""
        straight = lambda values: self._straight(present, values)  # noqa: E731
        here = straight(present.coordinates)
        columns = differentiate_by(
            present.coordinates, present.steps, straight, here, most=present.ranges[1])
        basis = np.linalg.qr(columns)[0] if columns.shape[1] else np.zeros((len(here), 0))
        starts, anew = self._starts, [name for name in names if EFFECTS[name].starts_anew]
        if anew:
            waves = measure_waves(self.recordings[0], present)
            starts = starts + self._starts_of(anew, self.scales._replace(waves=waves))
        found = dict[str, list[Step]]()
        for start in starts:
            if start.name in names:
                found.setdefault(start.name, []).append(
                    self._step(present, start, here, columns, basis))
        best = {name: ranked_by(steps, lambda one: one.foretold) for name, steps in found.items()}
        order = ranked_by(best, lambda name: best[name][0].foretold, prior)
        return {name: best[name] for name in order}

    def composed(self) -> list[Model]:
        """Return the nominal model with two laws that act on each other, the best pairs first."""
        each = compose(self.base.model, self.names, self.scales, lambda model: self._straight(
            model, model.coordinates))
        cost = lambda one: self._cost(one.residuals)  # noqa: E731
        best = [ranked_by(starts, cost)[0] for starts in each]
        return [one.model for one in ranked_by(best, cost)]

    def _step(
        self, present: Model, start: _Start, here: Array, columns: Array, basis: Array
    ) -> Step:
        """Take the best of the steps of all its values, and of those it is linear in."""
        # Beside the others these are solved for, whatever their sign (Golub and Pereyra 2003).
        name, values = start.name, start.model.values[start.model.place(start.name)]
        made = present.with_effect(name, values)
        shapes = _shapes(made)
        left = here + start.change
        left_over = left - basis @ (basis.T @ left)
        own = start.columns - basis @ (basis.T @ start.columns)
        tried = list[tuple[float, Array]]()
        for free in (np.ones(len(shapes), bool), ~shapes):
            change = np.zeros(len(shapes))
            change[free] = np.linalg.lstsq(own[:, free], -left_over, rcond=1e-10)[0]
            if np.any(np.abs(change[shapes]) > _FARTHEST):
                change[shapes] = np.clip(change[shapes], -_FARTHEST, _FARTHEST)
                rest = left_over + own[:, shapes] @ change[shapes]
                change[~shapes] = np.linalg.lstsq(own[:, ~shapes], -rest, rcond=1e-10)[0]
            tried.append((self._cost(left_over + own @ change), change))
            if not shapes.any():
                break
        basic = np.linalg.lstsq(columns, -np.column_stack([
            left + start.columns @ change for _, change in tried]), rcond=1e-10)[0]
        models = [_moved(made, of_present, change)
                  for of_present, (_, change) in zip(basic.T, tried)]
        best = min(range(len(tried)), key=lambda k: tried[k][0])
        return Step(tried[best][0], models[best], models[-1], made)

    def _cost(self, straight: Array) -> float:
        """Sum the squares of residuals, large ones bent."""
        bent, begin = 0.0, 0
        for one in self.recordings:
            stop = begin + len(one.channels(self.base.model)) * one.block_count
            part = straight[begin:stop]
            bent += sum_of_squares(huber(part) if bends(one, self.base.model) else part)
            begin = stop
        return bent


def _moved(model: Model, of_present: Array, change: Array) -> Model:
    """Return a model with all its values moved, within their ranges."""
    own, size = _of_newest(model), model.steps
    there = model.coordinates
    steps = np.zeros(len(there))
    steps[own] = change
    if len(of_present) == np.count_nonzero(~own):  # else the effect replaces a value of the wall
        steps[~own] = of_present
    factors = own & model.logarithmic[model.free] & ~np.isin(
        np.arange(len(there)), np.flatnonzero(own)[_shapes(model)])
    steps[factors] = np.log1p(np.maximum(steps[factors], _LEAST_CHANGE))
    return model.with_free(np.clip(there + steps * size, *model.ranges))


def _of_newest(model: Model) -> Flags:
    """Return which coordinates are those of the newest effect."""
    newest = np.zeros(len(model.values), bool)
    newest[model.place(model.effects[-1])] = True
    return newest[model.free]


def _shapes(model: Model) -> Flags:
    """Return which values of the newest effect shape it; it is linear in the others."""
    linear = EFFECTS[model.effects[-1]].linear()
    return np.array([name not in linear for name in names_of(model.effects[-1])])
