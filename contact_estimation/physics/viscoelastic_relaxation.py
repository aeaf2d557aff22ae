# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from math import exp, expm1

import numpy as np

from .law import (
    Any, Array, ContactEffect, dataclass, Flags, Need, Number, optional_parameter, Prior, Scales,
    Seen, State, stretches)

REPELS = 0.1
"""Share of a branch by which the spring beside it may repel, by the error of a fit."""


@dataclass(frozen=True)
class ViscoelasticRelaxation(ContactEffect):
    """
    The force relaxes while the depth is held (Maxwell branch).

    Out of contact s' = -s / tau: after a release the surface, at d = -s / K_e, comes back slowly,
    as each branch of `fractional_relaxation` does. The integrated states are s, and time and
    displacement since the last step, with which `settle` advances s exactly along a straight line:
    a tau far below the step is no trouble.
    """

    K_1: float = optional_parameter('Stiffness of the relaxing branch', 'N/m', minimum=0.0)
    tau: float = optional_parameter('Relaxation time constant', 's', minimum=0.0001)

    equation = "F_e -= s, s' = K_1 v - s / tau"
    family = 'relaxation'
    relaxes = True
    needs = frozenset({Need.SPRING})  # what moves freely hangs on nothing that relaxes
    states = 3

    def resistance(self, t: Number, d: Number, v: Number, state: Any, m: Any) -> Number:
        return state[0] if m is np else self._after(*state)

    def _after(self, s: float, elapsed: float, moved: float) -> float:
        """Return s a time and a displacement later."""
        if elapsed <= 0.0:
            return s
        periods = elapsed / self.tau
        return exp(-periods) * s - self.K_1 * expm1(-periods) / periods * moved

    def state_rates(self, t: float, d: float, v: float, contact: bool, state: State) -> State:
        return 0.0, 1.0, v if contact else 0.0

    def settle(self, d: float, v: float, contact: bool, state: State) -> State:
        """Advance s by the time and displacement since the last step."""
        return self._after(*state), 0.0, 0.0

    def states_along(self, t: Array, d: Array, v: Array, contact: Flags) -> Array:
        """Solve the linear equation stretch by stretch, v straight between samples."""
        from scipy.signal import lfilter  # slow to import, and no node needs it

        h = float(t[1] - t[0])
        tau, K_1 = self.tau, self.K_1
        decay = exp(-h / tau)
        begin, end = tau / h * (1.0 - decay) - decay, 1.0 - tau / h * (1.0 - decay)
        push = K_1 * tau * end * v
        push[1:] += K_1 * tau * begin * v[:-1]
        s, last = np.empty(len(t)), 0.0
        # Touch-down and release lie between two samples: the tool moves by d since, or until then.
        across = K_1 * np.minimum(np.abs(d), h * np.abs(v))
        for first, stop in stretches(contact):
            if contact[first]:
                steps = np.concatenate(([across[first] if first else 0.0], push[first + 1:stop]))
                s[first:stop] = lfilter([1.0], [1.0, -decay], steps, zi=[decay * last])[0]
            else:
                last -= across[first - 1] if first else 0.0
                s[first:stop] = last * decay ** np.arange(1, stop - first + 1)
            last = float(s[stop - 1])
        return s[None, :]

    def is_possible(self, stiffness: float, damping: float) -> bool:
        return stiffness >= -REPELS * self.K_1

    def is_flexible(self, seen: Seen) -> bool:
        return self.tau > seen.duration

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        # With a small K_1 tau would not matter.
        return Prior([(0.3 * scales.spring, tau) for tau in scales.time_constants()],
                     largest=2.0 * scales.stiffness)
