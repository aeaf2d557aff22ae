# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The posterior of the wall, sample by sample."""

from itertools import chain, repeat
from math import inf, isfinite, nan
from typing import Iterator

import numpy as np

from .blocks import Blocks, FIRST
from .contact import CONTACT, ContactFilter, FREE
from .inference import WallInference
from .knowledge import Knowledge
from .laws import Array


GREATEST = 1e5
"""A larger force is no measurement [N]."""


class Backlog:
    """Consecutive samples, and which of them may be taken at once."""

    def __init__(self, t: Array, force: Array, x: Array, v: Array) -> None:
        self._arrays = t, force, x
        self.t, self._force, self._x, self._v = (one.tolist() for one in (t, force, x, v))
        self._dt: list[float] = []
        self._others: list[int] = []  # from the last to the first
        self._period_s = -1.0

    def sample(self, k: int) -> tuple[float, float, float, float]:
        """Return a sample as arguments of `take`."""
        return self.t[k], self._force[k], self._x[k], self._v[k]

    def part(self, begin: int, end: int) -> tuple[list[float], list[float], list[float]]:
        """Return time steps, forces and positions."""
        return self._dt[begin:end], self._force[begin:end], self._x[begin:end]

    def steady_until(self, k: int, blocks: Blocks) -> int:
        """Return the first sample from here on that must be taken alone."""
        if k and not blocks.noted(self.t[k - 1], self._x[k - 1]):
            return k
        if blocks.period_s != self._period_s:
            self._period_s = blocks.period_s
            t, force, x = (one[k:] for one in self._arrays)
            dt, steady = blocks.steady(t, x)
            others = np.flatnonzero(~(steady & (np.abs(force) < GREATEST)))
            self._dt[k:] = dt.tolist()
            self._others = [len(self.t), *(k + others[::-1]).tolist()]
        while self._others[-1] < k:
            self._others.pop()
        return self._others[-1]


_FEW = 4  # samples that are not worth a run
_TAP_S = 0.06  # contact that is shorter has few rows or none beside those of its touch
_PARTS = 14  # at most, of the work on a block
_DONE = object()


class WallPosterior:
    """
    Hypotheses of contact, law, surface and changes of a wall, weighed by their evidence.

    Samples are judged for contact one by one. In contact they become blocks, of 20 ms while the
    wall is new or surprises, later of 40 and 160 ms: rows of smoothed columns, in which every law
    is linear, and their Gram matrix. A hypothesis is a small linear fit of some columns to the sum
    of these matrices. What contacts add up is carried from one to the next.

    location, location_std: x_e as told, NaN where unknown, and its standard deviation [m]
    lag: prior of the lag of the force sensor [s]
    position_noise: least standard deviation of the position [m]
    minimum_force, least_noise: contact begins above this force; least standard deviation of the
    force [N]
    contact: the state of contact and the noise of the force
    wall: what the blocks say of the wall
    """

    def __init__(
        self, location: float = nan, location_std: float = 2e-3,
        lag: tuple[float, float] = (1.2e-3, 1e-3), position_noise: float = 0.0,
        minimum_force: float = 0.0, least_noise: float = 1e-3,
    ) -> None:
        self._told = location, location_std
        self.blocks = Blocks(position_noise)
        self.contact = ContactFilter(minimum_force, least_noise)
        self.wall = WallInference(location, location_std, lag, self.blocks, self.contact)
        self._first: list[tuple[float, ...]] = []
        self.restart()

    def expect(self, surface: float, std: float) -> None:
        """Use a surface that the first touch has shown [m]."""
        self._begin_work(None)  # what is judged now has other surfaces
        self.wall.expect(surface, std)

    def keep(self, contact: ContactFilter) -> None:
        """Use the noise and the level of another posterior on the same samples."""
        self.contact.keep(contact)

    @property
    def known(self) -> Knowledge:
        """Return what is known of the wall now."""
        return self.wall.known

    @property
    def period_s(self) -> float:
        """Period of the samples as measured [s]; 0 before 20 of them."""
        return self.blocks.period_s

    def restart(self) -> None:
        """Begin anew with the next sample, as after a gap or a jump of the clock."""
        self.blocks.restart()
        self._work: Iterator[None] | None = None
        self._touch_t, self._left_t = nan, -inf

    # -- samples ----------------------------------------------------------------------------

    def take(
        self, t: float, force: float, x: float, v: float = nan, usable: bool = True,
        felt: tuple[float, float] | None = None, bent: tuple[float, float] = (0.0, 0.0),
    ) -> int:
        """
        Process a sample.

        t: stamp, after the last one [s]
        force, x, v: pressing force [N], position [m] and its measured rate, NaN without [m/s]
        usable: whether the wall is to be learned from it
        felt: force and position by which contact is judged, where these are others
        bent: where known physics bend the wall: how much more than x the displacement is that B_e
        damps [m], and the slope of x over the depth less 1
        """
        felt_force, felt_x = felt or (force, x)
        blocks, contact = self.blocks, self.contact
        if not (-GREATEST < felt_force < GREATEST and isfinite(force) and isfinite(x)):
            return contact.state
        dt = blocks.step(t, felt_x)
        if not dt:
            return contact.state
        if not blocks.period_s:
            self._begin(t, felt_force, felt_x)
            return FREE
        if blocks.left:
            self._begin_work(self.wall.parts_of(blocks.left))
            blocks.left = 0
        if self._work is not None:
            self._continue_work()
        before = contact.state
        contact.take((dt,), (felt_force,), (felt_x,), *self.wall.known[4:6])
        if contact.state != before:
            self._change(t if felt is None else nan, felt_x, before)
        self._learn(dt, (force, x, v, *bent), usable and not felt_x < self.known.outermost)
        return contact.state

    def run(self, t: Array, force: Array, x: Array, v: Array) -> Iterator[tuple[int, int]]:
        """
        Process consecutive samples as `take` does one by one, many at once where it can.

        t, force, x, v (N,): as of `take`
        """
        blocks, contact, ahead = self.blocks, self.contact, Backlog(t, force, x, v)
        table, done = np.zeros((len(t), 6)), 0
        table[:, :3].T[:] = force, x, v
        while done < len(t):
            end = ahead.steady_until(done, blocks)
            if self._work is not None or end - done < _FEW:
                yield done + 1, self.take(*ahead.sample(done))
                done += 1
                continue
            end = min(end, done + self._uneventful(*ahead.part(done, end)[1:]))
            before, outermost = contact.state, self.known.outermost
            last = done - 1 + contact.take(*ahead.part(done, end), *self.wall.known[4:6])
            if last > done:
                if before == CONTACT:
                    table[done:last, 5] = ~(x[done:last] < outermost)  # NaN while not known
                blocks.extend(ahead.t[last - 1], table[done:last])
                yield last, before
            done = last + 1
            at, *sample = ahead.sample(last)
            dt = blocks.step(at, sample[1])
            if contact.state != before:
                self._change(at, sample[1], before)
            self._learn(dt, (*sample, 0.0, 0.0), not sample[1] < self.known.outermost)
            yield done, contact.state

    def _uneventful(self, forces: list[float], places: list[float]) -> int:
        """Return the number of samples until a block may end, with the one that may end it."""
        blocks, short = self.blocks, self.blocks.short
        count = max(blocks.wanted - blocks.pending, 1)
        if self.contact.state == CONTACT and blocks.wanted == blocks.settled:
            begun = blocks.pending % short
            force, x = (before + later[:count] for before, later in zip(
                blocks.newest(begun), (forces, places)))
            for end in range(short, len(x) + 1, short):
                if self.wall.residuals.alarms(self.known, force[end - short:end],
                                              x[end - short:end]):
                    return end - begun
        return count

    def _change(self, t: float, x: float, before: int) -> None:
        """Begin or end a contact; at NaN if a short one is not to be used."""
        if before == CONTACT:
            self._leave(t)
        elif self.contact.state == CONTACT:
            self._touch(t, x)
        if self.contact.state == FREE and self.wall.zero_has_changed:
            self._begin_work(self.wall.put_back(x))

    def _learn(self, dt: float, sample: tuple[float, ...], usable: bool) -> None:
        """Add a sample to the block; begin the work on a block that it completes."""
        blocks, taught = self.blocks, usable and self.contact.state == CONTACT
        windows = blocks.add(dt, sample, taught)
        if windows:
            self._begin_work(self.wall.parts_of(windows))
        elif taught and blocks.pending and blocks.wanted == blocks.settled and not (
                blocks.pending % blocks.short) and self.wall.residuals.alarms(
                    self.known, *blocks.newest(blocks.short)):
            self._split()

    def _split(self) -> None:
        """Make a block of its own of the last samples, from which the wall may be another."""
        blocks = self.blocks
        last, windows = blocks.short // blocks.smoothing.hop, blocks.close()
        work = self.wall.parts_of(min(last, windows), alarmed=True) if windows else iter(())
        if windows > last:
            work = chain(self.wall.parts_of(windows - last, blocks.short), work)
        self._begin_work(work)

    def _begin_work(self, work: Iterator[None] | None) -> None:
        """Finish the work before, since what it has judged may change."""
        if self._work is not None:
            self._continue_work(to_end=True)
        self._work = work

    def _leave(self, t: float) -> None:
        """Use what is left of a contact that is over; a short one has no rows but of its touch."""
        blocks = self.blocks
        self._left_t = blocks.last_t
        windows = blocks.close()
        work = self.wall.parts_of(windows) if windows else iter(())
        lasted = t - self._touch_t
        if lasted <= _TAP_S + 0.5 * blocks.period_s:
            count = 3 * blocks.smoothing.half + round(lasted / blocks.period_s)
            work = chain(work, self.wall.learn_tap(blocks.last(count)))
        self._begin_work(chain(work, self.wall.leave()))
        blocks.wanted = blocks.settled

    def _continue_work(self, to_end: bool = False) -> None:
        """Do the next part of the work on the last block, so that no sample takes long."""
        assert self._work is not None
        parts = -(-_PARTS // max(self.blocks.wanted - 1, 1))  # done before the next block
        for _ in repeat(None) if to_end else range(parts):
            if next(self._work, _DONE) is _DONE:
                self._work = None
                return

    def _begin(self, t: float, force: float, x: float) -> None:
        """Collect the samples that tell period and noise."""
        self._first.append((t, force, x))
        if len(self._first) < FIRST:
            return
        stamps, forces, places = np.array(self._first).T
        self._first.clear()
        location, std = self._told
        self.blocks.begin(stamps)
        self.contact.start(forces, not places[-1] > location - 2.0 * std)

    def _touch(self, t: float, x: float) -> None:
        """Begin a contact: the wall may be another."""
        blocks = self.blocks
        self._begin_work(None)
        blocks.close()  # nothing is learned from free flight
        self._touch_t = t
        course = [*blocks.last(blocks.short)[1].tolist(), x]
        rate = (x - course[0]) / (len(course) * blocks.period_s)
        self.wall.touch(x, self.contact.onset, blocks.last_t - self._left_t, rate)
        blocks.wanted = 3 * blocks.short // 2  # the first whole window is longer
