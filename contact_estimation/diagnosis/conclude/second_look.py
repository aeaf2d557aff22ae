# Copyright 2026 contact_estimation authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""
A second look at recordings that a diagnosis does not explain as they are.

The object may have been moved between the contacts, or a drive held at rest by its friction: once
that is put aside, what is missing besides may be found.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Callable, NamedTuple, Sequence

from .naming import diagnose_apart
from .result import Diagnosis
from ..checks.check import Check
from ..checks.experiment import with_places
from ..fit.search import Progress
from ..fit.surfaces import on_one_surface, Surfaces, surfaces_of
from ..observe.model import Model
from ..observe.prepared_recording import prepare
from ..observe.signals import Recording
from ..observe.usable_samples import held_at_rest

_BETTER = 0.7  # of the held-out force error: surfaces that are apart explain more than names do


class Given(NamedTuple):
    """
    What is diagnosed, after all checks.

    Attributes
    ----------
    nominal : Model
        The model under diagnosis.
    fitted, held_out : sequence of Recording
        Those that are fitted, and those on which the fits are tested.
    checks : list of Check
        Their results.
    seed : int
        Of the bootstraps.
    progress : callable
        Called with a description of each stage.

    """

    nominal: Model
    fitted: Sequence[Recording]
    held_out: Sequence[Recording]
    checks: list[Check]
    seed: int
    progress: Progress


Diagnose = Callable[[Given], Diagnosis]


def without_rests(given: Given, diagnosis: Diagnosis, again: Diagnose) -> Diagnosis:
    """
    Diagnose without the rests of a drive where they hide what is missing while it moves.

    Parameters
    ----------
    given : Given
        As recorded.
    diagnosis : Diagnosis
        Of it.
    again : callable
        Diagnoses what is given.

    Returns
    -------
    diagnosis : Diagnosis
        The better one.

    """
    if diagnosis.verdict != 'unexplained' or all(
            held_at_rest(given.nominal, one.observed) is None for one in diagnosis.recordings):
        return diagnosis
    moving = given._replace(
        fitted=[replace(one, rests_count=False) for one in given.fitted],
        held_out=[replace(one, rests_count=False) for one in given.held_out])
    other = again(moving)
    more = other.verdict == 'physics_missing' or other.effects and not diagnosis.effects
    return replace(other, rests_left_out=True) if more else diagnosis


def at_the_surfaces(given: Given, diagnosis: Diagnosis, again: Diagnose) -> Diagnosis:
    """
    Diagnose with a surface for each contact, where that predicts better.

    Parameters
    ----------
    given : Given
        As recorded.
    diagnosis : Diagnosis
        Of it.
    again : callable
        Diagnoses what is given.

    Returns
    -------
    diagnosis : Diagnosis
        The better one.

    """
    if _is_enough(diagnosis):
        return diagnosis
    every = [*given.fitted, *given.held_out]
    surfaces = surfaces_of(diagnosis.recordings if len(every) == 1 else [
        prepare(one, given.nominal, hold=0) for one in every])
    if surfaces.are_apart:
        moved = again(_on_one_surface(given, surfaces))
        diagnosis = moved if _predicts_better(moved, diagnosis) else diagnosis
    if surfaces.are_of_several and diagnosis.verdict == 'unexplained' and not diagnosis.effects:
        return replace(diagnosis, next_experiment=diagnose_apart(surfaces.springs))
    return diagnosis


def _on_one_surface(given: Given, surfaces: Surfaces) -> Given:
    """Move the contacts to the surface of the model."""
    moved, location = [], given.nominal.nominal.environment.location
    for number, one in enumerate((*given.fitted, *given.held_out)):
        of_it = [k for k, contact in enumerate(surfaces.contacts) if contact.recording == number]
        moved.append(replace(one, signals=on_one_surface(
            one.signals, [surfaces.contacts[k] for k in of_it],
            [float(surfaces.fitted[k]) for k in of_it], location)))
    count = len(given.fitted)
    return given._replace(fitted=moved[:count], held_out=moved[count:],
                          checks=with_places(given.checks, surfaces.fitted.tolist()))


def _is_enough(diagnosis: Diagnosis) -> bool:
    """Return whether no surfaces of the contacts could predict the held-out force better."""
    if diagnosis.verdict in ('consistent', 'recalibrate'):
        return True
    error = diagnosis.force.corrected
    return bool(diagnosis.effects) and (
        error is not None and _BETTER * error < diagnosis.noise_floor)


def _predicts_better(moved: Diagnosis, diagnosis: Diagnosis) -> bool:
    """Return whether the contacts on one surface tell more than those as recorded."""
    if moved.refused or not diagnosis.effects:
        return not moved.refused
    there, here = moved.force.corrected, diagnosis.force.corrected
    return (moved.verdict != 'unexplained' and there is not None and here is not None
            and there < _BETTER * here)
