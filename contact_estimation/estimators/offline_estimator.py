# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Estimators that need the whole of a recording."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

from ..parameters import parameter, ParameterGroup
from ..signals.contact_sample import ContactRecording


class OfflineEstimate(NamedTuple):
    """
    The environment as estimated from a recording.

    Attributes
    ----------
    stiffness, damping : float
        K_hat [N/m] and B_hat [N s/m].
    stiffness_std, damping_std : float
        Their standard deviations; NaN where the method has none.

    """

    stiffness: float
    damping: float
    stiffness_std: float
    damping_std: float


@dataclass(frozen=True)
class TargetImpedance(ParameterGroup):
    """The impedance of the robot in contact, known to methods that use the force alone."""

    mass: float = parameter(20.0, 'M_t', 'kg', minimum=1e-6)
    damping: float = parameter(50.0, 'B_t', 'N s/m', minimum=0.0)
    stiffness: float = parameter(2000.0, 'K_t', 'N/m', minimum=0.0)


class OfflineEstimator(ABC):
    """Base of the estimators that run on recordings only; the node refuses them."""

    name: ClassVar[str]

    @abstractmethod
    def estimate(self, recording: ContactRecording) -> OfflineEstimate:
        """
        Estimate from a recording.

        Parameters
        ----------
        recording : ContactRecording
            All samples.

        Returns
        -------
        estimate : OfflineEstimate
            K_hat and B_hat.

        Raises
        ------
        EstimationError
            If the recording lacks the response that the method needs.

        """
