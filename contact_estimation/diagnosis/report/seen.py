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

"""What there is to see of a diagnosis: the series that its pictures draw."""

from __future__ import annotations

from math import sqrt
from typing import Mapping, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..conclude.result import Diagnosis
from ..observe.model import Model
from ..observe.prepared_recording import PreparedRecording
from ..observe.residuals import force_residual, motion_residual
from ..observe.usable_samples import usable

Array = NDArray[np.float64]
Span = tuple[float, float]

_CLOSE_UP_S = 1.5
_MOST_SWINGS = 30.0  # in a close-up, of a wall that vibrates
_GAP_S = 0.2  # what touch-downs cut out of a held-out part
_MOST_DOTS = 3000


class Before(NamedTuple):
    """
    A signal as recorded and as simulated.

    Attributes
    ----------
    label : str
        Name with unit.
    recorded : ndarray, shape (N,)
        Measured.
    simulated : mapping of str to ndarray, shape (N,)
        By model.

    """

    label: str
    recorded: Array
    simulated: Mapping[str, Array]


class Left(NamedTuple):
    """
    What is left at a port, averaged over blocks.

    Attributes
    ----------
    label : str
        Name with unit.
    left : mapping of str to ndarray, shape (blocks,)
        By model.
    noise : float
        Standard deviation of a block's mean where a model is right.
    holds_location : bool
        Whether the mismatch was located here.

    """

    label: str
    left: Mapping[str, Array]
    noise: float
    holds_location: bool


class Plane(NamedTuple):
    """
    What is left over position and speed.

    Attributes
    ----------
    of, x_label : str
        What is left, and name of the abscissa.
    x, v : ndarray, shape (D,)
        Depth [m] and speed [m/s].
    left : mapping of str to ndarray, shape (D,)
        In standard deviations, by model.

    """

    of: str
    x_label: str
    x: Array
    v: Array
    left: Mapping[str, Array]


class Seen(NamedTuple):
    """
    The recording that is shown.

    Attributes
    ----------
    pair : (str, str)
        The models to be compared: before and after what the diagnosis changes.
    t : ndarray, shape (N,)
        Time [s].
    force, position : Before or None
        None where there is nothing to run free.
    block_t : ndarray, shape (blocks,)
        Middle of each block [s].
    residuals : list of Left
        Of the force port, the motion port, or both.
    plane : Plane
        Of the port where the mismatch is.
    close_up : slice
        Samples around the greatest difference.
    close_up_span : (float, float)
        The same [s].

    """

    pair: tuple[str, str]
    t: Array
    force: Before
    position: Before | None
    block_t: Array
    residuals: list[Left]
    plane: Plane
    close_up: slice
    close_up_span: Span


def seen(diagnosis: Diagnosis) -> Seen:
    """
    Gather the series.

    Parameters
    ----------
    diagnosis : Diagnosis
        The result.

    Returns
    -------
    seen : Seen
        Of the recording that is shown.

    """
    recording, pair = diagnosis.recordings[0], diagnosis.pair
    names = tuple(dict.fromkeys(('nominal', *pair)))
    models: dict[str, Model] = {name: getattr(diagnosis, name) for name in names}
    o = recording.observed
    left = {name: force_residual(recording, model) for name, model in models.items()}
    force = Before('force [N]', o.force, {name: o.force - e for name, e in left.items()})
    position = None
    if diagnosis.free_runs:
        runs = {name: 1e3 * diagnosis.free_runs[name] for name in names}
        position = Before('position, free run [mm]', 1e3 * o.raw_position, runs)
    in_motion = diagnosis.located_channel == 'motion'
    residuals = _residuals(recording, models, left, in_motion)
    shown = residuals[-1 if in_motion else 0]
    close_up = _close_up(recording, shown.left[pair[0]])
    span = float(o.t[close_up.start]), float(o.t[close_up.stop - 1])
    count = len(o.t) // recording.block
    block_t: Array = o.h * recording.block * (0.5 + np.arange(count, dtype=np.float64))
    plane = _plane(recording, models[pair[-1]], shown, in_motion)
    return Seen(pair, o.t, force, position, block_t, residuals, plane, close_up, span)


def _residuals(
    recording: PreparedRecording, models: Mapping[str, Model], left: Mapping[str, Array],
    in_motion: bool,
) -> list[Left]:
    noise = recording.force_noise / sqrt(recording.block)
    rows = [Left('force left over [N]', {name: recording.blocks(e) for name, e in left.items()},
                 noise, not in_motion)] if not recording.driven_by_force(models['nominal']) else []
    motion = {name: motion_residual(recording, model) for name, model in models.items()}
    innovations = {name: e for name, e in motion.items() if e is not None}
    if len(innovations) == len(models):
        # Innovations: what of the motion the model did not foresee at each instant.
        rows.append(Left(
            'motion left over [µm]',
            {name: 1e6 * recording.blocks(e) for name, e in innovations.items()},
            1e6 * recording.observed.position_noise / sqrt(recording.block), in_motion,
        ))
    return rows


def _close_up(recording: PreparedRecording, strongest: Array) -> slice:
    """Choose the stretch with the most left over, the few samples of an impact set aside."""
    o = recording.observed
    swings = np.count_nonzero(np.diff(np.sign(o.x - np.median(o.x)))) / float(o.t[-1])  # [1/s]
    duration = min(_CLOSE_UP_S, _MOST_SWINGS / max(swings, 1e-9))
    span = min(len(o.t), max(2, round(duration / o.h)))
    bent = np.minimum(np.abs(strongest), np.percentile(np.abs(strongest), 99.0))
    width = max(1, span // recording.block)
    energy = np.convolve(bent**2, np.ones(width), mode='valid')
    first = min(int(np.argmax(energy)) * recording.block, len(o.t) - span)
    return slice(first, first + span)


def _plane(recording: PreparedRecording, model: Model, row: Left, in_motion: bool) -> Plane:
    o, law = recording.observed, model.laws().contact
    x, v = (recording.blocks(signal) for signal in (o.x - model.nominal.environment.location, o.v))
    use = np.ones(len(x), bool)
    label = 'position before and in the wall [mm]'
    if law.unilateral and not in_motion:
        use = recording.touching(model)
        label = 'depth in the wall [mm]'
    if not law.unilateral:
        label = 'deflection [mm]'
    use &= recording.blocks(recording.use.astype(float)) + _unused(recording, model) > 0.5
    some = np.flatnonzero(use)
    some = some[::max(1, len(some) // _MOST_DOTS)]
    left = {name: e[some] / row.noise for name, e in row.left.items()}
    return Plane('motion' if in_motion else 'force', label, x[some], v[some], left)


def _unused(recording: PreparedRecording, model: Model) -> Array:
    """Tell which blocks are held out, though any model could be held to them."""
    return recording.blocks((usable(model, recording.observed) & ~recording.use).astype(float))


def held_out_spans(diagnosis: Diagnosis) -> list[Span]:
    """
    Find which parts of the shown recording no fit has seen.

    Parameters
    ----------
    diagnosis : Diagnosis
        The result.

    Returns
    -------
    spans : list of (float, float)
        Times [s].

    """
    recording = diagnosis.recordings[0]
    o = recording.observed
    held = usable(diagnosis.nominal, o) & ~recording.use
    spans: list[Span] = []
    edges = np.flatnonzero(np.diff(held.astype(int), prepend=0, append=0))
    for first, stop in zip(edges[::2].tolist(), edges[1::2].tolist()):
        begin, end = float(o.t[first]), float(o.t[stop - 1])
        if spans and begin - spans[-1][1] < _GAP_S:
            spans[-1] = spans[-1][0], end
        else:
            spans.append((begin, end))
    return spans
