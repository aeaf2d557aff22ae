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

"""Whether held-out data contradict a model: the power of what it leaves there."""

from __future__ import annotations

from typing import Sequence

import numpy as np
from numpy.typing import NDArray

from ..fit.criteria import EXPLAINED, explained_share
from ..fit.discrepancy import forces, least_material
from ..fit.fitting import Fit
from ..fit.output_error import refine, runs_true
from ..observe.model import Model
from ..observe.prepared_recording import Recordings
from ..observe.residuals import force_residual, residuals
from ...physics import EFFECTS

Array = NDArray[np.float64]

MOST_POWER = 2.0
"""Held-out mean square, over that of the noise, of a wrong model."""


def confirmed(base: Fit, best: Fit, recordings: Recordings, whole: Recordings) -> Fit:
    """
    Return the best model, or the recalibrated one if held-out data contradict the names.

    Parameters
    ----------
    base, best : Fit
        Recalibrated, and with effects.
    recordings : sequence of PreparedRecording
        As fitted.
    whole : sequence of PreparedRecording
        The same with their held-out parts.

    Returns
    -------
    confirmed : Fit
        `best` without a robot, and where the force vanishes during contacts.

    """
    if recordings[0].observed.reference is None or releases_contact(recordings, best.model):
        return best
    powers = [[float(np.mean(part)) for part in held_out_powers(whole, model)]
              for model in (base.model, best.model)]
    contradicted = any(
        after > MOST_POWER and explained_share(before, after, 1.0) < EXPLAINED
        for before, after in zip(*powers))
    # Where a robot sticks, velocities are not known well enough for the residuals.
    if contradicted and not runs_true(whole, refine(recordings, best)[1].model):
        return base
    return best


def largest(powers: Sequence[Array]) -> float:
    """Return the largest of the powers of `held_out_powers`."""
    return max((float(np.max(part)) for part in powers), default=0.0)


def held_out_powers(whole: Recordings, model: Model, trifles: bool = True) -> list[Array]:
    """
    Return the mean square residual of each channel in each held-out part.

    Parameters
    ----------
    whole : sequence of PreparedRecording
        With their held-out parts.
    model : Model
        With its values.
    trifles : bool
        Whether what is too small to be worth a name counts.

    Returns
    -------
    powers : list of ndarray, shape (channels,)
        In the power of the noise.

    """
    powers = []
    for recording in whole:
        if recording.held_out is None:
            continue
        samples = recording.held_out.samples & recording.use
        there = recording.blocks(samples.astype(float)) > 0.5
        if there.any():
            part = recording.split(residuals(recording, model))[:, there]
            power = np.mean(part**2, axis=1)
            if not trifles:
                errors = np.sqrt(power) * forces(recording, model)
                # The first channel, of a wall driven by a force its motion, by the force it lacks.
                force = force_residual(recording, model)[samples]
                errors[0] = np.sqrt(np.mean(force**2))
                power[errors < least_material(recording)] = 0.0
            powers.append(power)
    return powers


def releases_contact(recordings: Recordings, model: Model) -> bool:
    """
    Return whether the force vanishes during contacts and an effect of the model does so.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        As fitted.
    model : Model
        With its effects.

    Returns
    -------
    releases : bool
        If so, what is left is the instant, within a sample, of each release.

    """
    effects = [EFFECTS[name].lets_go for name in model.effects]
    return any(effects) and all(recording.dropped is not None for recording in recordings)
