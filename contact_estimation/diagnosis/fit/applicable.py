# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
Which effects may be added to a model: those that are physically possible on a rig.

An effect that a recording cannot tell from another is possible all the same: both then have the
same weight, and are listed with each other.
"""

from __future__ import annotations

from typing import Any, Sequence

import numpy as np

from ..observe.model import Model
from ..observe.prepared_recording import PreparedRecording, Recordings
from ..observe.residuals import force_residual
from ..observe.smoothing import keeps_step
from ...parameters.specification import ParameterGroup
from ...physics import EFFECTS
from ...physics.effect import Effect


_SLACK = 0.02  # of the range, by which a pressed wall may be pulled
_STROKES = 1.5  # ranges of the motion: its path, if it returns


def candidates_in(recordings: Recordings, model: Model) -> list[str]:
    """List the effects that may be added to a model."""
    return [name for name, cls in EFFECTS.items() if name not in model.effects
            and name not in model.excluded and not _impossible(cls, recordings, model)]


def untried(recordings: Recordings, model: Model) -> list[tuple[str, str]]:
    """List the families of which no law was tried."""
    tried = {EFFECTS[name].family for name in candidates_in(recordings, model)}
    reasons = dict[str, str]()
    for name, cls in EFFECTS.items():
        if cls.family not in tried:
            reason = _impossible(cls, recordings, model) or (
                'the nominal model has it' if name in model.effects else
                'a check has failed that looks like it')
            reasons.setdefault(cls.family, reason)
    return sorted(reasons.items())


def _impossible(cls: type[Effect], recordings: Recordings, model: Model) -> str:
    """Say why an effect is impossible on a rig, or on what it was moved; '' if it is possible."""
    wall = model.nominal.environment
    attached = not wall.unilateral
    reasons = {
        'needs the reference trajectory of a robot': cls.needs_robot and not any(
            one.observed.reference is not None for one in recordings),
        'needs a contact that begins and ends': cls.needs_touch and attached,
        'needs an attached specimen': cls.needs_attachment and not attached,
        'needs a specimen that is pressed only': (
            cls.needs_penetration and attached and not _is_pressed(recordings, model)),
        'needs a spring': cls.needs_spring and attached and wall.stiffness <= 0.0,
        'needs a wall that no force drives': (
            cls.lets_go and attached and wall.inertia > 0.0),
        'the nominal model has it': cls.base_parameter == 'inertia' and model.with_inertia,
        'needs a motion that returns': cls.needs_return and not any(
            map(_returns, recordings)),
    }
    return next((reason for reason, applies in reasons.items() if applies), '')


def _is_pressed(recordings: Recordings, model: Model) -> bool:
    """Return whether a permanently attached wall is only pressed in recordings, never pulled."""
    surface = model.nominal.environment.location
    return all(float(np.min(one.observed.x)) - surface > -_SLACK * float(np.ptp(one.observed.x))
               for one in recordings)


def _returns(recording: PreparedRecording) -> bool:
    """Return whether the motion is more than one stroke and a hold."""
    x = recording.observed.x
    return float(np.sum(np.abs(np.diff(x)))) > _STROKES * float(np.ptp(x))


# Of a clipped force, in standard deviations of its noise and as a share of the limit; of the time,
# in the direction in which it is clipped less.
_LEVEL, _SLOPE, _MOST_HELD = 3.0, 0.01, 0.25
_MARGIN = 0.01  # of the samples in contact, beyond the depth at which a law bends
_REACHED, _COVERED = 1.5, 5.0  # of the range of the force, and of that of motion or depth
_ABOVE_NOISE = 2.0  # of the positions
_RESOLVED = 0.125  # periods a sample: faster is the course of a force between samples
_LATE = 0.05  # of a sample period: stamps are known no better


def is_credible(recordings: Recordings, model: Model) -> bool:
    """Return whether the values of a model are possible, and its last effect where they put it."""
    return model.plausible() and may_show(recordings, model, model.effects[-1])


def may_show(recordings: Recordings, model: Model, name: str) -> bool:
    """Return whether recordings may show an effect where the values of a model put it."""
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
