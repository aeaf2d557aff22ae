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
Whether a mass is one at low frequencies too, where a resonance far above has none.

The ringing of a sensor's mount, r'' + 2 zeta omega r' + omega^2 r = omega^2 F, adds F'' / omega^2
to a force below its resonance: of a mass on the mount a term in the fourth power of the frequency,
which a constant mass fits in part (Ewins, Modal Testing, 2000: apparent mass).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..observe.model import Model
from ..observe.prepared_recording import PreparedRecording, Recordings
from ..observe.residuals import force_residual
from ...physics import EFFECTS

Array = NDArray[np.float64]

_POWER, _OCTAVE = 0.95, 2.0  # share of the power of the velocity below half of the corner
_EDGE_S = 0.02  # left out beside samples that are not used
_FEWEST = 50  # samples
_GAIN, _LEFT = 0.25, 0.5  # of the fourth power; most of the mass that it leaves a resonance


def is_resonance(recordings: Recordings, model: Model, name: str) -> bool:
    """
    Return whether a mass vanishes at low frequencies.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        As fitted.
    model : Model
        Fitted, with the mass.
    name : str
        Effect that is a mass.

    Returns
    -------
    resonance : bool
        A term in the fourth power of the frequency beside the mass takes away a fair share of
        what it leaves, and most of the mass.

    """
    rows = [_rows(one, model, name) for one in recordings]
    columns, force = (np.concatenate(every) for every in zip(*rows))
    if len(force) < _FEWEST:
        return False
    columns = columns / np.sqrt(np.mean(columns**2, axis=0) + 1e-300)
    without, (mass, *_) = _regress(columns[:, 1:], force)
    left, (_, remaining, *_) = _regress(columns, force)
    return bool(without - left > _GAIN * without and remaining < _LEFT * mass)


def _regress(columns: Array, force: Array) -> tuple[float, Array]:
    """Return the sum of squares that least squares leaves, and the weights."""
    weights = np.linalg.lstsq(columns, force, rcond=None)[0]
    return float(np.sum((force - columns @ weights) ** 2)), np.asarray(weights, np.float64)


def _rows(recording: PreparedRecording, model: Model, name: str) -> tuple[Array, Array]:
    """Return a'', -a, x, v and constants, and the force without the mass, below a corner."""
    from scipy.signal import butter, filtfilt  # slow to import

    o, laws = recording.observed, model.laws()
    values = np.array(model.values)
    values[model.place(name)] = 0.0
    missing = force_residual(recording, model.at(values))
    inside = laws.touching(o) if laws.contact.unilateral else np.ones(len(o.t), bool)
    used = recording.use & o.measured & (inside | (EFFECTS[name].port != 'contact'))
    width = 2 * max(1, round(_EDGE_S * o.pace / o.h)) + 1
    used &= np.convolve(~used, np.ones(width), 'same') < 0.5
    power = np.cumsum(np.abs(np.fft.rfft(o.v - np.mean(o.v))) ** 2)
    highest = np.fft.rfftfreq(len(o.v), o.h)[np.searchsorted(power, _POWER * power[-1])]
    corner = min(max(_OCTAVE * highest, 2.0 / float(np.ptp(o.t))), 0.4 / o.h)
    low_passed = butter(2, corner, fs=1.0 / o.h)
    x, v, a, missing = (filtfilt(*low_passed, each) for each in (o.x, o.v, o.a, missing))
    jerk_rate = np.gradient(np.gradient(a, o.h), o.h)
    columns = np.column_stack([jerk_rate, -a, x * inside, v * inside, inside, np.ones(len(x))])
    return columns[used], missing[used]
