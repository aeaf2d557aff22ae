# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Viscous flow of the wall."""

from __future__ import annotations

from dataclasses import dataclass
from math import exp
from typing import Any

import numpy as np

from .contact_effect import ContactEffect
from .drawn_effect import Scales
from .numeric import Array, Flags, Number, positive, stretches
from ..parameters.specification import optional_parameter, ParameterGroup


@dataclass(frozen=True)
class ViscousFlowParameters(ParameterGroup):
    """Parameters of `ViscousFlow`."""

    rate: float = optional_parameter(
        'Share of the deflection that becomes permanent per second', '1/s',
        minimum=0.0, maximum=1000.0)


class ViscousFlow(ContactEffect):
    """
    x_e = nominal + u, u' = rate max(d - u, 0): a dashpot in series with the wall.

    It is the steady creep of a Maxwell or Burgers body (W. N. Findley et al., Creep and Relaxation
    of Nonlinear Viscoelastic Materials, 1976, ch. 5); the viscosity of the dashpot is K_e / rate.
    """

    name = 'viscous_flow'
    equation = "x_e = nominal + u, u' = rate max(d - u, 0)"
    family = 'relaxation'
    description = 'The wall flows while it is pressed, and does not recover (dashpot in series).'
    Parameters = ViscousFlowParameters
    needs_touch = True

    states = 1  # u: how far the surface has receded

    def transmit(self, d: Number, v: Number, state: Any, m: Any) -> tuple[Any, Any, Any]:
        """Return the depth beneath the receded surface; see `ContactEffect.transmit`."""
        depth = d - state[0]
        return depth, v - self.values.rate * positive(depth, m), True

    def state_rates(
        self, t: float, d: float, v: float, contact: bool, state: tuple[float, ...]
    ) -> tuple[float, ...]:
        """Return u'; see `ContactEffect.state_rates`."""
        return (self.values.rate * max(d - state[0], 0.0),)

    def states_along(self, t: Array, d: Array, v: Array, contact: Flags) -> Array:
        """Solve the linear equation touch by touch, d straight between samples."""
        from scipy.signal import lfilter  # slow to import, and no node needs it

        step = self.values.rate * float(t[1] - t[0])
        decay = exp(-step)
        mean = (1.0 - decay) / step if step > 1e-9 else 1.0 - 0.5 * step
        push = (1.0 - mean) * d
        push[1:] += (mean - decay) * d[:-1]
        u, receded = np.zeros(len(t)), 0.0
        for first, stop in stretches(contact):
            while first < stop:
                touch = first + _first(d[first:stop] > receded)
                u[first:touch] = receded
                flow = lfilter([1.0], [1.0, -decay], push[touch:stop], zi=[decay * receded])[0]
                # A sample at least, or a release within one would never end.
                first = min(touch + max(1, _first(flow >= d[touch:stop])), stop)
                u[touch:first] = flow[:first - touch]
                receded = float(u[first - 1])
        return u[None, :]

    @classmethod
    def is_flexible(cls, values: Any, duration: float) -> bool:
        """Is one: whatever makes later contacts weaker fits."""
        return True

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """Start with a flow that takes a hundredth or all of the deflection away."""
        return [(0.01 / scales.duration,), (1.0 / scales.duration,)]

    @classmethod
    def largest(cls, scales: Scales) -> float:
        """Return the rate at which a touch of a second is half permanent."""
        return 0.5


def _first(flag: Flags) -> int:
    """Return the first index where a flag is set; the number of flags where none is."""
    return int(np.argmax(flag)) if flag.any() else len(flag)
