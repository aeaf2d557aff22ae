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

"""The search for one more effect: every candidate is fitted beside those of the model."""

from __future__ import annotations

from typing import Any, Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from .applicable import candidates_in
from .criteria import noise_scale, penalty
from .discrepancy import costs_by_channel, has_discrepancy
from .first_step import fit_without, Step, steps, Straight, straight_at
from .fitting import cost_of, Fit, fit, fit_at, fit_to_end
from .order import prior, ranked, ranked_by
from .scales import measure_scales
from ..observe.cycle import keeps_step
from ..observe.model import Model, names_of
from ..observe.prepared_recording import is_flexible, PreparedRecording, Recordings
from ..observe.residuals import force_residual
from ...parameters.specification import ParameterGroup
from ...physics import EFFECTS
from ...physics.scales import Scales

Array = NDArray[np.float64]

_STARTED = 14  # candidates that are fitted, the best after one step, beside those of a family
_OF_CHANNEL = 4  # further ones, the best in force or motion alone
_FOLLOWED, _TO_END = 6, 2  # those that are refined, and those fitted to the end
_FAR = 2.0  # times the noise: power of the residuals
_MANY = 8  # starts, of which one more is fitted from there

# Of a clipped force, in standard deviations of its noise and as a share of the limit; of the time,
# in the direction in which it is clipped less.
_LEVEL, _SLOPE, _MOST_HELD = 3.0, 0.01, 0.25
_MARGIN = 0.01  # of the samples in contact, beyond the depth at which a law bends
_REACHED, _COVERED = 1.5, 5.0  # of the range of the force, and of that of motion or depth
_ABOVE_NOISE = 2.0  # of the positions
_RESOLVED = 0.125  # periods a sample: faster is the course of a force between samples
_LATE = 0.05  # of a sample period: stamps are known no better

Progress = Callable[[str], None]


def search(
    recordings: Recordings, base: Fit, progress: Progress, names: Sequence[str] | None = None
) -> list[Fit]:
    """
    Fit each candidate beside the effects of a model.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        Fitted together.
    base : Fit
        Without the candidates.
    progress : callable
        Called with the name of each.
    names : sequence of str, optional
        Candidates; all that may be added by default.

    Returns
    -------
    fits : list of Fit
        Plausible ones, best first by penalised cost; the best few are fitted to the end.

    """
    scales = measure_scales(recordings, base)
    near: list[Fit] = []
    # Starts are small: the derivatives by all other parameters stay nearly as they are.
    before = None if scales.driven else straight_at(recordings, base.model)
    for name in candidates_in(recordings, base.model) if names is None else names:
        progress(name)
        starts = _starts(base.model, name, scales)
        small = starts[0].base_values == base.model.base_values and (
            starts[0].free.sum() - len(names_of(name)) == base.model.free.sum())
        start = _best_start(recordings, starts, before if small else None)
        if EFFECTS[name].resonates and not scales.driven:
            start = _fit_on(recordings, start, 4)
        near.append(start)
    started = ranked((_fit_on(recordings, one, 4) for one in nearest(recordings, near)),
                     lambda found: found.cost + penalty(found.model))
    law = min((found.cost for found in started if not is_curve(recordings, found)), default=np.inf)
    fits, rest = list[Fit](), started[_FOLLOWED:]
    for found in started[:_FOLLOWED]:  # a curve that does not lead the laws is not taken
        if found.cost > law and is_curve(recordings, found):
            rest.append(found)
        else:
            fits.append(_fit_on(recordings, found, 8))
    fits = ranked(fits, lambda found: found.cost)
    fits[:_TO_END] = [fit_to_end(recordings, found) for found in fits[:_TO_END]]
    fits = [found for found in fits + rest if is_credible(recordings, found.model)]
    scale = noise_scale(min(fits, key=lambda found: found.cost)) if fits else 1.0
    return ranked(fits, lambda found: found.cost + scale * penalty(found.model))


def _starts(model: Model, name: str, scales: Scales) -> list[Model]:
    """Return a model with each start of an effect, and with the wall that keeps the force."""
    starts = [model.with_effect(name, values) for values in EFFECTS[name].starts(scales)]
    same_force = starts if EFFECTS[name].rescales_wall else []
    return [*(start.with_rescaled_wall() for start in same_force), *starts]


def _fit_on(recordings: Recordings, found: Fit, steps: int) -> Fit:
    return fit(recordings, found.model, steps, known=found.residuals)


def is_curve(recordings: Recordings, found: Fit) -> bool:
    """
    Return whether the last effect of a fit is a curve that follows any slow misfit.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        As fitted.
    found : Fit
        With effects.

    Returns
    -------
    curve : bool
        As of `is_flexible`.

    """
    return is_flexible(recordings, found.model, found.model.effects[-1])


def search_family(
    recordings: Recordings, model: Model, name: str, progress: Progress,
) -> list[Fit]:
    """
    Fit the other laws of its family in the place of an effect.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        Fitted together.
    model : Model
        With the effect.
    name : str
        Of the effect.
    progress : callable
        Called with the name of each.

    Returns
    -------
    fits : list of Fit
        Beside the other effects of the model, the best fit first.

    """
    rest = fit_without(recordings, model, (name,))
    laws = [law for law in candidates_in(recordings, rest.model)
            if EFFECTS[law].family == EFFECTS[name].family and law != name]
    return ranked(search(recordings, rest, progress, laws), lambda found: found.cost)


def is_credible(recordings: Recordings, model: Model) -> bool:
    """
    Return whether the values of a model are possible, and its last effect where they put it.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        As fitted.
    model : Model
        With effects.

    Returns
    -------
    credible : bool
        If so, recordings may show it.

    """
    return model.plausible() and may_show(recordings, model, model.effects[-1])


def may_show(recordings: Recordings, model: Model, name: str) -> bool:
    """
    Return whether recordings may show an effect where the values of a model put it.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        As fitted.
    model : Model
        With effects.
    name : str
        One of them.

    Returns
    -------
    shown : bool
        False for a saturating sensor that does not clip as one, and for a friction beyond the
        range of the force, which never slips: that is a spring. Nor is one shown that vanishes, an
        exponential of which the motion covers a parabola alone, a bend that the motion does not
        pass, a surface far beyond the motion, a play within the noise of the positions, a
        resonance of fewer than eight samples a period or of less than a period, a delay of less
        than a twentieth of a sample period, two tones too near one another, or too slow, for the
        duration, or a wall that moves in step with a cyclic test.

    """
    values = model.parameters_of(name)
    if EFFECTS[name].vanishes(values) or not _is_reached(recordings, model, name, values):
        return False
    return not EFFECTS[name].clips_force or _clips(recordings, model, values)


def _clips(recordings: Recordings, model: Model, values: Any) -> bool:
    """
    Return whether the force sensor clips as a saturating one does.

    The measured force is level where it would be held, though the motion is not, and not for most
    of the time to and fro, as friction holds it.
    """
    limit = values.limit
    held_by_side, count, moves = np.zeros(2), 0, False
    for one in recordings:
        o, force = one.observed, one.observed.force
        held = (np.abs(force - force_residual(one, model)) >= limit) & one.use
        held_by_side += np.bincount((force[held] > 0.0).astype(int), minlength=2)
        count += int(np.count_nonzero(one.use))
        if not held.any():
            continue
        if float(np.std(np.abs(force[held]))) > _LEVEL * one.force_noise + _SLOPE * limit:
            return False
        swing = np.hypot(model.stiffness * np.std(o.x[held]), model.damping * np.std(o.v[held]))
        moves = moves or bool(swing > one.force_noise)
    return moves and bool(held_by_side.min() <= _MOST_HELD * count)


def _is_reached(
    recordings: Recordings, model: Model, name: str, values: ParameterGroup
) -> bool:
    """Return whether force, motion, rate and duration are large enough for an effect to show."""
    cls = EFFECTS[name]
    force = getattr(values, cls.reached_force, 0.0)
    length = abs(getattr(values, cls.reached_length, 0.0))
    depth = getattr(values, cls.covered_depth, 0.0)
    resolved = getattr(values, cls.resolved_length, np.inf)
    frequency = getattr(values, cls.sampled_frequency, 0.0)
    delay = getattr(values, cls.sampled_delay, np.inf)
    return any(force <= _REACHED * float(np.ptp(one.observed.force))
               and length <= _COVERED * float(np.ptp(one.observed.x))
               and (not depth or depth <= _COVERED * _depth(one, model))
               and _passes(one, model, cls.bends(values))
               and resolved >= _ABOVE_NOISE * one.observed.position_noise
               and frequency * one.observed.h <= _RESOLVED
               and delay >= _LATE * one.observed.h
               and cls.exceeds_calibration(values, float(np.max(np.abs(one.observed.force))))
               and cls.is_resolved(values, float(one.observed.t[-1]))
               and not _keeps_step(one, cls.tones(values))
               for one in recordings)


def _keeps_step(recording: PreparedRecording, tones: tuple[float, ...]) -> bool:
    """Return whether a wall would move in step with a cyclic test, as what a law lacks does."""
    o = recording.observed
    return bool(tones) and keeps_step(tones, o.cycle, float(o.t[-1] - o.t[0]))


def _depth(recording: PreparedRecording, model: Model) -> float:
    """Return the range of the motion in contact [m]."""
    inside = recording.blocks(recording.observed.x)[recording.touching(model)]
    return float(np.ptp(inside)) if len(inside) else 0.0


def _passes(recording: PreparedRecording, model: Model, depths: Sequence[float]) -> bool:
    """Return whether the motion in contact passes depths, and not at its ends."""
    if not depths:
        return True
    laws, o = model.laws(), recording.observed
    x, v, _ = laws.at_wall(o)
    inside = recording.blocks(laws.contact.motion_along(o.t, x, v).d)[recording.touching(model)]
    if not len(inside):
        return False
    low, high = np.quantile(inside, (_MARGIN, 1.0 - _MARGIN))
    return bool(low < min(depths) and max(depths) < high)


def nearest(recordings: Recordings, near: Sequence[Fit]) -> list[Fit]:
    """
    Select the candidates that are worth fitting.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        As fitted.
    near : sequence of Fit
        One of each candidate.

    Returns
    -------
    nearest : list of Fit
        The best by penalised cost and the best law of each family, whose first step may be a small
        one, or its best curve if it has no law; with a discrepancy also the best in each channel,
        since the misfit of the other may be none of theirs.

    """
    if not near:
        return []
    price = [penalty(one.model) for one in near]
    costs = np.array([costs_by_channel(recordings, one) for one in near])
    names = [one.name for one in near]

    def by(cost: Array) -> list[int]:
        charged = (cost + price).tolist()
        return ranked_by(range(len(near)), lambda k: charged[k], lambda k: prior(names[k]))

    order = by(costs.sum(axis=1))
    curves = [is_curve(recordings, one) for one in near]
    laws_first = sorted(order, key=lambda k: curves[k])
    of_family = {EFFECTS[names[k]].family: k for k in reversed(laws_first)}
    kept = {*order[:_STARTED], *of_family.values()}
    for of_channel in costs.T if has_discrepancy(recordings) else ():
        if of_channel.any():
            kept |= set(by(of_channel)[:_OF_CHANNEL])
    return [near[k] for k in sorted(kept)]


def _best_start(
    recordings: Recordings, starts: Sequence[Model], before: Straight | None
) -> Fit:
    """Return the best model one step from the starts; parameters as `steps`."""
    taken = steps(recordings, starts, before)
    near, residuals = taken[0].model, taken[0].residuals
    if residuals is not None and not any(one.driven_by_force(near) for one in recordings):
        count = sum(one.residual_count for one in recordings)
        return Fit(near, taken[0].cost, residuals, count, False)
    return fit_at(recordings, _likeliest(recordings, starts, taken))


def _likeliest(recordings: Recordings, starts: Sequence[Model], taken: Sequence[Step]) -> Model:
    """Return the best model of starts and steps of walls that a force drives."""
    near = taken[0].model
    if not all(recording.driven_by_force(near) for recording in recordings):
        return near
    cost, enough = cost_of(recordings, near), _FAR * sum(one.residual_count for one in recordings)
    if len(starts) < _MANY and cost < enough:
        return near
    # Of many starts, one step tells little of where each of them leads.
    costs = [cost_of(recordings, model) for model in starts]
    if cost < min(enough, *costs):
        return near
    # Far from the optimum the memory of a resonant wall misleads the search, and one step is too
    # long for a strongly nonlinear law.
    brief = [fit(recordings, step.start, steps=8, briefly=True).model
             for step in taken[:1 + len(starts) // _MANY]]
    costs += [cost, *(cost_of(recordings, model) for model in brief)]
    every = [*starts, near, *brief]
    return every[ranked_by(range(len(every)), lambda k: costs[k])[0]]
