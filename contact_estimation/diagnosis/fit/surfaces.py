# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
Contacts that begin at different places: the object was moved, or touched somewhere else.

Nothing that is missing in one contact explains that. Each contact tells twice where its surface
is: by the position at which its force begins, and by the spring that its force fits.
"""

from typing import NamedTuple, Sequence

import numpy as np

from ..observe.prepared_recording import PreparedRecording, Recordings
from ..observe.shares import LITTLE, MOST, MUCH
from ..observe.signals import Signals
from ...physics.numeric import Array
from ...reference.reference_generator import quintic

_LEAST_CONTACT_S, _LEAST_SAMPLES = 0.1, 20
_FELT, _NOISE = 0.01, 5.0  # of the range of the force; standard deviations
_RESOLVED = 3.0  # times the path within which a contact begins


class Contact(NamedTuple):
    """A contact: the number of its recording, and its first and last instant [s]."""

    recording: int
    begin: float
    end: float


class Surfaces(NamedTuple):
    """The surface of each contact."""

    contacts: tuple[Contact, ...]  # those that begin in the recordings
    # (C,) where the spring of each contact is unloaded, at the same K_e and B_e in all [m]
    fitted: Array
    touched: Array  # (C,) where the force of each begins [m]
    blur: float  # path within which it begins [m]
    # stiffness, damping: K_e [N/m] and B_e [N s/m] of all contacts
    stiffness: float
    damping: float
    explained: float  # share of the squared misfit of one surface for all contacts
    springs: Array  # (C,) K_e of each contact alone [N/m]
    # share of what is left then that they explain, each with a damping and a mass of its own
    explained_by_springs: float

    @property
    def are_of_several(self) -> bool:
        """Whether the stiffness differs between contacts, which explains what is missing."""
        if len(self.springs) < 2 or float(np.min(self.springs)) <= 0.0:
            return False
        return bool(np.ptp(self.springs) > LITTLE * np.median(self.springs)
                    and self.explained_by_springs > 1.0 - MUCH)

    @property
    def are_apart(self) -> bool:
        """Whether the contacts begin at different places, which explain most of the misfit."""
        if len(self.fitted) < 2 or self.stiffness <= 0.0:
            return False
        apart, differ = float(np.ptp(self.touched)), self.fitted - self.touched
        return (apart > _RESOLVED * self.blur and float(np.ptp(differ)) < MUCH * apart
                and self.explained > MOST)


def surfaces_of(recordings: Recordings) -> Surfaces:
    """Measure where the surface of each contact is."""
    # -F_e = K_e (x - x_k) + B_e v + M_e a in contact k, by least squares.
    found = [(number, *contact) for number, one in enumerate(recordings)
             for contact in _contacts(one)]
    if len(found) < 2:
        nothing = np.empty(0)
        return Surfaces((), nothing, nothing, 0.0, 0.0, 0.0, 0.0, nothing, 0.0)
    contacts, touched, blurs, columns, forces, numbers = [], [], [], [], [], []
    for k, (number, first, stop) in enumerate(found):
        o = recordings[number].observed
        contacts.append(Contact(number, float(o.t[first]), float(o.t[stop - 1])))
        before, after = o.x[first - 1], o.x[first]
        touched.append(0.5 * (before + after))
        blurs.append(abs(after - before) + o.position_noise)
        columns.append(np.column_stack((o.x, o.v, o.a))[first:stop])
        forces.append(-o.force[first:stop])
        numbers.append(np.full(stop - first, k))
    motion, force = np.vstack(columns), np.concatenate(forces)
    own = np.equal.outer(np.concatenate(numbers), np.arange(len(found)))
    _, alike = _fitted(motion, np.ones((len(force), 1)), force)
    values, apart = _fitted(motion, own.astype(float), force)
    each = [_fitted(motion[there], np.ones((int(there.sum()), 1)), force[there])
            for there in own.T]
    stiffness = float(values[0])
    places = -values[3:] / stiffness if stiffness else np.zeros(len(found))
    return Surfaces(tuple(contacts), places, np.array(touched), float(np.median(blurs)), stiffness,
                    float(values[1]), 1.0 - apart / max(alike, 1e-300),
                    np.array([alone[0] for alone, _ in each]),
                    1.0 - sum(left for _, left in each) / max(apart, 1e-300))


def on_one_surface(
    signals: Signals, contacts: Sequence[Contact], places: Sequence[float], location: float
) -> Signals:
    """Move the position and its reference together, so that all contacts begin at one place."""
    # What an impedance-controlled robot does depends on their difference alone. Between contacts
    # both are moved from rest to rest, while the tool is before both surfaces.
    if not contacts:
        return signals
    times = [_away(signals, last.end, following.begin, min(here, there))
             for last, following, here, there in zip(
                 contacts, contacts[1:], places, places[1:])]
    moves = _Moves(times, [location - place for place in places])
    reference = signals.reference.copy()
    if reference.size:
        reference[:3] += moves.at(signals.reference_t)
    return signals._replace(
        position=signals.position + moves.at(signals.joint_t)[0], reference=reference)


def _away(signals: Signals, begin: float, end: float, place: float) -> tuple[float, float]:
    """Return from when to when the tool is before a place [m] between two contacts."""
    between = np.flatnonzero((signals.joint_t > begin) & (signals.joint_t < end))
    if not len(between):
        return begin, end
    x, t = signals.position[between], signals.joint_t[between]
    farthest = int(np.argmin(x))
    nearer = (x >= place) & (x > x[farthest])
    first = np.flatnonzero(nearer[:farthest])
    last = np.flatnonzero(nearer[farthest:])
    return (float(t[first[-1]]) if len(first) else begin,
            float(t[farthest + last[0]]) if len(last) else end)


class _Moves(NamedTuple):
    """Moves from each shift [m] to the next, from and to instants [s]."""

    times: Sequence[tuple[float, float]]
    shifts: Sequence[float]

    def at(self, t: Array) -> Array:
        """Return the shift of each sample and its two derivatives, shape (3, N)."""
        moves = np.zeros((3, len(t)))
        moves[0] = self.shifts[0]
        for (begin, end), before, after in zip(self.times, self.shifts, self.shifts[1:]):
            moves[0] += (after - before) * (t >= end)
            there = np.flatnonzero((t > begin) & (t < end))
            for k in there:
                moves[:, k] += quintic(0.0, after - before, end - begin, float(t[k] - begin))
        return moves


def _fitted(motion: Array, shifts: Array, force: Array) -> tuple[Array, float]:
    """Return the values of a least-squares fit and what it leaves."""
    columns = np.hstack((motion, shifts))
    size = np.maximum(np.sqrt(np.mean(columns**2, axis=0)), 1e-300)
    values = np.linalg.lstsq(columns / size, force, rcond=None)[0] / size
    return values, float(np.sum((force - columns @ values) ** 2))


def _contacts(recording: PreparedRecording) -> list[tuple[int, int]]:
    """Return the first sample of each contact that begins, by the force, and that after it."""
    o = recording.observed
    felt = -o.force > max(_FELT * o.force_range, _NOISE * recording.force_noise)
    edges = np.flatnonzero(np.diff(felt, prepend=False, append=False)).tolist()
    least = max(_LEAST_SAMPLES, _LEAST_CONTACT_S * o.pace / o.h)
    joined: list[tuple[int, int]] = []
    for first, stop in zip(edges[::2], edges[1::2]):
        if joined and first - joined[-1][1] < least:  # a rebound is no other contact
            joined[-1] = joined[-1][0], stop
        else:
            joined.append((first, stop))
    # What a cable or a mount pushes in free flight is no contact.
    firm = LITTLE * o.force_range
    return [(first, stop) for first, stop in joined if first > 0 and stop - first >= least
            and float(np.max(-o.force[first:stop])) > firm]
