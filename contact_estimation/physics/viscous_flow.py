# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from math import exp

import numpy as np

from .law import (
    Any, Array, ContactEffect, dataclass, Flags, Need, Number, optional_parameter, positive, Prior,
    Scales, Seen, State, stretches)


@dataclass(frozen=True)
class ViscousFlow(ContactEffect):
    """
    The wall flows while it is pressed, and does not recover (dashpot in series).

    It is the steady creep of a Maxwell or Burgers body (W. N. Findley et al., Creep and Relaxation
    of Nonlinear Viscoelastic Materials, 1976, ch. 5); the viscosity of the dashpot is K_e / rate.
    """

    rate: float = optional_parameter(
        'Share of the deflection that becomes permanent per second', '1/s',
        minimum=0.0, maximum=1000.0)

    equation = "x_e = nominal + u, u' = rate max(d - u, 0)"
    family = 'relaxation'
    needs = frozenset({Need.TOUCH})
    states = 1  # u: how far the surface has receded

    def transmit(self, d: Number, v: Number, state: Any, m: Any) -> tuple[Any, Any, Any]:
        depth = d - state[0]
        return depth, v - self.rate * positive(depth, m), True

    def state_rates(self, t: float, d: float, v: float, contact: bool, state: State) -> State:
        return (self.rate * max(d - state[0], 0.0),)

    def states_along(self, t: Array, d: Array, v: Array, contact: Flags) -> Array:
        """Solve the linear equation touch by touch, d straight between samples."""
        from scipy.signal import lfilter  # slow to import, and no node needs it

        step = self.rate * float(t[1] - t[0])
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

    def is_flexible(self, seen: Seen) -> bool:
        """Is one: whatever makes later contacts weaker fits."""
        return True

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        # A hundredth, or all, of the deflection goes; at most half of it within a second.
        return Prior([(0.01 / scales.duration,), (1.0 / scales.duration,)], largest=0.5)


def _first(flag: Flags) -> int:
    """Return the first index where a flag is set; the number of flags where none is."""
    return int(np.argmax(flag)) if flag.any() else len(flag)
