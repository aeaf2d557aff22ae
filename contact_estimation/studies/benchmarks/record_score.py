# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Whether a diagnosis names what is known about a record of a real thing."""

from __future__ import annotations

from typing import Any, Mapping

from ..blind_trials.family_scoring import (
    NEUTRAL, of_families, outcome_of, RIGHT, scored_names, SILENT)
from ...exceptions import RecordingError
from ...physics import EFFECTS

CLASSES = ('right alone', 'right with surplus', 'wrong first', 'silent', 'rightly silent',
           'failed')
"""Classes of a record of which the truth is known."""

_ALIKE = (
    {'coulomb_friction', 'stribeck_friction', 'presliding_friction', 'robot_friction',
     'bouc_wen_hysteresis'},
    {'bouc_wen_hysteresis', 'plastic_set', 'unloading_hysteresis', 'presliding_friction'},
    {'dead_zone', 'backlash', 'contact_offset'},
)
# These are of one kind as acceptable names, but each of them says less than its family.
_ALONE = {'bouc_wen_hysteresis', *NEUTRAL}
_MIXED = ('wall_motion', 'limits', 'robot')  # families whose members are different things


def acceptable_names(truth: Mapping[str, Any]) -> set[str]:
    """Return the effects that a truth file asks for."""
    if 'acceptable_names' in truth:
        return set(truth['acceptable_names'])
    if 'families' in truth:
        return of_families(truth['families'])
    if 'effects' in truth:
        return {name for effect in truth['effects']
                for name in (effect['name'], *effect.get('also', []))}
    raise RecordingError(
        f'a truth file must have acceptable_names, effects or families, got '
        f'{", ".join(truth) or "nothing"}; add one of them')


def with_relatives(names: set[str]) -> set[str]:
    """
    Add to acceptable names those of their families.

    Real friction rests, slides and hystereses at once: pre-sliding and Bouc-Wen laws, and friction
    of the robot or of the contact, count as one kind here.
    """
    telling = names - _ALONE
    families = {EFFECTS[name].family for name in telling if name in EFFECTS}.difference(_MIXED)
    found = names | (of_families(list(families)) - set(NEUTRAL))
    return found.union(*(alike for alike in _ALIKE if alike & telling))


def class_of(truth: Mapping[str, Any], report: Mapping[str, Any] | None) -> str:
    """Return the class of a report."""
    asked = acceptable_names(truth)
    names = scored_names((report or {}).get('effects', []), with_relatives(asked),
                         set(NEUTRAL) - asked)
    outcome = outcome_of(report is not None, names)
    if outcome == RIGHT:
        return 'right alone' if all(name.right for name in names) else 'right with surplus'
    if outcome == SILENT:
        return 'silent' if asked else 'rightly silent'
    return 'failed' if report is None else 'wrong first'
