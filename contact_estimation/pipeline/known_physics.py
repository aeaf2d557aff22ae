# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""What the posterior of the wall sees of a sample from which known physics are taken."""

from math import nan

from .parameters import EstimationParameters
from ..estimators.multiple_model import CONTACT, WallPosterior
from ..physics import effects_that_are_on
from ..physics.compensation import CLIPPED, Compensation
from ..signals.contact_sample import CompensatedSample

_RELEASED = 'the wall has let go, and the sensor follows'


def compensation_of(p: EstimationParameters) -> Compensation:
    """Return what compensates the physics that are on, from the next sample."""
    return Compensation(effects_that_are_on(p.physics), p.environment.initial_stiffness,
                        p.contact.force_noise, p.sample_rate)


class KnownPhysics:
    """
    Let the posterior judge compensated samples, until the wall lets go.

    A wall cannot pull; a sensor that lags still feels it when it has let go.
    """

    def __init__(self, posterior: WallPosterior, compensation: Compensation) -> None:
        self._posterior, self._lags, self._late = posterior, compensation.lags, compensation.late
        self._inside, self._let_go, self._x = False, False, nan

    def take(
        self, t: float, dt: float, x: float, v: float, known: CompensatedSample, location: float
    ) -> tuple[int, float, CompensatedSample]:
        """
        Process a sample.

        t, dt: stamp, and time since the last sample [s]
        x, v: position [m], and its measured rate, NaN without [m/s]
        known: what the compensation leaves of it
        location: x_e nominal [m]; NaN where it is not known
        Returns state, shift: of the contact; how far known physics have moved the surface [m]
        Returns known: with a hindrance where the wall has let go
        """
        shift = x - location - known.depth if known.depth == known.depth else 0.0
        if self._lags:
            known = self._until_released(dt, x, v, known)
        contact = self._posterior.contact
        if known.hindrance is CLIPPED and contact.state == CONTACT:
            return CONTACT, shift, known  # a constant force would pass for that of no wall
        where, bent = x - shift, (0.0, 0.0)
        if location == location:
            path = location + known.stiffness_column  # on which K_e acts
            bent = known.travel - known.stiffness_column, known.constant_column - 1.0
        else:
            path = where = self._late(t, dt, x)  # as the force comes
        # Without a force the known physics that are taken out would pass for one.
        usable = not known.hindrance and contact.exceeds_noise(known.pressing)
        rest = known.rest + known.inertial_force  # the posterior has a less noisy acceleration
        state = self._posterior.take(
            t, rest, path, known.velocity, usable, (known.pressing, where), bent)
        return state, shift, known

    def _until_released(
        self, dt: float, x: float, v: float, known: CompensatedSample
    ) -> CompensatedSample:
        """Note where the wall, as it is known, would have to pull."""
        inside, now = known.depth > 0.0, self._posterior.known
        if inside and not self._inside:
            self._let_go = False
        elif inside and now.valid:
            rate = v if v == v else (x - self._x) / dt if dt > 0.0 else 0.0
            self._let_go |= now.stiffness * known.depth + now.damping * rate < 0.0
        self._inside, self._x = inside, x
        if self._let_go and not known.hindrance:
            return known._replace(hindrance=_RELEASED)
        return known
