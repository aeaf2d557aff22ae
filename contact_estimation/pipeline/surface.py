# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Where the surface is nominally, configured or taken at the first touch, and as found."""

from math import nan

from .checks.check import millimetres
from ..estimators.multiple_model import CONTACT, WallPosterior
from ..estimators.parameters import EnvironmentParameters
from ..physics.compensation import Compensation

_MARGIN = 3.0  # standard deviations of the surface, beyond which it is elsewhere
_LEAST_MARGIN = 1e-3  # [m]
_UNCHECKED = 0.05  # share of K_e that an uncertain surface leaves open


class Surface:
    """
    The nominal surface, from which depths count, and how far from it the posterior finds it.

    environment: `location` and `location_std` as configured
    compensation: of known physics, which may displace the wall
    location: x_e as configured, or as found at the first touch [m]; NaN before
    margin: how far from its location the surface may be [m]
    """

    def __init__(
        self, environment: EnvironmentParameters, posterior: WallPosterior,
        compensation: Compensation,
    ) -> None:
        self._configured, self._posterior = environment.location, posterior
        self.compensation = compensation
        self.location = environment.location
        self.margin = max(_MARGIN * environment.location_std, _LEAST_MARGIN)

    def locate(self, state: int) -> None:
        """Take the surface where the first touch is felt."""
        if state == CONTACT:
            known = self._posterior.known
            self.location = self.compensation.nominal(known.surface)
            if self.compensation.acts:  # else the posterior knows it better, for any law
                self._posterior.expect(self.location, known.surface_std)

    @property
    def shift(self) -> float:
        """Location of the surface found less the configured one [m]."""
        now = self._posterior.known
        found = now.surface - self._configured
        return found if now.valid and found == found else 0.0

    @property
    def std(self) -> float:
        """Return the standard deviation of the surface [m]."""
        return self._posterior.known.surface_std

    @property
    def is_shown(self) -> bool:
        """Whether contact has shown the surface well enough for the stiffness."""
        now = self._posterior.known
        return now.stiffness_std < _UNCHECKED * now.stiffness

    @property
    def found_offset(self) -> float:
        """Where contact has shown the surface, less where it is nominally [m]; else NaN."""
        return self._posterior.known.surface - self.location if self.is_shown else nan

    @property
    def text(self) -> str:
        """Where the surface is, if it is not where it is configured; '' where it is."""
        shift = self.shift
        if abs(shift) <= self.margin:
            return ''
        side, found = 'inside' if shift > 0.0 else 'outside', self._configured + shift
        return (f'the surface is at x = {found:.4g} m, {millimetres(abs(shift))} {side} the wall; '
                f'set environment.location to {found:.4g}, or to nan to take it at first touch')
