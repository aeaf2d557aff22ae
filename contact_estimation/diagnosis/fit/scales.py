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

"""How large things are in a recording."""

from __future__ import annotations

from typing import Sequence

import numpy as np

from .fitting import Fit
from ..observe.observed import Observed
from ..observe.ports import Ports
from ...physics.scales import Scales

_PEAKS, _HIGHEST_HZ = 3, 20.0


def measure_scales(ports: Sequence[Ports], base: Fit) -> Scales:
    """
    Measure depth, speed, forces and the periodic part of the contact residual.

    Parameters
    ----------
    ports : sequence of Ports
        Recordings; the first one's spectrum is taken.
    base : Fit
        The model without the effect that is searched for.

    Returns
    -------
    scales : Scales
        None of them 0.

    """
    model, laws = base.model, base.model.laws()
    depth = speed = force = control = pull = duration = 1e-9
    for port in ports:
        o = port.observed
        inside = laws.contact.contact(o.t, o.x, o.v) if laws.contact.unilateral else o.t >= 0.0
        if not inside.any():
            continue
        depth = max(depth, float(np.max(np.abs(o.x[inside] - model.nominal.environment.location))))
        speed = max(speed, float(np.percentile(np.abs(o.v[inside]), 98)))
        force = max(force, float(np.max(np.abs(o.force))))
        pull = max(pull, float(np.percentile(o.force, 99.8)))
        duration = max(duration, float(o.t[-1]))
        if o.reference is not None:
            u = laws.robot.impedance_force(o.x, o.v, o.reference)
            control = max(control, float(np.max(np.abs(u))))
    return Scales(
        depth, speed, force, control, pull, duration, max(model.stiffness, 1e-9),
        max(model.damping, 1e-9), laws.robot.mass, _spectrum(ports[0], base),
    )


def _spectrum(port: Ports, base: Fit) -> tuple[tuple[float, complex], ...]:
    """Find the largest peaks of the contact residual on a grid finer than 1 / duration."""
    o: Observed = port.observed
    law = base.model.laws().contact
    if not law.unilateral:
        return ()
    residual = port.force_residual(base.model)
    use = port.use & o.measured & (law.force(o.t, o.x, o.v, o.a) < 0.0)
    stride = max(1, round(0.02 / o.h))
    t, r = o.t[use][::stride], residual[use][::stride]
    if len(t) < 50:
        return ()
    spacing = 0.25 / max(float(o.t[-1]), 1.0)
    frequencies = np.arange(0.5 / max(float(o.t[-1]), 1.0), min(_HIGHEST_HZ, 12.0), spacing)
    phases = np.exp(-2j * np.pi * np.outer(frequencies, t))
    amplitudes = 2.0 / len(t) * (phases @ (r - r.mean()))
    found: list[tuple[float, complex]] = []
    for k in np.argsort(-np.abs(amplitudes)).tolist():
        if all(abs(frequencies[k] - other) > 4.0 * spacing for other, _ in found):
            found.append((float(frequencies[k]), complex(amplitudes[k])))
        if len(found) == _PEAKS:
            break
    return tuple(found)
