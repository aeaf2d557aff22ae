# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Channels of an arm: what each joint's torque has beyond RNEA, and the columns of all laws."""

from dataclasses import dataclass, replace
from typing import Callable, Iterable, NamedTuple, Sequence, TYPE_CHECKING

import numpy as np
from scipy.interpolate import make_interp_spline
from scipy.signal import butter, sosfiltfilt

from .arm_recording import ArmRecording, Array, Flags, GAP, STILL
from ...exceptions import RecordingError
from ...kinematics.arm_dynamics import ArmDynamics, Outside
from ...physics.joint_effects import JOINT_EFFECTS, JointMotion, Place

if TYPE_CHECKING:
    from .gram import Fitted

_RATE = 200.0  # above which a recording is decimated [Hz]: an order above what arms move at
_DECIMATED = 0.4  # cut-off before decimation, in the new rate
_LONGEST_S = 60.0  # piece that is filtered at once, a bound of the memory
_EDGE_S = 0.5  # dropped at both ends of a piece: transients of the filters
_LEAST_S = 2.0  # piece
_SLOWEST, _FASTEST = 3.0, 25.0  # cut-off [Hz]
_POWER, _HARMONICS = 0.98, 6.0  # the motion's band has this share of its power; cut-off over it
_BENDS = 3.0  # cut-off of torques over that of the loads that bend a joint: below resonances
_POSITION = 4.0  # cut-off of positions, in that of torques
_PER_PERIOD = 4.0  # samples kept in a period of the cut-off
_ERRORS = 3.0  # two in a period, of any misfit of its band, and one at the steps of friction
_MEDIAN = 0.455  # of the square of white noise, in its mean
_REST = 0.04  # of a joint's speed, below which it sticks


class Term(NamedTuple):
    """A law at a place: key of JOINT_EFFECTS, place, shape, and the file it is confined to."""

    effect: str
    place: Place = None
    shape: float = 0.0
    file: int = -1


Columns = dict[Term, dict[int, Array]]


@dataclass(frozen=True, eq=False)
class Piece:
    """A stretch of a recording, filtered and decimated to M samples."""

    file: int  # number of its recording
    t: Array  # (M,) from the recording's first sample [s]
    # q, v, tau, residual (M, n): positions, velocities, torques, and torques less those of the
    # description
    q: Array
    v: Array
    tau: Array
    residual: Array
    noise: Array  # (n,) mean square of white noise that passes the filter, by the power beyond it
    moving: Flags  # (M, n) where a joint moves, so that its friction is what its velocity tells
    columns: Columns  # torque per coefficient of each term, by joint, (M, K)
    # felt, felt_noise: torque of what acts on the arm, and mean square of its noise, part of
    # `noise`
    felt: Array
    felt_noise: Array
    outside: Outside | None = None  # what acts on the arm


class _Stretch(NamedTuple):
    """Evenly sampled signals before the filter."""

    file: int
    t: Array
    q: Array
    tau: Array
    wrench: Array
    frame: str


def low_pass(x: Array, rate: float, cut_off: float) -> Array:
    """Filter without a shift in time: Butterworth, fourth order, forward and backward."""
    sections = butter(4, min(2.0 * cut_off / rate, 0.95), output='sos')
    return np.asarray(sosfiltfilt(sections, x, axis=0))


def _stretches(
    recording: ArmRecording, arm: ArmDynamics, file: int, frame: str
) -> Iterable[_Stretch]:
    """Cut a recording at its gaps; interpolate to a grid."""
    t, wrench = recording.t, np.zeros((len(recording.t), 6 if frame else 0))
    if recording.wrench is not None:
        frame, wrench = recording.wrench.outside(arm, recording.q)
    period = float(np.median(np.diff(t)))
    for rows in recording.stretches:
        if t[rows[-1]] - t[rows[0]] < _LEAST_S:
            continue
        grid = np.arange(t[rows[0]], t[rows[-1]], period)
        q, tau, w = (np.array([np.interp(grid, t[rows], column) for column in signal[rows].T]
                              ).reshape(-1, len(grid)).T
                     for signal in (recording.q, np.nan_to_num(recording.tau), wrench))
        step = int(1.0 / period // _RATE) if 1.0 / period > 1.5 * _RATE else 1
        if step > 1:
            q, tau, w = (low_pass(one, 1.0 / period, _DECIMATED / (step * period))[::step]
                         for one in (q, tau, w))
            grid = grid[::step]
        count = -(-(grid[-1] - grid[0]) // _LONGEST_S)
        for part in np.array_split(np.arange(len(grid)), max(1, int(count))):
            yield _Stretch(file, grid[part], q[part], tau[part], w[part], frame)


def _cut_off(stretch: _Stretch) -> float:
    """Return a cut-off that passes the harmonics of the motion [Hz]."""
    rate = 1.0 / float(stretch.t[1] - stretch.t[0])
    v = np.gradient(low_pass(stretch.q, rate, 0.2 * rate), 1.0 / rate, axis=0)
    power = np.abs(np.fft.rfft(v * np.hanning(len(v))[:, None], axis=0)) ** 2
    power = power[:, np.ptp(stretch.q, axis=0) > STILL]  # all that others tell is noise
    power = (power / power.sum(axis=0)).sum(axis=1)
    place = int(np.searchsorted(np.cumsum(power), _POWER * power.sum()))
    band = float(np.fft.rfftfreq(len(v), 1.0 / rate)[place])
    return float(np.clip(_HARMONICS * band, _SLOWEST, min(_FASTEST, 0.2 * rate)))


class Channels:
    """
    All pieces of some recordings of one arm.

    measured: joints whose torque is known
    pieces: in time
    cut_off: of the filter of torques and columns [Hz]
    terms: all laws at all places
    """

    def __init__(
        self, recordings: Sequence[ArmRecording], arm: ArmDynamics, like: 'Channels | None' = None
    ) -> None:
        self.arm, self.names = arm, [one.name for one in recordings]
        known = np.all([one.has_effort & one.moves for one in recordings], axis=0)
        self.measured: list[int] = like.measured if like else np.flatnonzero(known).tolist()
        first = len(like.names) if like else 0  # laws of one file hold in no other
        frame = next((one.wrench.frame for one in recordings if one.wrench), '')
        raw = [part for k, one in enumerate(recordings, first)
               for part in _stretches(one, arm, k, frame)]
        if not raw:
            raise RecordingError(
                f'{", ".join(self.names)} must have {_LEAST_S:g} s without a gap of {GAP:g} '
                'sample periods; record again')
        self.cut_off: float = like.cut_off if like else max(map(_cut_off, raw))
        motions = [self._motion(one) for one in raw]
        self.speed: Array = like.speed if like else np.percentile(
            np.abs(np.concatenate([one.v for one in motions])), 95, axis=0) + 1e-9
        self.middle: Array = like.middle if like else np.concatenate(
            [one.q for one in motions]).mean(axis=0)
        motions = [replace(one, speed=self.speed, middle=self.middle) for one in motions]
        self.motion = motions[0]
        self.terms: list[Term] = like.terms if like else self._terms(len(recordings))
        self.pieces = [self._piece(stretch, motion) for stretch, motion in zip(raw, motions)]

    samples_per_error = _PER_PERIOD * _HARMONICS / _ERRORS  # three in a period of the motion

    def _motion(self, stretch: _Stretch) -> JointMotion:
        period = float(stretch.t[1] - stretch.t[0])
        q = low_pass(stretch.q, 1.0 / period, _POSITION * self.cut_off)
        # Central differences take (2 pi f period)^2 / 3 of q'' away, as a flexible joint adds.
        course = make_interp_spline(stretch.t, q, k=5)
        v, a = (course.derivative(k)(stretch.t) for k in (1, 2))
        outside = Outside(stretch.frame, stretch.wrench) if stretch.frame else None
        load = self.arm.torque(q, v, a) - self.arm.torque_from(q, outside)
        return JointMotion(self.arm, q, v, a, load, v[0], q[0],
                           low_pass(load, 1.0 / period, self.cut_off / _BENDS), period, outside)

    def _terms(self, files: int) -> list[Term]:
        """List all laws at all places; a payload may be that of one file alone."""
        count, terms = len(self.arm.joints), list[Term]()
        places: dict[str, list[Place]] = {
            'joint': list(self.measured), 'link': list(range(count - 1)), 'arm': [None],
            'pair': [(j, k, way) for j, k in zip(self.measured[:-1], self.measured[1:])
                     if k == j + 1 for way in (1, -1)]}
        for name, effect in JOINT_EFFECTS.items():
            if name == 'force_bias':
                terms += [Term(name, j, file=f) for j in self.measured for f in range(files)]
            elif name == 'payload':
                terms += [Term(name, count - 1, file=f)
                          for f in (range(-1, files) if files > 1 else (-1,))]
            elif not effect.needs_wrench or self.motion.outside is not None:
                terms += [Term(name, place, shape) for place in places[effect.place]
                          for shape in effect.shapes(self.motion, place)]
        return terms

    def _piece(self, stretch: _Stretch, motion: JointMotion) -> Piece:
        rate = 1.0 / motion.period
        edge, count = int(_EDGE_S * rate), len(stretch.t)
        rows = np.arange(edge, count - edge, max(1, int(rate / (_PER_PERIOD * self.cut_off))))

        def filtered(x: Array) -> Array:
            return low_pass(x, rate, self.cut_off)[rows]

        def beyond(x: Array) -> Array:
            """Return the square of what does not pass, in the share of white noise that does."""
            share = self.cut_off / (_DECIMATED * rate - self.cut_off)
            return np.asarray(share * (x - low_pass(x, rate, self.cut_off)) ** 2)

        tau, v, felt = filtered(stretch.tau), filtered(motion.v), motion.felt
        # Impacts are no noise.
        felt_noise = np.median(beyond(felt), axis=0) / _MEDIAN
        return Piece(
            stretch.file, stretch.t[rows], motion.q[rows], v, tau, tau - filtered(motion.load),
            beyond(stretch.tau).mean(axis=0) + felt_noise,
            np.abs(v) > _REST * self.speed, self._columns(motion, stretch.file, filtered),
            filtered(felt), felt_noise,
            motion.outside and motion.outside._replace(wrench=motion.outside.wrench[rows]))

    def _columns(
        self, motion: JointMotion, file: int, filtered: Callable[[Array], Array]
    ) -> Columns:
        """Evaluate all terms; filter those of a joint at once."""
        known, plain = Columns(), dict[Term, dict[int, Array]]()
        for term in self.terms:
            here = term._replace(file=-1)
            if here not in known:
                known[here] = {j: column for j, column in JOINT_EFFECTS[term.effect].columns(
                    motion, term.place, term.shape).items() if j in self.measured}
            plain[term] = known[here]
        every = [(here, j) for here, columns in known.items() for j in columns]
        for j in self.measured:
            mine = [here for here, k in every if k == j]
            stacked = filtered(np.concatenate([known[here][j] for here in mine], axis=1))
            ends = np.cumsum([known[here][j].shape[1] for here in mine])[:-1]
            for here, column in zip(mine, np.split(stacked, ends, axis=1)):
                known[here][j] = column
        return {term: columns if term.file in (-1, file) else
                {j: 0.0 * column for j, column in columns.items()}
                for term, columns in plain.items()}

    def predicted(self, piece: Piece, j: int, fitted: 'Fitted') -> Array:
        """Return what a fitted model adds to RNEA along a piece, shape (M,) [N m]."""
        torque = self.regressor(piece, j) @ fitted.calibration
        for term, theta in (*fitted.zeros.items(), *fitted.theta.items()):
            if j in piece.columns[term]:
                torque = torque + piece.columns[term][j] @ theta
        return np.asarray(torque)

    def regressor(self, piece: Piece, j: int) -> Array:
        """Return Y of joint j in the parameters of all links, shape (M, 10 n)."""
        last = len(self.arm.joints) - 1
        terms = [Term('payload' if i == last else 'link_inertia', i) for i in range(last + 1)]
        return np.concatenate([piece.columns[term][j] for term in terms], axis=1)
