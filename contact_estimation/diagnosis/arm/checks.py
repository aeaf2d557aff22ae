# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Checks of recordings of an arm for wrong use, made before any physics is named."""

from dataclasses import replace
from itertools import combinations, islice
from math import exp, log
from typing import Iterator, NamedTuple, Sequence

import numpy as np

from .arm_recording import ArmRecording
from .channels import Channels
from .gram import INEXACT
from .reading import Reading, ReadingEvidence
from ..checks.check import Check
from ...kinematics.arm_dynamics import ArmDynamics

_DEGREES = np.pi / 180.0
_BEYOND = 1.2  # times a limit
_ODDS = log(100.0)  # against a misreading of each kind beforehand, and for one that is told
_LAG_S, _LAGS = 0.02, 10  # delay of a sensor or bus; longest that is tried, in these
_LAW_GAIN = log(1.5)  # published gains of one arm differ by up to half
_TILTED = np.radians(20.0)  # of a base, from which on gravity is not linear in the angle
_CAPS = 2.0 / (1.0 - np.cos(_TILTED))  # directions that differ by so much
# Loads, in the mass of the links: rated are 0.1 to 0.5, hands a tenth of that.
_LOADS = 0.5, 0.05
_MOST = 4  # misreadings and laws of one recording


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


class Candidate(NamedTuple):
    """A way in which a recording may be read."""

    check: str  # '' for a law, which the comparison of models names
    text: str
    reading: Reading
    evidence: ReadingEvidence
    places: float = 1.0  # as likely ways of its kind
    brief: str = ''  # in a list
    fatal: bool = True


def _exchanged(reading: Reading) -> Iterator[Candidate]:
    """Yield efforts, or all states, of two joints in the order of each other."""
    names, joints = reading.arm.joints, reading.joints
    for i, k in combinations(joints, 2):
        order = np.arange(len(names))
        order[[i, k]] = k, i
        for what, other in (('efforts', reading.but(tau=reading.tau[:, order])),
                            ('states', reading.moved(lambda x: x[:, order], True))):
            yield Candidate('joint_order', (
                f'the {what} of {names[i]} and {names[k]} are exchanged: with them in the other '
                'order the torques fit; publish them in the order of `name`'), other,
                other.evidence(), len(joints) * (len(joints) - 1.0),
                f'exchanged {what} of {names[i]} and {names[k]}')


def _turned(reading: Reading) -> Iterator[Candidate]:
    """Yield positions, torques, or both of a joint, and all torques, of the opposite sign."""
    names = reading.arm.joints
    for j, name in enumerate(names):
        sign = np.where(np.arange(len(names)) == j, -1.0, 1.0)
        ways = [('position_sign', f'the position of {name} counts', 'encoder',
                 reading.moved(lambda x: x * sign, False))]
        if j in reading.joints:
            ways += [('position_sign', f'position and torque of {name} count',
                      'encoder and of the torque', reading.moved(lambda x: x * sign, True)),
                     ('torque_sign', f'the torque of {name} counts', 'torque',
                      reading.but(scale=reading.scale * sign))]
        for check, what, remedy, other in ways:
            yield Candidate(check, (
                f'{what} in the other direction than in the description: turn the sign of the '
                f'{remedy}, or the axis of the joint'), other, other.evidence(),
                2.0 * len(names), f'sign of {what.rpartition(" count")[0]}')
    other = reading.but(scale=-reading.scale)
    yield Candidate('torque_sign', (
        'all torques have the opposite sign: they brake where the arm must push; publish the '
        'torque that the drive applies to the joint'), other, other.evidence())


def _scaled(reading: Reading) -> Iterator[Candidate]:
    """Yield torques of another unit or gain: of one joint, of all, or without any load."""
    sizes = reading.tau[:, reading.joints].std(axis=0), reading.modelled.std(axis=1)
    sizes[1][:] = np.maximum(sizes[1], 1e-3 * sizes[0])
    for j in (*reading.joints, -1):
        which = reading.joints if j < 0 else [j]
        at = [reading.joints.index(k) for k in which]
        gain = float(np.linalg.norm(sizes[0][at]) / np.linalg.norm(sizes[1][at]))
        for _ in range(2):
            scale = reading.scale.copy()
            scale[which] *= gain
            other = reading.but(scale=scale)
            found = other.evidence(j, other.modelled[..., None] if j < 0 else None)
            gain *= float(1.0 + found.further[0] if j < 0 else found.gains[at[0]])
        law = gain > 0.0 and abs(log(gain)) < (_LAW_GAIN if j >= 0 else 2.0 * INEXACT)
        where = reading.arm.joints[j] if j >= 0 else 'all joints'
        yield Candidate('' if law else 'torque_unit' if gain > 0.0 else 'torque_sign', (
            f'the torque of {where} is {gain:.3g} times that in N m: '
            + ('multiply currents by motor constant and gear ratio, N mm by 0.001' if gain > 0.0
               else 'publish the torque that the drive applies to the joint')), other, found,
            1.0 if j < 0 else len(reading.joints), f'gain of {where} ({gain:.2g})',
            gain < 0.0 or abs(log(gain)) > _LAW_GAIN)
    other = reading.but(scale=0.0 * reading.scale)
    yield Candidate('torque_external', (
        'the torques show none of the weight and inertia of the arm: an estimate of external '
        'torques, what a controller adds, or another unit, such as currents or torques of the '
        'motors; record the torque of each joint in N m'), other, other.evidence())


def _mounted(reading: Reading) -> Iterator[Candidate]:
    """Yield gravity in another direction, and torques without it."""
    arm = reading.arm
    weightless = replace(reading, arm=arm.with_gravity(np.zeros(3)))
    yield Candidate('torque_gravity', (
        'the torques lack those of gravity: the controller compensates it and publishes what it '
        'adds; record the measured torque, or add the gravity torque of the controller'),
        weightless, weightless.evidence())
    size = float(np.linalg.norm(arm.model.gravity.linear))
    along = [replace(reading, arm=arm.with_gravity(size * axis)).modelled - weightless.modelled
             for axis in np.eye(3)]
    down = weightless.evidence(further=np.stack(along, axis=2)).further
    down /= np.linalg.norm(down) + 1e-12
    wrong = down @ arm.model.gravity.linear < size * np.cos(_TILTED)
    other = replace(reading, arm=arm.with_gravity(size * down))
    yield Candidate('base_mounting' if wrong else '', (
        f'gravity acts along ({", ".join(f"{x + 0.0:.2f}" for x in down)}) of the base: the arm '
        'is mounted on a wall or a ceiling; turn the root of the description by a fixed joint'),
        other, other.evidence(), _CAPS if wrong else 1.0)


def _late(reading: Reading) -> Iterator[Candidate]:
    """Yield torques that are stamped later or earlier."""
    for k in (k for k in range(-_LAGS, _LAGS + 1) if k):
        other, word = reading.late(_LAG_S * k), 'later' if k > 0 else 'earlier'
        brief = f'{1e3 * _LAG_S * abs(k):.0f} ms {word}'
        yield Candidate('clock_offset' if abs(k) > 1 else '', (
            f'torques are stamped about {brief} than positions, or a joint yields; stamp both '
            'when they are measured'), other, other.evidence(), 2.0 * _LAGS, brief, False)


def _loaded(reading: Reading) -> Iterator[Candidate]:
    """Yield a load at the flange, or a hand of the description that the arm lacks."""
    for share in () if reading.load else _LOADS:
        other = reading.but(load=share * float(reading.arm.masses.sum()))
        found = other.evidence()
        yield Candidate('tool' if found.lacking > 2.0 * _ODDS else '', (
            f'the description has about {-found.load:.2g} kg more at {reading.arm.links[-1]} than '
            'the arm: a hand or a tool that is not mounted; remove its <inertial>, or mount it'),
            other, found, brief=f'a hand of {-found.load:.2g} kg', fatal=False)


_WAYS = (_exchanged, _turned, _scaled, _mounted, _late, _loaded)


def _loaded_too(reading: Reading) -> Iterator[Candidate]:
    """Yield misreadings of an arm with a load, which hides them."""
    for load in islice(_loaded(reading), 1):
        yield from (one._replace(places=one.places * exp(_ODDS)) for way in _WAYS
                    for one in way(load.reading) if one.check)


_READ = {
    'torque_sign': 'torques drive the motion',
    'position_sign': 'positions count as in the description',
    'joint_order': 'each torque belongs to the motion of its joint',
    'torque_gravity': 'torques hold the arm against gravity',
    'torque_external': 'torques move the arm',
    'base_mounting': 'gravity acts along -z of the base',
    'torque_unit': 'torques have the size of those of the joints in N m',
    'clock_offset': 'torques and positions have one clock',
    'tool': 'the description has no tool that the arm lacks',
}
"""What is right, by check."""


def check_reading(reading: Reading) -> list[Check]:
    """Say which readings are likelier than the recording as it is, and which are as likely."""
    found, told, alike = reading.evidence(), dict[str, Check](), dict[str, list[str]]()
    for _ in range(_MOST):
        every = [one for way in _WAYS for one in way(reading)]

        def odds(one: Candidate) -> float:
            return one.evidence.nat - found.nat - log(one.places) - _ODDS

        if any(odds(one) > 0.0 for one in every):
            every += _loaded_too(reading)
        # A misreading must be likelier than the best law, and than none.
        best, law = (max((one for one in every if bool(one.check) == wrong), key=odds)
                     for wrong in (True, False))
        lawful = odds(law) > 0.0
        if odds(best) > max(odds(law), 0.0) + _ODDS:
            told[best.check] = Check(best.check, False, best.text, fatal=best.fatal)
            reading, found = best.reading, best.evidence
            continue
        if lawful:
            reading, found = law.reading, law.evidence
        for one in every:
            if one.check and one.brief and one.evidence.nat > found.nat - _ODDS:
                alike.setdefault(one.check, []).append(one.brief)
        if not lawful:
            break
    return [told.get(name) or Check(name, True, text if name not in alike else (
        f'{text}; this motion does not tell: {", ".join(dict.fromkeys(alike[name]))}'),
        tested=name not in alike) for name, text in _READ.items()]


def examine(channels: Channels) -> list[Check]:
    """Make all checks that need the dynamics, of each recording."""
    files = sorted({one.file for one in channels.pieces})
    every = [check_reading(Reading.of(channels, file)) for file in files]
    return next((one for one in every if not all(check.ok for check in one)), every[0])
