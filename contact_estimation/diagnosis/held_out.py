# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""How well models predict held-out data."""

from dataclasses import replace
from typing import NamedTuple, Sequence

import numpy as np

from .fit.beam import Compared
from .fit.evidence import DRAWS
from .fit.left_out import predict, Spared
from .observe.model import Model
from .observe.prepared_recording import prepare, PreparedRecording, Recordings
from .observe.residuals import force_residual
from .result import Errors, HeldOutErrors
from .views import Seen
from ..physics.numeric import Array

_BLOCK_S = 0.25
_RESOLVED_S = 0.025  # over which the acceleration of a driven mass is averaged, twice


class HeldOutPart(NamedTuple):
    """A held-out part with the squared errors of the models on it."""

    name: str  # of the part
    # (models, blocks) sums of squared force errors over blocks of a quarter second [N^2]
    force: Array
    samples: Array  # (blocks,) samples in them
    motion: Array | None  # (models, blocks) sums of squared position errors [m^2]
    motion_samples: Array  # (blocks,) samples in them


def with_holdouts(seen: Seen) -> Seen:
    """Prepare the recordings that are held out whole, once for all models."""
    given = seen.view.given
    return seen._replace(holdouts=[
        prepare(one, given.nominal, hold=False) for one in given.held_out])


def spared_of(holdouts: Recordings, recordings: Recordings, model: Model) -> list[Spared]:
    """List what is held out, of fitted recordings or as recordings."""
    found = list[Spared]()
    for one in recordings:
        if one.held_out is not None:
            prefix = f'{one.name}, ' if len(recordings) > 1 else ''
            found.append(Spared(prefix + one.held_out.name, one.whole(model),
                                one.held_out.samples))
    return found + [Spared(one.name, one, np.ones(len(one.observed.t), bool)) for one in holdouts]


def weigh_by_held_out(seen: Seen) -> Seen:
    """Compare the models by how well they predict what is held out, too."""
    spared = spared_of(seen.holdouts, seen.recordings, seen.base.model)
    evidence, known = seen.compared.evidence, seen.compared.models
    models = [predict(one, spared) for one in known]
    evidence = replace(evidence, base=models[known.index(evidence.base)]).informed_by(models)
    return seen._replace(spared=spared, compared=Compared(evidence, evidence.ranked(models)))


def measure_part(
    spared: Spared, models: Sequence[Model], runs: Sequence[Array] | None
) -> HeldOutPart:
    """Measure the errors of models on one part."""
    name, recording, samples = spared
    o = recording.observed
    touching = samples & recording.force.use
    laws = models[-1].laws()
    if laws.contact.unilateral:
        inside = laws.touching(o)
        if (touching & inside).any():
            touching &= inside
    span = max(1, round(_BLOCK_S * o.pace / o.h))
    squares = [(_resolved(recording, model) * touching) ** 2 for model in models]
    moved = samples & ~o.start
    motion = None
    if runs is not None:
        motion = np.array([_sums((o.raw_position - x) ** 2 * moved, span) for x in runs])
    return HeldOutPart(name, np.array([_sums(s, span) for s in squares]),
                       _sums(touching.astype(float), span), motion,
                       _sums(moved.astype(float), span))


def _resolved(recording: PreparedRecording, model: Model) -> Array:
    """Return the force error; of a mass that a force drives, at the rates that x resolves."""
    error = force_residual(recording, model)
    if not recording.driven_by_force(model):
        return error
    o = recording.observed
    span = max(1, round(_RESOLVED_S * o.pace / o.h))
    mean = np.full(span, 1.0 / span)
    return np.convolve(np.convolve(error, mean, 'same'), mean, 'same')


def _sums(signal: Array, span: int) -> Array:
    return np.add.reduceat(signal, np.arange(0, len(signal), span))


def errors_of(parts: Sequence[HeldOutPart]) -> tuple[Errors, Errors]:
    """Compute the root-mean-square errors over all parts."""
    force = sum(part.force.sum(axis=1) for part in parts)
    count = sum(float(part.samples.sum()) for part in parts)
    moved = [part for part in parts if part.motion is not None]
    motion = sum(part.motion.sum(axis=1) for part in moved if part.motion is not None)
    moved_count = sum(float(part.motion_samples.sum()) for part in moved)
    return _errors(force, count), _errors(motion, moved_count)


def _errors(sums: Array | int, count: float) -> Errors:
    if isinstance(sums, int) or count == 0.0:
        return Errors(None, None, None)
    return Errors(*(float(np.sqrt(value / count)) for value in sums))


def by_part(parts: Sequence[HeldOutPart]) -> list[HeldOutErrors]:
    """List the errors part by part; parameters as `errors_of`."""
    return [HeldOutErrors(part.name, *errors_of([part])) for part in parts]


def improvement_interval(
    parts: Sequence[HeldOutPart], generator: np.random.Generator
) -> tuple[float, float] | None:
    """Bootstrap 1 - corrected / recalibrated over blocks of time, paired."""
    force = np.concatenate([part.force for part in parts], axis=1)
    count = np.concatenate([part.samples for part in parts])
    use = np.flatnonzero(count > 0.0)
    if len(use) < 2:
        return None
    drawn = generator.choice(use, (DRAWS, len(use)))
    recalibrated, corrected = (force[k][drawn].sum(axis=1) for k in (1, 2))
    ratios = 1.0 - np.sqrt(corrected / np.maximum(recalibrated, 1e-300))
    low, high = np.percentile(ratios, (2.5, 97.5))
    return float(low), float(high)
