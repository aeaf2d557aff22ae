# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
A permanently attached wall that moves under the measured force.

A free run accumulates the force noise over the memory of the dynamics, which is infinite for a
drive without a spring. The innovations are those of the Kalman filter that weighs force and
position by their noise; for a force without noise they are the misfit of the free run.
"""

from math import exp, isfinite

import numpy as np
from scipy.signal import lfilter

from .model import Model
from .observed import Observed
from .observer import coast, innovation_std, innovations_under, kalman_filter, run, run_velocity
from ...physics.numeric import Array, discretise
from ...plant.driven_wall import NOISE, smooth

_WITHIN = np.linspace(-0.5, 0.5, 9)  # of a sample, within which a force may jump
_SLOW = 10.0  # widths of the smooth sign, beyond which it does not bend drag
_FARTHEST = 3.0  # times the largest force that the motion shows
_CONVERGED = 1e-9  # change of the motion by a round, of the largest position


class DrivenWall:
    """
    The wall of a model under the force of a recording.

    M_e x'' + B_e v + K_e delta = -F_e - effects is solved exactly for the line nearest to the
    restoring force over the measured motion. The difference of the effects from that line is
    evaluated at the measured motion, then at the motion just predicted (Picard's iteration), which
    makes the prediction a free run. Its initial state fits the first half second best.

    """

    def __init__(self, model: Model, observed: Observed) -> None:
        laws, o = model.laws(), observed
        self._observed, self._law = observed, laws.contact
        self._push, self._slow = -o.driving, _SLOW * model.nominal.sign_velocity
        for effect in reversed(laws.chain):
            self._push = -effect.undo_along(o.t, -self._push)
        self._mass = laws.contact.inertia + sum(effect.added_mass for effect in laws.chain)
        self._damping, self._stiffness = model.damping, model.stiffness
        self._at_measured = self._restoring(o.x, o.v, o.a)
        if laws.contact.effects:
            self._damping, self._stiffness = self._nearest_line()
        self.system = discretise(self._mass, self._damping, self._stiffness, o.h)

    def _restoring(self, x: Array, v: Array, a: Array) -> Array:
        law = self._law
        return -law.force(self._observed.t, x, v, a) - law.inertia * a

    def _nearest_line(self) -> tuple[float, float]:
        """Fit B v + K x + constant to the restoring force; keep both above 0."""
        # A wall far stiffer than what was measured would hold the prediction at the measurement.
        most = _FARTHEST * (np.max(np.abs(self._push))
                            + self._mass * np.max(np.abs(self._observed.a)))
        restoring = np.clip(self._at_measured, -most, most)
        damping, stiffness = (self._observed.nearest_line @ restoring).tolist()
        if not isfinite(damping + stiffness):
            return self._damping, self._stiffness
        return max(damping, 0.0), max(stiffness, 0.0)

    def free(self, rounds: int) -> Array:
        """Predict the motion with the effects at the predicted motion (Picard's iteration)."""
        o, free = self._observed, coast(self.system, len(self._observed.t))
        x, v, a, restoring = o.x, o.v, o.a, self._at_measured
        for left in range(rounds if self._law.effects else 1, 0, -1):
            push = self._push_of(restoring, x, v, a)
            before, x = x, run(self.system, push, float(o.x[0]), self._stiffness)
            v = run_velocity(self.system, push, float(o.x[0]), self._stiffness)
            if not np.isfinite(x).all():
                break
            begin = o.start
            misfit = (o.raw_position - x)[begin]
            x, v = np.array([x, v]) + np.tensordot(
                np.linalg.lstsq(free[:, 0, begin].T, misfit, rcond=1e-6)[0], free, 1)
            if float(np.max(np.abs(x - before))) < _CONVERGED * float(np.max(np.abs(x))):
                break
            if left > 1:
                a = (push - self._damping * v - self._stiffness * x) / self._mass
                restoring = self._restoring(x, v, a)
        return np.array([x, v])

    def _push_of(self, restoring: Array, x: Array, v: Array, a: Array) -> Array:
        """Return the force on the line: the input less the wall's deviation from the line."""
        beyond = restoring - self._damping * v - self._stiffness * x
        push = self._push
        for effect in self._law.effects:
            if effect.jumps:  # within the sample in which the motion turns
                at_once = effect.resistance(0.0, 0.0, v, (), np)
                beyond, jumping = beyond - at_once, at_once.copy()
                turns = np.abs(v) < 0.5 * self._observed.h * np.abs(a) + self._slow
                rates = v[turns] + np.multiply.outer(_WITHIN * self._observed.h, a[turns])
                jumping[turns] = np.mean(effect.resistance(0.0, 0.0, rates, (), np), axis=0)
                push = push - jumping
        return push - smooth(beyond)

    def innovations(
        self, rounds: int, force_noise: float, memory: float = np.inf, widening: float = 1.0
    ) -> Array:
        """Compute the one-step prediction errors of the position."""
        o = self._observed
        if memory < np.inf:
            denominator = np.asarray(np.poly([exp(-o.h / memory)] * 2), float)
        else:
            denominator = self._filter(widening * force_noise)[0]
        if rounds > 1:
            misfit = o.raw_position - self.free(rounds)[0]
            return np.asarray(lfilter(self.system.denominator, denominator, misfit))
        push = self._push_of(self._at_measured, o.x, o.v, o.a)
        return innovations_under(
            push, o.raw_position, float(o.x[0]), self.system, denominator, self._stiffness)

    def kalman_filter(
        self, force_noise: float, widening: float = 1.0, block: int = 1
    ) -> tuple[Array, float]:
        """Design the filter that weighs force and position by their noise."""
        c, std = self._filter(widening * force_noise)
        if widening > 1.0:
            o = self._observed
            std = innovation_std(
                self.system, c, force_noise, o.position_noise, NOISE[o.between], block)
        return c, std

    def _filter(self, force_noise: float) -> tuple[Array, float]:
        o = self._observed
        return kalman_filter(self.system, force_noise, o.position_noise, NOISE[o.between])
