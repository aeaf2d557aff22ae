# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Checks of recordings of an arm for wrong use, made before any physics is named."""

from copy import copy
from itertools import chain, combinations
from typing import Any, Iterator, NamedTuple, Sequence

import numpy as np
from scipy.optimize import linear_sum_assignment, lsq_linear, nnls

from .arm_recording import ArmRecording, Array
from .channels import Channels
from ..checks.check import Check
from ...kinematics.arm_dynamics import ArmDynamics, PER_LINK

_WELL = 0.5  # share of a torque's variance that a plain model leaves of a joint that is read right
_IN_ORDER = 0.1  # the same of joints whose order is beyond doubt
_EXCHANGED = 4.0  # nats that an exchange gains in all: one of dozens that are tried
_HALF, _MOSTLY_READ = 0.5, 0.3  # of what is left without a load, and of a torque: its gain shows
_ROWS = 300  # samples that tell a misreading
_FOLD = 1.0  # nats of log error that another reading must gain in each joint
# Most of a load, in the mass of the links (rated are 0.1 to 0.5), and of its centre's distance
_CARRIES, _REACH_M = 0.5, 0.5
_TILTED = np.radians(20.0)  # base, of which gravity is not linear in the angle any more
_GAIN = 2.5  # published gains of one arm differ by half; a unit by at least so much
_LOADED = 0.1  # of the largest modelled torque: a joint whose links tell its gain
_LAG_S, _LAGS_S = 0.02, np.linspace(-0.2, 0.2, 41)  # told; tried
_DEGREES = np.pi / 180.0
_BEYOND = 1.2  # times a limit


def check_description(arm: ArmDynamics) -> Check:
    """Refuse a description whose masses are placeholders."""
    reason = arm.placeholder
    return Check('description_masses', not reason, (
        f'the masses of the robot description are placeholders: {reason}; give a description with '
        'the inertial parameters of the maker') if reason else 'the links have masses',
        fatal=bool(reason))


def check_units(recording: ArmRecording, arm: ArmDynamics) -> Check:
    """Refuse positions in degrees; say if one is beyond its limits."""
    low, high = arm.limits['position']
    limit = np.maximum(np.abs(low), np.abs(high))
    most, bounded = np.abs(recording.q).max(axis=0), np.isfinite(limit)
    over = np.where(bounded, most / limit, most / (10.0 * np.pi))
    k = int(np.argmax(over))
    reaches = (f'{recording.name}: {arm.joints[k]} reaches {most[k]:.4g}'
               + (f', its limit is {limit[k]:.3g}' if bounded[k] else ''))
    if np.mean(over > _BEYOND) >= 0.5 and (most * _DEGREES <= 1.1 * limit).all():
        return Check('angle_unit', False,
                     f'{reaches} rad: positions are in degrees; publish radians', True)
    if over[k] > _BEYOND and bounded[k]:
        return Check('position_limits', False, (
            f'{reaches}: joints are named in another order, or this is another robot; compare '
            'the names of joint states and description'))
    return Check('angle_unit', True, 'positions lie within what radians allow')


def check_efforts(recordings: Sequence[ArmRecording], arm: ArmDynamics) -> list[Check]:
    """Say which joints publish no effort, rest, or publish no velocity; refuse if all do."""
    effort, velocity, moves = (np.all([getattr(one, name) for one in recordings], axis=0)
                               for name in ('has_effort', 'has_velocity', 'moves'))
    still = [name for name, known in zip(arm.joints, moves) if not known]
    silent = [name for name, known in zip(arm.joints, effort) if not known]
    slow = [name for name, known in zip(arm.joints, velocity) if not known]
    return [
        Check('effort', not silent, (
            f'{", ".join(silent)} publish no effort, or the same most of the time: their motion '
            'is used, their torque is not; let the driver publish it [N m] with each position'
        ) if silent else 'all joints publish an effort',
            not effort.any()),
        Check('motion', not still, (
            f'{", ".join(still)} rest: their torque is not used; move every joint for some ten '
            'seconds, as --write-trajectory does') if still else 'all joints move',
            not (effort & moves).any()),
        Check('velocity', True, (
            f'{", ".join(slow)} publish no velocity: ' if slow else '')
            + 'velocities are derived from positions')]


def check_wrench(recording: ArmRecording, arm: ArmDynamics) -> Check:
    """Say if the wrench cannot be used: nothing then tells a contact from friction."""
    frame = recording.wrench.frame if recording.wrench else ''
    known = not frame or frame in arm.frames
    return Check('wrench_frame', known, 'the sensor of the wrench is a link' if known else (
        f'{recording.name}: the wrench is measured in {frame}, which is no link of the robot '
        'description, and is not used: what touches the arm then looks like physics of its '
        'joints; set force_sensor.frame in --params to the link of the sensor'))


class Reading:
    """A recording as the plainest model sees it: load, friction, rotor, zero, and a spring."""

    def __init__(self, channels: Channels, most: int | None = None) -> None:
        self.channels, self.arm, self.joints = channels, channels.arm, channels.measured
        pieces = channels.pieces[:most]
        self.q, self.v, self.tau = (np.concatenate([getattr(one, name) for one in pieces])
                                    for name in ('q', 'v', 'tau'))
        self.load = self.tau - np.concatenate([one.residual for one in pieces])
        self.a = np.concatenate([np.gradient(one.v, one.t, axis=0) for one in pieces])
        self.t = np.concatenate([one.t for one in pieces])
        first = pieces[0].outside
        self.outside = first and first._replace(wrench=np.concatenate(
            [one.outside.wrench for one in pieces if one.outside is not None]))

    def thinned(self) -> 'Reading':
        """Return some of its samples."""
        some, count = copy(self), len(self.q)
        rows = np.linspace(0, count - 1, min(count, _ROWS)).astype(int)
        for name in ('q', 'v', 'a', 'tau', 'load'):
            setattr(some, name, getattr(self, name)[rows])
        some.outside = self.outside and self.outside._replace(wrench=self.outside.wrench[rows])
        return some

    def otherwise(self, motion: Any, torque: Any = 1.0) -> 'Reading':
        """Return the reading with a function of all positions, and of the torques."""
        other = copy(self)
        other.q, other.v, other.a = motion(self.q), motion(self.v), motion(self.a)
        other.tau = motion(self.tau) if torque else self.tau
        other.load = self.arm.torque(other.q, other.v, other.a) - self.arm.torque_from(
            other.q, self.outside)
        return other

    def plain(self, k: int) -> list[Array]:
        """Return friction, rotor, zero and spring of joint k."""
        q, v = self.q[:, k], self.v[:, k]
        return [np.tanh(v / (0.05 * self.channels.speed[k])), v, self.a[:, k],
                np.ones(len(q)), np.sin(q), np.cos(q)]

    def fit(self, tau: Array, k: int, load: Array, free: bool = False) -> tuple[float, float]:
        """Return the log share of a torque that joint k leaves, and the gain of a `free` load."""
        # Friction never drives; a spring may be any.
        plain = self.plain(k)
        X = np.stack([*plain, *(-x for x in plain[-3:]), load * free], axis=1)
        scale = np.sqrt(np.mean(X**2, axis=0)) + 1e-12
        theta, rest = nnls(X / scale, tau - load * (not free))
        return (float(np.log(rest**2 / (len(tau) * (tau.var() + 1e-12)) + 1e-4)),
                float(theta[-1] / scale[-1]))

    def carrying(self) -> Array:
        """Return the loads if the flange carries what fits, up to half of what moves."""
        Y = self.arm.regressor(self.q, self.v, self.a)[..., -PER_LINK:][..., :4]
        A, most = self.beyond_plain(Y, self.load), _CARRIES * float(self.arm.masses.sum())
        carried = lsq_linear(A[:, :-1], A[:, -1], ([0.0, *3 * [-most * _REACH_M]],
                                                   [most, *3 * [most * _REACH_M]])).x
        return np.asarray(self.load + Y @ carried)

    def beyond_plain(self, Y: Array, load: Array) -> Array:
        """Return columns (N, n, K), and torques less a load, of which no plain law is a part."""
        every, rows = np.concatenate([Y, (self.tau - load)[..., None]], axis=2), []
        for j in self.joints:
            X = np.stack(self.plain(j), axis=1)
            left = every[:, j] - X @ np.linalg.lstsq(X, every[:, j], rcond=None)[0]
            rows.append(left / (self.tau[:, j].std() + 1e-12))
        return np.concatenate(rows)

    def compared(self, j: int) -> str:
        """Return range of a joint's torque, and its correlation with that of the description."""
        tau, load = self.tau[:, j], self.load[:, j]
        both = np.stack([tau - tau.mean(), load - load.mean()])
        alike = both[0] @ both[1] / (np.prod(np.linalg.norm(both, axis=1)) + 1e-12)
        return (f'{self.arm.joints[j]} has {np.ptp(tau):.3g} N m from end to end, '
                f'{np.ptp(load):.3g} expected; correlation {alike:.2f}')

    def errors(self, load: Array | None = None, sign: float = 1.0) -> Array:
        """Return the log error of each joint with a torque."""
        load = self.load if load is None else load
        return np.array([self.fit(sign * self.tau[:, j], j, load[:, j])[0] for j in self.joints])


class Misreading(NamedTuple):
    """A way in which a recording may be wrong."""

    check: str
    text: str
    errors: Array  # log errors of all joints if it is so
    price: float = _EXCHANGED  # of one of dozens that are tried [nat]


def _flipped(reading: Reading, right: Array) -> Iterator[Misreading]:
    """Return torques that count in the other direction."""
    flipped = reading.errors(sign=-1.0)
    wrong = (right - flipped > 2.0 * _FOLD) & (flipped < np.log(_WELL))
    names = ', '.join(reading.arm.joints[j] for j, one in zip(reading.joints, wrong) if one)
    if names:
        yield Misreading('torque_sign', (
            f'the torques of {names} have the opposite sign: they brake where the arm must '
            f'push ({reading.compared(reading.joints[int(np.argmax(wrong))])}); publish the '
            'torque that the drive applies to the joint'),
            np.where(wrong, flipped, right), 0.0)


def _disordered(reading: Reading, right: Array) -> Iterator[Misreading]:
    """Return efforts in another order than the names."""
    joints, names = reading.joints, [reading.arm.joints[j] for j in reading.joints]
    table = np.array([[reading.fit(reading.tau[:, i], k, reading.load[:, k])[0] for k in joints]
                      for i in joints])
    chosen = linear_sum_assignment(table)[1]
    moved = [k for k, other in enumerate(chosen) if other != k]
    gains = np.array([table[k, k] - table[k, chosen[k]] for k in moved])
    if moved and gains.min() > 0.5 * _FOLD and gains.mean() > _FOLD:
        pairs = ', '.join(f'{names[k]} holds that of {names[chosen[k]]}' for k in moved)
        yield Misreading('joint_order', (
            f'efforts are in another order than names: {pairs}; publish them in the order of '
            '`name`'), table[range(len(joints)), chosen], 0.0)


def _exchanged(reading: Reading, right: Array) -> Iterator[Misreading]:
    """Return positions, or all states, of two joints that are exchanged."""
    names = reading.arm.joints
    for i, k in combinations(reading.joints, 2):
        order = np.arange(len(names))
        order[[i, k]] = k, i
        for both in (True, False):
            yield Misreading('joint_order', (
                f'{"the states" if both else "the positions"} of {names[i]} and {names[k]} are '
                'exchanged: with them in the other order the torques fit; correct the order of '
                '`name`'), reading.otherwise(lambda x: x[:, order], both).errors())


def _mirrored(reading: Reading, right: Array) -> Iterator[Misreading]:
    """Return positions of a joint that count in the other direction, or its torques as well."""
    for j, name in enumerate(reading.arm.joints):
        sign = np.where(np.arange(len(reading.arm.joints)) == j, -1.0, 1.0)
        for both in (True, False):
            yield Misreading('position_sign', (
                f'the position of {name} counts in the other direction than in the description'
                f'{", and so does its torque" if both else ""}: turn the sign of the encoder'
                f'{" and of the torque" if both else ""}, or the axis of the joint'),
                reading.otherwise(lambda x: x * sign, both).errors())


def _lacking(reading: Reading, right: Array) -> Iterator[Misreading]:
    """Return torques that lack those of gravity, or all of the arm."""
    still = np.zeros_like(reading.q)
    shown = reading.compared(int(np.argmax(np.ptp(reading.load, axis=0))))
    yield Misreading('torque_gravity', (
        f'the torques lack those of gravity ({shown}): the controller compensates it and '
        'publishes what it adds; record the measured torque, or add the gravity torque of the '
        'controller'),
        reading.errors(reading.load - reading.arm.torque(reading.q, still, still)))
    yield Misreading('torque_external', (
        f'the torques show none of the weight and inertia of the arm ({shown}): an estimate of '
        'external torques, what a controller adds, or another unit, such as currents or torques '
        'of the motors; record the torque of each joint in N m'), reading.errors(
            -reading.arm.torque_from(reading.q, reading.outside)))


def _mounted(reading: Reading, right: Array) -> Iterator[Misreading]:
    """Return gravity in another direction: a base on a wall or on the ceiling."""
    still = np.zeros_like(reading.q)
    weight = reading.arm.torque(reading.q, still, still)
    Y = np.concatenate([reading.arm.tilt(reading.q), -weight[..., None]], axis=2)
    A = reading.beyond_plain(Y, reading.load - weight)
    down = np.linalg.lstsq(A[:, :-1], A[:, -1], rcond=None)[0]
    down /= np.linalg.norm(down) + 1e-12
    if down[2] > -np.cos(_TILTED):
        along = ', '.join(f'{x + 0.0:.2f}' for x in down)
        yield Misreading('base_mounting', (
            f'gravity acts along ({along}) of the base, and not along (0, 0, -1): the arm is '
            'mounted on a wall or a ceiling; turn the root of the description by a fixed joint'),
            reading.errors(reading.load - weight + Y @ down))


def _units(reading: Reading, right: Array) -> Iterator[Misreading]:
    """Return torques of another unit, or of the motor in place of the joint."""
    sizes = np.sqrt(np.mean(reading.load**2, axis=0))
    errors, texts = right.copy(), []
    for k, j in enumerate(reading.joints):
        left, gain = reading.fit(reading.tau[:, j], j, reading.load[:, j], free=True)
        none = reading.fit(reading.tau[:, j], j, 0.0 * reading.load[:, j])[0]
        if 1.0 / _GAIN < gain < _GAIN:
            continue
        errors[k] = min(left + _FOLD, right[k])
        shown = left < min(none + np.log(_HALF), np.log(_MOSTLY_READ))
        if shown and sizes[j] >= _LOADED * sizes.max():
            texts.append(f'{reading.arm.joints[j]} {gain:.3g}')
    if texts:
        yield Misreading('torque_unit', (
            'torques are not those of the joints in N m; measured over modelled, about 1 '
            f'expected: {", ".join(texts)}; multiply currents by motor constant and gear ratio, '
            'N mm by 0.001'), errors, 0.0)


_READ = {
    'torque_sign': 'torques drive the motion',
    'position_sign': 'positions count as in the description',
    'joint_order': 'each torque belongs to the motion of its joint',
    'torque_gravity': 'torques hold the arm against gravity',
    'torque_external': 'torques move the arm',
    'base_mounting': 'gravity acts along -z of the base',
    'torque_unit': 'torques have the size of those of the joints in N m',
}
"""What is right, by check."""


def check_reading(reading: Reading) -> list[Check]:
    """Refuse what another reading of signs, order, units or kind of torques explains best."""
    some = reading.thinned()
    right = some.errors()
    # Outermost, a heavy load looks like torques of another unit.
    best, found = min(float(right.sum()), float(some.errors(some.carrying()).sum())), None
    # Friction, rotor and spring of a joint follow a torque of any unit.
    ways = (_flipped, _disordered, _exchanged, _mirrored, _lacking, _mounted, _units)
    for one in chain.from_iterable(tried(some, right) for tried in (
            ways if (right >= np.log(_IN_ORDER)).any() else ways[-1:])):
        if one.errors.sum() + one.price < best:
            best, found = float(one.errors.sum()) + one.price, one
    if found is not None:
        return [Check(found.check, False, found.text, fatal=True)]
    return [Check(name, True, text) for name, text in _READ.items()]


def check_clock(reading: Reading) -> Check:
    """Say by how much torques are stamped later than positions; `reading` of one piece."""
    t, scores = reading.t, list[float]()
    for lag in _LAGS_S:
        some = copy(reading)
        for name in ('load', 'q', 'v', 'a'):
            setattr(some, name, np.stack([np.interp(t - lag, t, column)
                                          for column in getattr(reading, name).T], axis=1))
        scores.append(float(some.errors().sum()))
    best = int(np.argmin(scores))
    lag = float(_LAGS_S[best])
    at_zero = scores[len(_LAGS_S) // 2]
    late = abs(lag) > _LAG_S and scores[best] < at_zero - _FOLD
    word = 'later' if lag > 0.0 else 'earlier'
    return Check('clock_offset', not late, (
        f'torques are stamped about {1e3 * abs(lag):.0f} ms {word} than positions; stamp both '
        'when they are measured') if late else 'torques and positions have one clock')


def examine(channels: Channels) -> list[Check]:
    """Make all checks that need the dynamics; what follows one that fails has no meaning."""
    found = check_reading(Reading(channels))
    return found if not found[-1].ok else [*found, check_clock(Reading(channels, 1))]
