# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
Which effects may be added to a model: those that are physically possible on a rig.

An effect that a recording cannot tell from another is possible all the same: both then have the
same weight, and are listed with each other.
"""

from __future__ import annotations

import numpy as np

from ..observe.model import Model
from ..observe.prepared_recording import PreparedRecording, Recordings
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
