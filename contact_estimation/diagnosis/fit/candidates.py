# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
Which effects may be added to a model, and with which values.

An effect may be added if it is physically possible on a rig, also if a recording cannot tell it
from another: both then have the same weight, and are listed with each other.
"""

import numpy as np

from ..observe.model import Model
from ..observe.parts import episodes
from ..observe.prepared_recording import PreparedRecording, Recordings
from ..observe.residuals import force_residual
from ..observe.shares import MOST, MUCH, SLIGHT
from ...physics import EFFECTS
from ...physics.effect import Effect, Need


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
    """Say what an effect needs that a rig, or its motion, lacks; '' if it is possible."""
    wall = model.nominal.environment
    attached = not wall.unilateral
    lacks = {
        Need.ROBOT: all(one.observed.reference is None for one in recordings),
        Need.TOUCH: attached,
        Need.ATTACHMENT: not attached,
        Need.PRESSING: attached and not _is_pressed(recordings, model),
        Need.SPRING: attached and wall.stiffness <= 0.0,
        Need.NO_DRIVE: attached and wall.inertia > 0.0,
        Need.NO_MASS: model.with_inertia,
        Need.RETURN: not any(map(_returns, recordings)),
    }
    return next((f'needs {need.value}' for need in Need if need in cls.needs and lacks[need]), '')


def _is_pressed(recordings: Recordings, model: Model) -> bool:
    """Return whether a permanently attached wall is only pressed in recordings, never pulled."""
    surface = model.nominal.environment.location
    return all(float(np.min(one.observed.x)) - surface > -SLIGHT * float(np.ptp(one.observed.x))
               for one in recordings)


def _returns(recording: PreparedRecording) -> bool:
    """Return whether much of the force changes on a way back: a part of the stroke may be all."""
    o = recording.observed
    gone = np.abs(o.x - o.x[0])
    back = np.maximum.accumulate(gone) - gone > SLIGHT * float(np.ptp(o.x))
    return bool(back.any()) and float(np.ptp(o.force[back])) > MOST * o.force_range


# Of a clipped force, in standard deviations of its noise and as a share of the limit.
_LEVEL, _SLOPE = 3.0, 0.01


def is_credible(recordings: Recordings, model: Model) -> bool:
    """Return whether the values of a model are possible, and its effects where they put them."""
    added = [model.effect(name) for name in model.effects if name not in model.given]
    return model.plausible() and all(
        not effect.vanishes() and any(effect.may_show(_Recorded(one, model)) for one in recordings)
        for effect in added)


def is_flexible(recordings: Recordings, model: Model, name: str) -> bool:
    """Return whether an effect is a curve that follows any slow misfit of recordings."""
    return all(model.effect(name).is_flexible(_Recorded(one, model)) for one in recordings)


class _Recorded:
    """What an effect asks of a recording; see `Seen`."""

    def __init__(self, recording: PreparedRecording, model: Model) -> None:
        self._recording, self._model = recording, model
        self.force = float(np.max(np.abs(recording.observed.force)))
        surface = model.nominal.environment.location
        self.depth = float(np.max(np.abs(recording.observed.x - surface)))
        self.stroke = float(np.ptp(recording.observed.x))
        self.stiffness = model.stiffness
        self.duration = float(recording.observed.t[-1])
        self.sample_period = recording.observed.h

    @property
    def touch(self) -> float:
        """Return the duration of the longest contact."""
        found = episodes(self._model, self._recording.observed)
        return max((self.sample_period * (stop - first) for first, stop in found),
                   default=self.duration)

    def clips(self, limit: float) -> bool:
        """Return whether the force sensor clips as a saturating one does."""
        # The measured force is level where it would be held, though the motion is not, and not for
        # most of the time to and fro, as friction holds it.
        one, model = self._recording, self._model
        o, force = one.observed, one.observed.force
        held = (np.abs(force - force_residual(one, model)) >= limit) & one.use
        if not held.any() or (
                float(np.std(np.abs(force[held]))) > _LEVEL * one.force_noise + _SLOPE * limit):
            return False
        swing = np.hypot(model.stiffness * np.std(o.x[held]), model.damping * np.std(o.v[held]))
        up, most = np.count_nonzero(force[held] > 0.0), np.count_nonzero(held)
        return bool(swing > one.force_noise
                    and min(up, most - up) <= MUCH * np.count_nonzero(one.use))
