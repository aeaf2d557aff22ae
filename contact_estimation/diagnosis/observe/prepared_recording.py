# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""A recording that is ready to be fitted: smoothed, its noise known, a part held out."""

from dataclasses import dataclass, field, replace
from functools import cached_property
from math import sqrt
from typing import Any, Callable, Sequence

import numpy as np

from .channel import (
    Channel, Discount, force_error, force_noise, innovation_error, motion_noise, sum_blocks)
from .model import Model
from .observed import observe, Observed
from .observer import FORGOTTEN
from .parts import HeldOut, hold_out, require_contact
from .signals import Recording
from .usable_samples import default_block, force_drops, held_at_rest, usable
from ...physics.numeric import Array, Flags, SecondOrder

_SLOPE_S = 0.02  # over which the rate of the force is averaged
_MOST = 8  # a model and those that differ from it in one value


class Latest:
    """The latest results of a function, by what they depend on."""

    def __init__(self) -> None:
        self._known: list[tuple[object, Any]] = []

    def of(self, key: object, compute: Callable[[], Any]) -> Any:
        """Return a result, computed only if it is not among the latest."""
        for place, (known, result) in enumerate(self._known):
            if known == key:
                self._known.append(self._known.pop(place))
                return result
        result = compute()
        self._known.append((key, result))
        del self._known[:-_MOST]
        return result


@dataclass(frozen=True, eq=False)
class PreparedRecording:
    """All inputs of the residuals except the model, see `residuals`."""

    name: str  # that of the recording
    observed: Observed  # force and motion on an even grid
    # force_noise, motion_noise: standard deviations of the errors of a correct model, a sample
    # [N], [m]
    force_noise: float
    motion_noise: float
    use: Flags  # (N,) samples that count
    block: int  # samples averaged to one residual
    held_out: HeldOut | None = None  # the part excluded from fitting; None where all is fitted
    simulated: bool = False  # as of the recording
    # (N,) samples at which the force vanished during contact, see `force_drops`. A model without
    # an effect that releases the contact is charged for each of them
    dropped: Flags | None = None
    # robot dynamics that whiten the motion: the nominal ones for all models, or their residuals
    # could not be compared. None without a robot
    observer: SecondOrder | None = None
    # directions weighed down for model uncertainty; None as long as they are not known
    discount: Discount | None = None
    # force_discrepancy, motion_discrepancy: standard deviations of what no law explains [N], [m],
    # see `with_discrepancy`
    force_discrepancy: float = 0.0
    motion_discrepancy: float = 0.0
    sensor_error: float = 0.0  # as of the recording
    # factor by which the discrepancy of a wall that a force drives exceeds the force noise
    widening: float = 1.0
    # of Picard's iteration for a wall without a robot; 1: effects at the measured motion
    picard_rounds: int = 1
    # force_error, motion_error (N,): standard deviations of the predictions of a correct model
    # from a motion that is coarse in time or position [N], [m]; None where they are negligible
    force_error: Array | None = None
    motion_error: Array | None = None
    # walls, robots: what the latest models expect at the wall, and the innovations without one
    walls: Latest = field(default_factory=Latest, init=False, repr=False)
    robots: Latest = field(default_factory=Latest, init=False, repr=False)
    # the latest fits to this recording and others, see `fit`
    fits: Latest = field(default_factory=Latest, init=False, repr=False)

    @classmethod
    def of(
        cls, name: str, observed: Observed, model: Model, held_out: HeldOut | None = None
    ) -> 'PreparedRecording':
        """Measure the noise of a smoothed recording and choose the samples that count."""
        o, use = observed, usable(model, observed)
        if held_out is not None:
            use = use & ~held_out.samples
        noise = force_noise(model, o)
        observer = o.observer_of(model.nominal)
        laws = model.laws()
        return cls(
            name, o, noise, motion_noise(model, o, noise), use, default_block(o), held_out,
            dropped=(force_drops(o, noise, laws.touching(o)) if laws.contact.unilateral
                     else None),
            observer=observer, force_error=force_error(model, o),
            motion_error=innovation_error(model, o, observer))

    @cached_property
    def force(self) -> Channel:
        """Return the force channel: samples with a measured force, none at the edges of drops."""
        o = self.observed
        use = self.use & o.measured
        if self.dropped is not None:  # the instant of release within a sample is unknown
            use = use.copy()
            for edge in _edges(self.dropped):
                use[max(0, edge - 1):edge + 3] = False
        rate = np.gradient(o.force, o.h) if o.jitter * o.h > 0.0 else np.zeros(len(o.t))
        span = max(1, round(_SLOPE_S * o.pace / o.h))
        slope = np.convolve(rate, np.ones(span) / span, mode='same')
        spread = np.hypot(1.0, slope * o.jitter / self.force_noise)
        spread = self._widened(spread, self.force_error, self.force_noise)
        return Channel(self.force_noise, spread, use, self.block, self.force_discrepancy)

    @cached_property
    def motion(self) -> Channel:
        """Return the motion channel: innovations of the position."""
        o, use = self.observed, self.use
        if self.dropped is not None:
            use = use.copy()
            forgotten = round(FORGOTTEN / (o.observer_cutoff * o.h))
            for edge in _edges(self.dropped):  # shorter drops between samples come before
                use[max(0, edge - forgotten // 2):edge + forgotten] = False
        if o.sampled is not None:
            use = use & o.sampled
        spread = np.hypot(1.0, o.v * o.jitter / self.motion_noise)
        spread = self._widened(spread, self.motion_error, self.motion_noise)
        return Channel(self.motion_noise, spread, use, self.block, self.motion_discrepancy)

    def channels(self, model: Model) -> tuple[Channel, ...]:
        """Return the channels in the order of the stacked residuals."""
        if self.driven_by_force(model):
            return (self.motion,)
        return (self.force, self.motion) if self.observed.reference is not None else (self.force,)

    def _widened(self, spread: Array, error: Array | None, noise: float) -> Array:
        if error is None:
            return spread
        # The error is the same throughout a block, and no average makes it smaller.
        return np.hypot(spread, sqrt(self.block) * error / noise)

    @property
    def residual_count(self) -> int:
        """Return the number of residuals that are not empty."""
        both = self.observed.reference is not None
        channels = (self.force, self.motion) if both else (self.force,)
        return sum(int(np.count_nonzero(channel.filled)) for channel in channels)

    @property
    def block_count(self) -> int:
        """Return the number of blocks."""
        return len(self.observed.t) // self.block

    @property
    def block_s(self) -> float:
        """Duration of a block [s]."""
        return self.observed.h * self.block

    @property
    def carries_discrepancy(self) -> bool:
        """Return whether what no law explains has a size of its own."""
        return self.force_discrepancy > 0.0 or self.motion_discrepancy > 0.0

    def driven_by_force(self, model: Model) -> bool:
        """Return whether there is no robot, but a wall whose mass the measured force moves."""
        return self.observed.driven_by_force(model.nominal)

    def with_force_between_samples(self, between: str, model: Model) -> 'PreparedRecording':
        """Return the recording with another course of the force between samples, `BETWEEN`."""
        return self._filtered_again(model, observed=replace(self.observed, between=between))

    def widened(self, widening: float, model: Model) -> 'PreparedRecording':
        """Return the recording with a filter that expects forces beyond the noise."""
        return self._filtered_again(model, widening=widening)

    def in_blocks(self, block: int, model: Model) -> 'PreparedRecording':
        """Return the recording with other blocks."""
        return self._filtered_again(model, block=block)

    def _filtered_again(self, model: Model, **changes: Any) -> 'PreparedRecording':
        """Return the recording with changes on which the noise of the innovations depends."""
        one = replace(self, discount=None, **changes)
        return replace(one, motion_noise=motion_noise(
            model, one.observed, one.force_noise, one.widening, one.block))

    def whole(self, model: Model) -> 'PreparedRecording':
        """Return the recording with its held-out part among the samples that count."""
        return replace(self, use=usable(model, self.observed), discount=None)

    def split(self, residuals: Array) -> Array:
        """Split stacked residuals into channels."""
        return residuals.reshape(-1, self.block_count)

    def blocks(self, signal: Array) -> Array:
        """Return the mean of a signal, shape (N,), over each block, shape (blocks,)."""
        return sum_blocks(signal, self.block) / self.block

    def touching(self, model: Model) -> Flags:
        """Find the blocks in contact."""
        o, laws = self.observed, model.laws()
        if not laws.contact.unilateral:
            return np.ones(self.block_count, bool)
        return self.blocks(laws.touching(o).astype(float)) > 0.5


Recordings = Sequence[PreparedRecording]


def prepare(recording: Recording, model: Model, hold: bool) -> PreparedRecording:
    """Smooth a recording, measure its noise, hold a part out."""
    observed = observe(recording.signals, model.nominal)
    if not recording.rests_count:
        observed = replace(observed, held=held_at_rest(model, observed))
    require_contact(model, observed, recording.name)
    held_out = hold_out(model, observed) if hold else None
    prepared = PreparedRecording.of(recording.name, observed, model, held_out)
    return replace(
        prepared, simulated=recording.simulated, sensor_error=recording.sensor_error)


def _edges(flags: Flags) -> list[int]:
    return np.flatnonzero(np.diff(flags.astype(int))).tolist()
