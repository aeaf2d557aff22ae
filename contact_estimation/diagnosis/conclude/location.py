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

"""Where a mismatch sits: port, time, phase of the contact, region of the motion, band."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.signal import periodogram

from ..observe.model import Model
from ..observe.ports import Ports

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

_WINDOW_S = 0.1
_STRONG = 2.5  # mean square of the residual in a window, in those of the noise
_GAP_S = 0.3  # intervals closer than this are one
_MOST_INTERVALS = 12
_SILENT = 0.02  # of the force port's excess; less is no answer of the motion
_ENTRY_S = 0.15
_SLOW = 0.15  # of the speed that 95 % of the contact stays below


class Location(NamedTuple):
    """
    Where a mismatch sits.

    Attributes
    ----------
    port : str
        'contact', 'force_sensor' or 'robot'.
    intervals_s : list of (float, float)
        When [s].
    phase : str
        'free', 'entry', 'loading', 'hold', 'unloading' or 'all'.
    region : str
        In words.
    band_hz : (float, float)
        Frequencies between which four fifths of the residual's energy lie.

    """

    port: str
    intervals_s: list[tuple[float, float]]
    phase: str
    region: str
    band_hz: tuple[float, float]

    def as_dict(self) -> dict[str, Any]:
        """Give the report's form."""
        return {
            'port': self.port,
            'intervals_s': [[round(a, 3), round(b, 3)] for a, b in self.intervals_s],
            'phase': self.phase, 'region': self.region,
            'band_hz': [round(f, 3) for f in self.band_hz],
        }


def locate(port: Ports, model: Model, acting: str | None = None) -> Location:
    """
    Locate what a model leaves unexplained.

    Parameters
    ----------
    port : Ports
        The recording.
    model : Model
        Fitted without what is looked for.
    acting : str, optional
        The port, where it is known from the effect's name.

    Returns
    -------
    location : Location
        Of the residual's energy.

    """
    parts = port.split(port.residuals(model)) ** 2
    which = acting or guess_port(port, model)
    chosen = parts[-1] if which == 'robot' else parts[0]
    return Location(
        which, intervals(port, chosen), _phase(chosen, phases(port, model)),
        _region(port, model, chosen), _band(port, model, which),
    )


def guess_port(port: Ports, model: Model) -> str:
    """
    Tell the port from where the residuals are.

    What the wall does and the model does not know is missing in the measured force and, as a
    push, in the motion; what the sensor does, in the force alone; what the robot does, in the
    motion alone.

    Parameters
    ----------
    port, model
        As for `locate`.

    Returns
    -------
    port : str
        'contact', 'force_sensor' or 'robot'.

    """
    missing = port.force_residual(model)
    answer = port.answer_to(missing * port.use, model)
    innovations = port.motion_residual(model)
    if answer is None or innovations is None:
        return 'contact'
    force = port.average('force', missing, port.force_noise)
    motion = port.average('motion', innovations, port.motion_noise)
    excess = [max(0.0, float(np.sum(part**2 - 1.0))) for part in (force, motion)]
    if excess[1] < _SILENT * excess[0]:
        return 'force_sensor'
    pushed = port.average('motion', answer, port.motion_noise)
    share = float(pushed @ motion) / max(float(pushed @ pushed), 1e-300)
    explained = 1.0 - float(np.sum((motion - share * pushed) ** 2)) / float(np.sum(motion**2))
    if explained > 0.5 and share > 0.5:
        return 'contact'
    return 'force_sensor' if float(pushed @ pushed) > float(motion @ motion) else 'robot'


def intervals(port: Ports, energy: Array) -> list[tuple[float, float]]:
    """
    Find when the residual is larger than the noise.

    Parameters
    ----------
    port : Ports
        The recording.
    energy : ndarray, shape (blocks,)
        Squared residuals in those of the noise.

    Returns
    -------
    intervals : list of (float, float)
        Times [s]; the strongest few, in order.

    """
    step = port.observed.h * port.block
    span = max(1, round(_WINDOW_S / step))
    mean = np.convolve(energy, np.ones(span) / span, mode='same')
    strong = mean > max(_STRONG, 0.05 * float(np.max(mean)))
    edges = np.flatnonzero(np.diff(strong.astype(int), prepend=0, append=0))
    merged: list[list[int]] = []
    for first, stop in zip(edges[::2].tolist(), edges[1::2].tolist()):
        if merged and (first - merged[-1][1]) * step < _GAP_S:
            merged[-1][1] = stop
        else:
            merged.append([first, stop])
    merged.sort(key=lambda pair: -float(np.sum(energy[pair[0]:pair[1]])))
    return sorted((a * step, b * step) for a, b in merged[:_MOST_INTERVALS])


def phases(port: Ports, model: Model) -> dict[str, Flags]:
    """
    Divide a recording into the phases of its contacts.

    Parameters
    ----------
    port : Ports
        The recording.
    model : Model
        Fitted.

    Returns
    -------
    phases : dict of str to ndarray of bool, shape (blocks,)
        By name; those of a permanently attached wall are loading and unloading alone.

    """
    o, law = port.observed, model.laws().contact
    v = port.blocks(o.v)
    if not law.unilateral:
        return {'loading': v > 0.0, 'unloading': v <= 0.0}
    inside = port.touching(model)
    since = np.zeros(len(v))
    for k in range(1, len(v)):
        since[k] = since[k - 1] + o.h * port.block if inside[k] else 0.0
    speed = np.percentile(np.abs(v[inside]), 95) if inside.any() else 1.0
    entry, slow = inside & (since < _ENTRY_S), np.abs(v) < _SLOW * speed
    rest = inside & ~entry
    return {'free': ~inside, 'entry': entry, 'hold': rest & slow,
            'loading': rest & ~slow & (v > 0.0), 'unloading': rest & ~slow & (v < 0.0)}


def _phase(energy: Array, marks: dict[str, Flags]) -> str:
    """Name the phase in which the residual is strongest, where one stands out."""
    mean = {name: float(np.mean(energy[where])) for name, where in marks.items() if where.any()}
    ranked = sorted(mean, key=lambda name: -mean[name])
    if len(ranked) > 1 and mean[ranked[0]] < 1.5 * mean[ranked[1]]:
        return 'all'
    return ranked[0] if ranked else 'all'


def _region(port: Ports, model: Model, energy: Array) -> str:
    """Say in words where in the plane of depth and rate the residual is strong."""
    o, law = port.observed, model.laws().contact
    d = port.blocks(law.penetration(o.t, o.x, o.v, law.states_along(o.t, o.x, o.v), np)[0])
    v = port.blocks(o.v)
    use = d > 0.0 if law.unilateral else np.ones(len(d), bool)
    if use.sum() < 20:
        return 'free flight'
    words = []
    for name, signal in (('|v|', np.abs(v[use])), ('d', np.abs(d[use]))):
        low, high = signal <= np.percentile(signal, 33), signal >= np.percentile(signal, 67)
        ratio = float(np.mean(energy[use][low]) / max(np.mean(energy[use][high]), 1e-12))
        if ratio > 1.5:
            words.append(f'small {name}')
        elif ratio < 1.0 / 1.5:
            words.append(f'large {name}')
    return ', '.join(words) or 'all over the contact'


def _band(port: Ports, model: Model, which: str) -> tuple[float, float]:
    motion = which == 'robot' and port.observed.reference is not None
    residual = port.motion_residual(model) if motion else port.force_residual(model)
    assert residual is not None
    frequencies, power = periodogram(np.where(port.use, residual, 0.0), 1.0 / port.observed.h)
    floor = float(np.median(power[frequencies > 0.25 / port.observed.h / 2.0]))
    energy = np.cumsum(np.maximum(power - floor, 0.0))
    if energy[-1] <= 0.0:
        return 0.0, float(frequencies[-1])
    low, high = np.searchsorted(energy, [0.1 * energy[-1], 0.9 * energy[-1]])
    return float(frequencies[low]), float(frequencies[min(high, len(frequencies) - 1)])
