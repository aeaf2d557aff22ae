# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""From K_hat and B_hat as estimated to what an estimate publishes of the wall."""

from math import nan

from .lasting_error import LastingError
from .parameters import EstimationParameters, include_joint_compliance, remove_robot_compliance
from .surface import Surface
from .wall_law import ModelFitMonitor
from ..estimators.estimate import EstimateStatus, ParameterEstimate
from ..estimators.multiple_model import WallPosterior

_FREE, _FROZEN = EstimateStatus.FREE, EstimateStatus.FROZEN  # an enumeration takes long to look up
_LOST = ('the stiffness has no band: the last contact left open what it is, or parameters have '
         'changed since; touch down again')


class Publication:
    """
    Adds what widens, shifts or withholds the estimate: errors of the force, robot, checks.

    invalid: why no estimate is valid now, as told by the checks of the session; '' where it is
    model_fit: whether a law of the contact fits
    """

    def __init__(self, parameters: EstimationParameters, model_fit: ModelFitMonitor) -> None:
        self.invalid, self.model_fit, self._had_band = '', model_fit, False
        self.configure(parameters)

    def configure(self, parameters: EstimationParameters) -> None:
        """Set the robot whose compliance is removed."""
        self._robot = include_joint_compliance(parameters.robot, parameters.physics)
        self._first_guess = parameters.environment.initial_stiffness

    def begin(self, posterior: WallPosterior, surface: Surface) -> None:
        """Begin with a wall that is not known."""
        self._posterior, self._surface = posterior, surface
        self.lasting = LastingError(posterior.contact)

    def fields(
        self, own: ParameterEstimate, status: EstimateStatus, reason: str, shift: float = 0.0
    ) -> tuple[object, ...]:
        """
        Return the fields of an `Estimate` after the stamp.

        shift: how far known physics have moved the surface [m]
        """
        now = self._posterior.known
        if own[2] == own[2]:
            self._had_band = True
        elif status is not _FROZEN and (
                self._had_band and own[0] != self._first_guess
                or now.stiffness == now.stiffness and not now.valid):
            reason = f'{reason}; {_LOST}' if reason else _LOST
        own = self.lasting.widened(own)
        if self._robot.compliance or self._robot.compliance_std:
            own = remove_robot_compliance(own, self._robot)
        K, B, K_std, B_std, _, inertia = own
        if self.invalid:
            status, reason = _FREE if status is _FREE else _FROZEN, self.invalid
            K_std = B_std = nan
        surface = (now.surface if now.valid else self._surface.location) + shift
        return K, B, K_std, B_std, surface, inertia, status, reason, self.model_fit.now.ratio
