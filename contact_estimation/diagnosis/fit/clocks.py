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

"""Whether a topic is stamped late or early, which looks like a delay, a mass or a memory."""

from __future__ import annotations

from dataclasses import replace
from typing import Callable, Iterator, NamedTuple, Sequence

import numpy as np
from scipy.optimize import minimize_scalar

from .criteria import leaves_noise
from .fitting import Fit, fit, fit_at
from .model_uncertainty import discounted
from .selection import Selection
from ..observe.model import Model
from ..observe.prepared_recording import prepare, PreparedRecording, Recordings
from ..observe.signals import Recording, Signals
from ...physics import EFFECTS

Select = Callable[[Sequence[Recording]], tuple[Recordings, Selection]]

_DELAY = 'command_delay'
_SCANNED = (0.0015, 0.003, 0.005, 0.008, 0.012, 0.018, 0.027)  # [s]
_SCANNED_EARLY = (0.0015, 0.003, 0.006, 0.012, 0.024)
_TRIED = (1.0, 1.2)  # times the delay: what bends beside it makes it too short
_PROMISING, _WITH_DELAY = 0.75, 1.4  # most of the misfit of the effects, for stamps to be tried
# The same of early stamps: near those that leave least, there, and there without any effect.
_NEARBY, _EARLY, _ALONE = 4.0, 0.9, 0.4
_LESS = 0.95  # most of what the same model leaves of the stamps as recorded, near those
_FEWER = 0.8  # most of it that other stamps may leave with fewer effects, none that they look like
_LEFT = 0.25  # most of it that other stamps may leave
_DAMPED = 0.05  # of the damping without a shift
_LEAST, _LEAST_EARLY = 0.003, 0.0012  # [s]: less late is a sensor's filter
_OF_PERIOD = 0.9  # of a sample: less is the course of the signals between samples
_CAUSED = ('timing', 'inertia', 'relaxation')  # families that early stamps look like


class Offset(NamedTuple):
    """
    A topic whose stamps differ from those of the others.

    Attributes
    ----------
    topic : str
        'joint_states' or 'wrench'.
    seconds : float
        By how much they are late [s]; negative if they are early.

    """

    topic: str
    seconds: float

    def times(self, factor: float) -> 'Offset':
        """Return a multiple of the offset."""
        return self._replace(seconds=factor * self.seconds)

    def put_right(self, signals: Signals) -> Signals:
        """Shift the stamps of a recording, which count from the first wrench."""
        others = self.seconds if self.topic == 'wrench' else 0.0
        joints = others - (self.seconds if self.topic == 'joint_states' else 0.0)
        return signals._replace(
            joint_t=signals.joint_t + joints, reference_t=signals.reference_t + others)


class Clocks:
    """
    Comparison of stamps as recorded with others.

    A robot that moves late meets the wall where the wall is. One whose stamps are late meets it
    before it is there, by its speed times the lateness. A wall that a force drives moves with it.
    No sensor measures a force before there is one, nor a position, so that a wrench or joint
    states that are early have wrong stamps.

    Parameters
    ----------
    raw : sequence of Recording
        As recorded.
    recordings : sequence of PreparedRecording
        The same, prepared, without a discrepancy.
    base, best : Model
        Recalibrated, and with the effects that were selected.
    hold : int
        Which part of each recording is held out, as for `prepare`.

    """

    def __init__(
        self, raw: Sequence[Recording], recordings: Recordings, base: Model, best: Model,
        hold: int,
    ) -> None:
        self._raw, self._recordings, self._base, self._hold = raw, recordings, base, hold
        self._delay = best.values[best.place(_DELAY).start] if _DELAY in best.effects else 0.0
        self._rest = best.without(_DELAY) if self._delay else best
        self._lawful = _without_caused(best)
        commanded = all(one.observed.reference is not None for one in recordings)
        caused = self._lawful.effects != best.effects
        self._may_be_early = commanded and (caused or not best.effects)
        found = fit(recordings, best)
        self._explained = leaves_noise(found)
        self._misfit = _misfit(found)
        self._nearby: dict[tuple[Model, str], Model] = {}  # as fitted to the last offset tried

    def offset(self, select: Select) -> Offset | None:
        """
        Find the topic whose stamps differ.

        Parameters
        ----------
        select : callable
            Selects the effects of other recordings.

        Returns
        -------
        offset : Offset or None
            None unless it is that of a sample or more, or a filter, and leaves less than
            a quarter of what the effects leave (four fifths with fewer effects, none of them a
            delay, mass or memory), and a wall with damping: a shift that takes the place of it is
            none.

        """
        if self._explained:
            return None
        period = max(float(np.median(np.diff(one.signals.joint_t))) for one in self._raw)
        for tried in self._tried():
            least = max(_LEAST, _OF_PERIOD * period) if tried.seconds > 0.0 else _LEAST_EARLY
            if abs(tried.seconds) < least:
                continue
            shifted, selection = select(self._shifted(tried))
            model, lawful = selection.best.model, _without_caused(selection.best.model)
            # A memory may only make up for what an offset near the right one leaves.
            for kept in (model,) if lawful == model else (model, _with_nominal_wall(lawful)):
                nearer = self._refined(tried, kept)  # the scan may have had other effects
                for found in (fit(shifted, kept), fit(self._prepared(nearer), kept)):
                    if self._explains(found):
                        return self._fitted(nearer, found.model)
        return None

    def _explains(self, found: Fit) -> bool:
        """Return whether the stamps explain more than the effects do, or more with fewer."""
        damped = _damping(found.model) >= _DAMPED * _damping(self._base)
        names, before = set(found.model.effects), set(self._rest.effects)
        fewer = len(names) < len(before) and not any(
            EFFECTS[name].family in _CAUSED for name in names)
        return damped and _misfit(found) < (_FEWER if fewer else _LEFT) * self._misfit

    def _tried(self) -> Iterator[Offset]:
        """Yield the offsets that a selection may confirm, the likeliest of a topic first."""
        most = _WITH_DELAY if self._delay else _PROMISING
        late = self._nearest('joint_states', 1.0, (self._base, self._rest), most, most)
        if late is not None:
            yield late
            yield from (Offset('joint_states', share * self._delay)
                        for share in _TRIED if self._delay)
        if self._may_be_early:
            for topic in ('wrench', 'joint_states'):
                early = self._nearest(topic, -1.0, (self._lawful,), _NEARBY,
                                      _EARLY if self._rest.effects else _ALONE)
                if early is not None:
                    yield early

    def _nearest(
        self, topic: str, sign: float, models: Sequence[Model], scanned: float, refined: float
    ) -> Offset | None:
        """
        Return the offset that leaves least.

        None if one that is scanned, or the best nearby, leaves more than so much of the misfit.
        """
        scans: dict[Model, list[tuple[float, float]]] = {model: [] for model in models}
        for by in _SCANNED if sign > 0.0 else _SCANNED_EARLY:
            # A scan that rises leads away from the stamps that leave least.
            going_on = [model for model, scan in scans.items() if not _rises(scan)]
            if not going_on:
                break
            offset = Offset(topic, sign * by)
            prepared = self._prepared(offset)
            for model in going_on:
                scans[model].append((self._left(offset, model, prepared), by))
        model = min(scans, key=lambda model: min(scans[model]))
        least, by = min(scans[model])
        if least > scanned * self._misfit:
            return None
        if sign < 0.0 and least > _LESS * self._left(Offset(topic, 0.0), model):
            return None  # no other stamps are needed
        nearby = self._refined(Offset(topic, sign * by), model)
        left = min(least, self._left(nearby, model))
        return nearby if left <= refined * self._misfit else None

    def _refined(self, offset: Offset, model: Model) -> Offset:
        """Return the offset near one at which a model leaves least."""
        return _least(offset, lambda near: self._left(near, model))

    def _fitted(self, offset: Offset, model: Model) -> Offset:
        """Fit an offset together with a model that explains the recordings."""
        return _least(offset, lambda near: _misfit(fit(self._prepared(near), model)))

    def _left(self, offset: Offset, model: Model, prepared: Recordings = ()) -> float:
        """Return the misfit of effects that are not selected again."""
        prepared = prepared or self._prepared(offset)
        starts = [_with_nominal_wall(model)]  # what is late bends the damping, not the others
        if offset.seconds < 0.0 and len(model.effects) > 1:
            starts.append(model)
        if (model, offset.topic) in self._nearby:
            starts.append(self._nearby[model, offset.topic])
        near = min((fit_at(prepared, start) for start in starts), key=lambda one: one.cost)
        found = fit(prepared, near.model, steps=8, known=near.residuals)
        self._nearby[model, offset.topic] = found.model
        return _misfit(found)

    def _prepared(self, offset: Offset) -> Recordings:
        return [self._discounted_as(before, prepare(one, self._base, hold=self._hold))
                for before, one in zip(self._recordings, self._shifted(offset))]

    def _discounted_as(
        self, before: PreparedRecording, shifted: PreparedRecording
    ) -> PreparedRecording:
        """Discount what is uncertain as before the shift, which moves it little."""
        if shifted.block_count != before.block_count:
            return discounted(shifted, self._base)
        return replace(shifted, discount=before.discount)

    def _shifted(self, offset: Offset) -> list[Recording]:
        return [replace(one, signals=offset.put_right(one.signals)) for one in self._raw]


def _rises(scan: Sequence[tuple[float, float]]) -> bool:
    """Return whether the last two offsets of a scan each leave more than the one before."""
    left = [left for left, _ in scan[-3:]]
    return len(left) == 3 and left[0] < left[1] < left[2]


def _least(offset: Offset, left: Callable[[Offset], float]) -> Offset:
    """Return the offset near one that leaves least."""
    nearby = minimize_scalar(lambda share: left(offset.times(share)), method='bounded',
                             bounds=(0.7, 1.4), options={'maxiter': 8})
    return offset.times(float(nearby.x))


def _without_caused(model: Model) -> Model:
    """Return a model without the effects that early stamps look like."""
    return model.without(*(name for name in model.effects if EFFECTS[name].family in _CAUSED))


def _with_nominal_wall(model: Model) -> Model:
    nominal = Model.of(model.nominal).values
    return model.at([*nominal, *model.values[len(nominal):]])


def _damping(model: Model) -> float:
    return model.laws().contact.damping


def _misfit(found: Fit) -> float:
    """Return the cost beyond noise."""
    return found.cost - found.residual_count
