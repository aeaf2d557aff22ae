# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Checks of recordings of an arm for wrong use, made before any physics is named."""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass
from itertools import combinations
from typing import Any, Sequence

import numpy as np
from scipy.optimize import linear_sum_assignment, nnls

from .arm_recording import ArmRecording, Array
from .channels import Channels
from ...kinematics.arm_dynamics import ArmDynamics

_WELL = 0.5  # share of a torque's variance that a plain model leaves of a joint that is read right
_IN_ORDER = 0.1  # the same of joints whose order is beyond doubt
_EXCHANGED = 4.0  # nats that an exchange gains in all: one of dozens that are tried
_FOLD = 1.0  # nats of log error that another reading must gain in each joint
_GAIN = 2.5  # published gains of one arm differ by half; a unit by at least so much
_LOADED = 0.1  # of the largest modelled torque: a joint whose links tell its gain
_LAG_S, _LAGS_S = 0.02, np.linspace(-0.2, 0.2, 41)  # told; tried
_DEGREES = np.pi / 180.0
_BEYOND = 1.2  # times a limit


@dataclass(frozen=True)
class ArmCheck:
    """The result of a check."""

    name: str  # such as 'torque_sign'
    ok: bool  # false if something is to be corrected
    text: str  # measured, expected and what to change
    fatal: bool = True  # whether nothing can be diagnosed before that


def check_description(arm: ArmDynamics) -> ArmCheck:
    """Refuse a description whose masses are placeholders."""
    reason = arm.placeholder
    return ArmCheck('description_masses', not reason, (
        f'the masses of the robot description are placeholders: {reason}; give a description with '
        'the inertial parameters of the maker') if reason else 'the links have masses')


def check_units(recording: ArmRecording, arm: ArmDynamics) -> ArmCheck:
    """Refuse positions in degrees; say if one is beyond its limits."""
    low, high = arm.limits['position']
    limit = np.maximum(np.abs(low), np.abs(high))
    most, bounded = np.abs(recording.q).max(axis=0), np.isfinite(limit)
    over = np.where(bounded, most / limit, most / (10.0 * np.pi))
    k = int(np.argmax(over))
    reaches = (f'{recording.name}: {arm.joints[k]} reaches {most[k]:.4g}'
               + (f', its limit is {limit[k]:.3g}' if bounded[k] else ''))
    if np.mean(over > _BEYOND) >= 0.5 and (most * _DEGREES <= 1.1 * limit).all():
        return ArmCheck('angle_unit', False,
                        f'{reaches} rad: positions are in degrees; publish radians')
    if over[k] > _BEYOND and bounded[k]:
        return ArmCheck('position_limits', False, (
            f'{reaches}: joints are named in another order, or this is another robot; compare '
            'the names of joint states and description'), False)
    return ArmCheck('angle_unit', True, 'positions lie within what radians allow')


def check_efforts(recordings: Sequence[ArmRecording], arm: ArmDynamics) -> list[ArmCheck]:
    """Say which joints publish no effort, rest, or publish no velocity; refuse if all do."""
    effort, velocity, moves = (np.all([getattr(one, name) for one in recordings], axis=0)
                               for name in ('has_effort', 'has_velocity', 'moves'))
    still = [name for name, known in zip(arm.joints, moves) if not known]
    silent = [name for name, known in zip(arm.joints, effort) if not known]
    slow = [name for name, known in zip(arm.joints, velocity) if not known]
    return [
        ArmCheck('effort', not silent, (
            f'{", ".join(silent)} publish no effort, or the same most of the time: their motion '
            'is used, their torque is not') if silent else 'all joints publish an effort',
            not effort.any()),
        ArmCheck('motion', not still, (
            f'{", ".join(still)} rest: their torque is not used; move every joint for some ten '
            'seconds, as --write-trajectory does') if still else 'all joints move',
            not (effort & moves).any()),
        ArmCheck('velocity', True, (
            f'{", ".join(slow)} publish no velocity: ' if slow else '')
            + 'velocities are derived from positions'),
    ]


def check_wrench(recording: ArmRecording, arm: ArmDynamics) -> ArmCheck:
    """Say if the wrench cannot be used: nothing then tells a contact from friction."""
    frame = recording.wrench.frame if recording.wrench else ''
    known = not frame or frame in arm.frames
    return ArmCheck('wrench_frame', known, 'the sensor of the wrench is a link' if known else (
        f'{recording.name}: the wrench is measured in {frame}, which is no link of the robot '
        'description, and is not used: what touches the arm then looks like physics of its '
        'joints; set force_sensor.frame in --params to the link of the sensor'), False)


class Reading:
    """Errors of the plainest model of each joint: RNEA, friction, rotor inertia, zero."""

    def __init__(self, channels: Channels, most: int | None = None) -> None:
        self.channels, self.arm = channels, channels.arm
        pieces = channels.pieces[:most]
        self.q, self.v, self.tau = (np.concatenate([getattr(one, name) for one in pieces])
                                    for name in ('q', 'v', 'tau'))
        self.load = self.tau - np.concatenate([one.residual for one in pieces])
        self.a = np.concatenate([np.gradient(one.v, one.t, axis=0) for one in pieces])
        self.t = np.concatenate([one.t for one in pieces])
        first = pieces[0].outside
        self.outside = first and first._replace(wrench=np.concatenate(
            [one.outside.wrench for one in pieces if one.outside is not None]))

    def error(self, tau: Array, k: int, load: Array | None = None) -> float:
        """Return the share of a torque that joint k's motion leaves, friction never driving."""
        v, a = self.v[:, k], self.a[:, k]
        X = np.stack([np.tanh(v / (0.05 * self.channels.speed[k])), v, a,
                      np.ones(len(v)), -np.ones(len(v))], axis=1)
        y = tau - (self.load[:, k] if load is None else load)
        scale = np.sqrt(np.mean(X**2, axis=0)) + 1e-12
        return float(nnls(X / scale, y)[1] ** 2 / (len(y) * (tau.var() + 1e-12)) + 1e-4)

    def errors(self) -> Array:
        """Return the error of each joint with a torque."""
        return np.array([self.error(self.tau[:, j], j) for j in self.channels.measured])


def check_signs(reading: Reading) -> ArmCheck:
    """Refuse torques that count in the other direction."""
    names, joints = reading.arm.joints, reading.channels.measured
    right = reading.errors()
    wrong = np.array([reading.error(-reading.tau[:, j], j) for j in joints])
    flipped = [names[j] for j, one, other in zip(joints, right, wrong)
               if np.log(one / other) > 2.0 * _FOLD and other < _WELL]
    return ArmCheck('torque_sign', not flipped, (
        f'the torques of {", ".join(flipped)} have the opposite sign: they brake where the arm '
        'must push; publish the torque that the drive applies to the joint') if flipped
        else 'torques drive the motion')


def check_order(reading: Reading) -> ArmCheck:
    """Refuse efforts, or positions, of joints that are exchanged."""
    joints, names = reading.channels.measured, reading.arm.joints
    ok = ArmCheck('joint_order', True, 'each torque belongs to the motion of its joint')
    right = reading.errors()
    if (right < _IN_ORDER).all():
        return ok
    table = np.log([[reading.error(reading.tau[:, i], k) for k in joints] for i in joints])
    chosen = linear_sum_assignment(table)[1]
    moved = [k for k, other in enumerate(chosen) if other != k]
    if moved and all(table[k, k] - table[k, chosen[k]] > 0.5 * _FOLD for k in moved) and np.mean(
            [table[k, k] - table[k, chosen[k]] for k in moved]) > _FOLD:
        pairs = ', '.join(f'{names[joints[k]]} holds that of {names[joints[chosen[k]]]}'
                          for k in moved)
        return ArmCheck('joint_order', False, (
            f'efforts are in another order than names: {pairs}; publish them in the order of '
            '`name`'))
    rows = np.linspace(0, len(reading.q) - 1, min(len(reading.q), 300)).astype(int)
    best = float(np.log(right).sum()) - _EXCHANGED
    found: tuple[int, int, bool] | None = None
    for i, k in combinations(joints, 2):
        order = np.arange(len(names))
        order[[i, k]] = k, i
        for both in (True, False):
            score = _score(reading, rows, order, both)
            if score < best:
                best, found = score, (i, k, both)
    if found is None:
        return ok
    what = 'the states' if found[2] else 'the positions'
    return ArmCheck('joint_order', False, (
        f'{what} of {names[found[0]]} and {names[found[1]]} are exchanged: with them in the other '
        'order the torques fit; correct the order of `name`'))


def _score(reading: Reading, rows: Any, order: Any, both: bool) -> float:
    """Return the log errors of all joints with motions, or with torques too, in another order."""
    q, v, a, tau = (one[rows] for one in (reading.q, reading.v, reading.a, reading.tau))
    q, v, a, tau = q[:, order], v[:, order], a[:, order], tau[:, order] if both else tau
    outside = reading.outside and reading.outside._replace(wrench=reading.outside.wrench[rows])
    load, total = reading.arm.torque(q, v, a) - reading.arm.torque_from(q, outside), 0.0
    some = copy(reading)
    some.v, some.a = v, a
    for j in reading.channels.measured:
        total += float(np.log(some.error(tau[:, j], j, load[:, j])))
    return total


def check_gains(reading: Reading) -> ArmCheck:
    """Refuse torques of another unit, or of the motor in place of the joint."""
    texts = []
    sizes = np.sqrt(np.mean(reading.load**2, axis=0))
    for j in reading.channels.measured:
        v, a, load = reading.v[:, j], reading.a[:, j], reading.load[:, j]
        X = np.stack([load, np.tanh(v / (0.05 * reading.channels.speed[j])), v, a,
                      np.ones(len(v))], axis=1)
        tau = reading.tau[:, j]
        theta, *_ = np.linalg.lstsq(X, tau, rcond=None)
        without, *_ = np.linalg.lstsq(X[:, 1:], tau, rcond=None)
        left, rest = np.var(tau - X @ theta), np.var(tau - X[:, 1:] @ without)
        shown = left < 0.5 * rest and left < 0.3 * tau.var()
        if not shown or theta[0] <= 0.0 or sizes[j] < _LOADED * sizes.max():
            continue
        if not 1.0 / _GAIN < theta[0] < _GAIN:
            texts.append(f'{reading.arm.joints[j]} {theta[0]:.3g}')
    return ArmCheck('torque_unit', not texts, (
        f'torques are not those of the joints in N m; measured over modelled: {", ".join(texts)}; '
        'multiply currents by motor constant and gear ratio, N mm by 0.001') if texts
        else 'torques have the size of those of the joints in N m')


def check_clock(reading: Reading) -> ArmCheck:
    """Say by how much torques are stamped later than positions; `reading` of one piece."""
    t, joints = reading.t, reading.channels.measured
    scores = []
    for lag in _LAGS_S:
        some = copy(reading)
        for name in ('load', 'v', 'a'):
            signal = getattr(reading, name)
            setattr(some, name, np.stack(
                [np.interp(t - lag, t, column) for column in signal.T], axis=1))
        scores.append(sum(np.log(some.error(reading.tau[:, j], j)) for j in joints))
    best = int(np.argmin(scores))
    lag = float(_LAGS_S[best])
    at_zero = scores[len(_LAGS_S) // 2]
    late = abs(lag) > _LAG_S and scores[best] < at_zero - _FOLD
    word = 'later' if lag > 0.0 else 'earlier'
    return ArmCheck('clock_offset', not late, (
        f'torques are stamped about {1e3 * abs(lag):.0f} ms {word} than positions; stamp both '
        'when they are measured') if late else 'torques and positions have one clock', False)


def examine(channels: Channels) -> list[ArmCheck]:
    """Make all checks that need the dynamics, up to the first that fails."""
    reading, found = Reading(channels), list[ArmCheck]()
    for check in (check_signs, check_order, check_gains):
        found.append(check(reading))
        if not found[-1].ok:
            return found  # what follows has no meaning before that is put right
    return [*found, check_clock(Reading(channels, 1))]
