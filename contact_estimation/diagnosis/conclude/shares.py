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

"""How much of the misfit each named effect predicts on parts that were not fitted."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Mapping, NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray

from .result import EffectOnPart
from ..fit.discrepancy import weighed
from ..fit.first_step import fit_without
from ..fit.fitting import cost_of, Fit, fit
from ..fit.invariance import (
    channel_by_gain,
    errors_with_own_size,
    jacobian_of,
    judged_by_channel,
    left_out_errors,
    values_on,
)
from ..fit.parts import above_noise, evened, noise_of, Part, parts_of
from ..fit.share import Share, share_of
from ..fit.zeros import is_zero, without_laws
from ..observe.model import Model, names_of
from ..observe.prepared_recording import is_flexible, Recordings
from ...physics import EFFECTS

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

_LEFT = 0.5  # of the cost, by the zeros: more hides no law
_SPREAD = 1.0  # median deviation of a magnitude between parts, over its median
_CONSTANT = 0.2  # the same, of a law that is told by the likelihood
_INFORMED = 0.1  # least information on a magnitude, in that of the part that tells most
_ALIKE = 0.3  # least ratio of that median and the magnitude on all parts, either way


@dataclass(frozen=True, eq=False)
class Shares:
    """
    Shares of the recalibrated model's misfit above the noise, on parts left out.

    Attributes
    ----------
    recordings : sequence of PreparedRecording
        With the misfit of the recalibrated model as discrepancy: every channel counts alike.
    parts : sequence of Part
        Each left out in turn.
    base : ndarray, shape (parts, CHANNELS)
        Errors of the recalibrated model on parts left out.
    best : Fit
        With all named effects.
    errors : ndarray, shape (parts, CHANNELS)
        Its errors.
    of : dict of str to Share
        For each effect what the model without it leaves beyond that.
    of_channel : dict of str to Share
        The same of the misfit in the channel by which the effect is judged.
    beside : dict of str to Share
        In that channel, what the model with all other named effects leaves beyond that; of both
        laws of a pair, what both predict.
    in_form : dict of str to Share
        Of the effect that holds in form alone: what it explains with its size free on each part.
    beside_zeros : Shares or None
        Shares of the laws in what the recalibrated model with the named zeros leaves; None without
        zeros or laws, or where they leave more than half. A sensor that is not tared hides no law.

    """

    recordings: Recordings
    parts: Sequence[Part]
    base: Array
    best: Fit
    errors: Array
    of: dict[str, Share]
    of_channel: dict[str, Share]
    beside: dict[str, Share]
    in_form: dict[str, Share]
    beside_zeros: 'Shares | None' = None

    @property
    def explained(self) -> float:
        """Share that all names together predict."""
        return 1.0 - self.left

    @property
    def left(self) -> float:
        """Share that all names together leave, at least 0; all where they predict nothing."""
        noise = float(noise_of(self.base, self.parts).sum())
        misfit = float(above_noise(self.base, self.parts).sum())
        gain = float(self.base.sum() - self.errors.sum())
        return max(float(self.errors.sum()) - noise, misfit - gain, 0.0) / misfit

    def on_parts(self, name: str) -> list[EffectOnPart]:
        """Return the share and the parameters of an effect on each part alone."""
        place = self.best.model.place(name)
        return [EffectOnPart(part.name, float(share), dict(zip(names_of(name), alone[place])))
                for part, share, alone in zip(self.parts, self.of[name].parts, self._alone)]

    def agrees(self, name: str) -> bool:
        """Return whether the magnitude of an effect is much the same on each part and on all."""
        sizes, whole = self._magnitudes(name)
        if EFFECTS[name].accumulates and sizes[0] < _ALIKE * whole:
            return False
        informed = self._informed(name)
        return _agree(sizes, whole) or (
            int(np.count_nonzero(informed)) > 1 and _agree(sizes[informed], whole))

    def is_constant(self, name: str) -> bool:
        """
        Return whether an effect is sure and its magnitude the same on most parts and on all.

        Those parts count that tell it, such as contacts in which a limit is reached, if there are
        two.
        """
        sizes, whole = self._magnitudes(name)
        off, informed = np.abs(sizes - whole), self._informed(name)
        usual = np.median(off[informed] if np.count_nonzero(informed) > 1 else off)
        return self.sure(name) > 0.0 and bool(usual <= _CONSTANT * abs(whole))

    def _informed(self, name: str) -> Flags:
        """Return which parts tell a tenth as much of the magnitude as the best, shape (parts,)."""
        told = self._information[:, self.best.model.place(name).start]
        return np.asarray(told >= _INFORMED * told.max())

    def _magnitudes(self, name: str) -> tuple[Array, float]:
        """Return the magnitude of an effect on each part alone, and on all."""
        place = self.best.model.place(name).start
        neutral = EFFECTS[name].neutral.get(names_of(name)[0], 0.0)
        sizes = np.array([alone[place] - neutral for alone in self._alone])
        return sizes, self.best.model.values[place] - neutral

    def sure(self, name: str) -> float:
        """Return the largest lower end of the shares of an effect, see `most`."""
        return max(share.interval[0] for share in self._judged(name))

    def most(self, name: str) -> float:
        """Return the largest share of an effect: its own, beside the others, or beside zeros."""
        return max(share.share for share in self._judged(name))

    def of_rest(self, name: str) -> Share | None:
        """Return the share of a law in what the zeros leave; None without zeros."""
        rest = self.beside_zeros
        return rest.of[name] if rest is not None and name in rest.of else None

    def _judged(self, name: str) -> list[Share]:
        judged, rest = [self.of_channel[name], self.beside[name]], self.beside_zeros
        if rest is not None and name in rest.of:
            judged += [rest.of_channel[name], rest.beside[name]]
        return judged

    def error_without(self, names: Sequence[str]) -> float:
        """Return the sum of the squared errors on parts left out, without some effects."""
        found = fit_without(self.recordings, self.best.model, names)
        return float(left_out_errors(self.recordings, found, self.parts, self.base).sum())

    def is_flexible(self, name: str) -> bool:
        """Return whether an effect is a curve that fits almost any misfit of its kind."""
        return is_flexible(self.recordings, self.best.model, name)

    @cached_property
    def _information(self) -> Array:
        """Return what each part tells about each value of the model, shape (parts, P)."""
        jacobian = jacobian_of(self.recordings, self.best)
        told = np.zeros((len(self.parts), len(self.best.model.values)))
        told[:, self.best.model.free] = [
            part.weights @ jacobian[part.there] ** 2 for part in self.parts]
        return told

    @cached_property
    def _alone(self) -> list[tuple[float, ...]]:
        """Return the values of the model on each part alone."""
        return [values_on(self.recordings, self.best, part).values for part in self.parts]


def _agree(sizes: Array, whole: float) -> bool:
    """Return whether magnitudes on parts are much the same, and that on all."""
    usual = float(np.median(sizes))
    if not _ALIKE * abs(whole) <= usual * np.sign(whole) <= abs(whole) / _ALIKE:
        return False
    return float(np.median(np.abs(sizes - usual))) <= _SPREAD * abs(usual)


def shares_of(
    recordings: Recordings, base: Model, best: Model, in_form: str = '',
    pair: Sequence[str] = (),
) -> Shares:
    """
    Compute the shares of all effects of a model.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        As fitted.
    base, best : Model
        Recalibrated, and with effects in the order in which they were taken.
    in_form : str
        The last effect, if it holds in form alone.
    pair : sequence of str
        Two effects in a row that predict only together; each has the mean of its shares alone and
        beside the other (Shapley value), as have an effect that does harm without the next and
        that one.

    Returns
    -------
    shares : Shares
        Those of the effects add up to `explained`.

    """
    found = _shares_of(recordings, base, best, in_form, pair)
    zeros = tuple(name for name in best.effects if is_zero(name))
    laws = tuple(name for name in best.effects if name not in zeros)
    if not zeros or not laws:
        return found
    bare = without_laws(recordings, best)
    if bare.cost > _LEFT * cost_of(recordings, base):
        return found
    both = pair if set(pair) <= set(laws) else ()
    rest = _shares_of(recordings, bare.model, best.in_order((*zeros, *laws)), in_form, both)
    return replace(found, beside_zeros=rest)


def _shares_of(
    recordings: Recordings, base: Model, best: Model, in_form: str, pair: Sequence[str]
) -> Shares:
    """Compute the shares of the effects that a base model, with zeros or without, lacks."""
    names = best.effects[len(base.effects):]
    carried = weighed(recordings, base)
    first = fit(carried, base)
    # The parts are those on which the effects were taken.
    zeroed = without_laws(carried, best) if any(map(is_zero, names)) else first
    parts = parts_of(carried, zeroed)
    parts, base_errors = evened(parts, left_out_errors(carried, first, parts))
    errors = base_errors
    model, found, shares, of_channel = base, first, dict[str, Share](), dict[str, Share]()
    channels, by_channel = dict[str, int | None](), judged_by_channel(carried, base)
    steps = dict[str, _Step]()
    for name in names:
        model = model.with_effect(name, best.values[best.place(name)])
        start = best if model.effects == best.effects else model
        found = fit(carried, start)
        before, errors = errors, left_out_errors(carried, found, parts, errors)
        steps[name] = _Step(found, before, errors)
        channels[name] = (channel_by_gain(name, (before - errors).sum(axis=0)) if by_channel
                          else None)
        shares[name] = share_of(before, errors, parts, base_errors)
        of_channel[name] = share_of(before, errors, parts, base_errors, channels[name])
    beside = {names[-1]: of_channel[names[-1]]}
    for name in names[:-1]:
        without = left_out_errors(
            carried, fit_without(carried, best, (name,)), parts, base_errors)
        beside[name] = share_of(without, errors, parts, base_errors, channels[name])
    together = pair or _only_together(names, shares, channels)
    if together:
        outset, both = steps[together[0]].before, steps[together[1]].after
        gains = _gains_of_pair(carried, parts, steps[together[0]], steps[together[1]])
        for name, gain in zip(together, gains):
            shares[name] = share_of(outset, outset - gain, parts, base_errors)
            of_channel[name] = share_of(outset, outset - gain, parts, base_errors, channels[name])
    for name in pair:
        beside[name] = share_of(outset, both, parts, base_errors, channels[name])
    own = dict[str, Share]()
    if in_form:
        free = errors_with_own_size(carried, found, parts)
        own[in_form] = share_of(before, free, parts, base_errors, channels[in_form])
    return Shares(carried, parts, base_errors, found, errors, shares, of_channel, beside, own)


class _Step(NamedTuple):
    """A fit with one more effect, and the errors on parts left out before and with it."""

    found: Fit
    before: Array
    after: Array


def _only_together(
    names: Sequence[str], shares: Mapping[str, Share], channels: Mapping[str, int | None],
) -> tuple[str, ...]:
    """Return an effect that alone does harm, and the next, beside which it may help."""
    for name, following in zip(names, names[1:]):
        if shares[name].share < 0.0 and channels[name] == channels[following]:
            return name, following
    return ()


def _gains_of_pair(
    recordings: Recordings, parts: Sequence[Part], first: _Step, second: _Step
) -> tuple[Array, Array]:
    """Return what each law of a pair takes away, on average over their order; never harm alone."""
    outset, both = first.before, second.after
    other = fit_without(recordings, second.found.model, first.found.model.effects[-1:])
    without_second = np.minimum(first.after, outset)
    without_first = np.minimum(left_out_errors(recordings, other, parts, outset), outset)
    change = 0.5 * (without_first - without_second)
    return 0.5 * (outset - both) + change, 0.5 * (outset - both) - change
