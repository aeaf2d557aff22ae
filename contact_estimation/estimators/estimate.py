# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""What an estimator returns after each sample."""

from enum import Enum
from math import nan
from typing import NamedTuple


class EstimateStatus(str, Enum):
    """Whether the estimate was updated with a sample: out of contact, updated or frozen."""

    FREE = 'free'
    ESTIMATING = 'estimating'
    FROZEN = 'frozen'


class Estimate(NamedTuple):
    """
    The published estimate of the environment after one sample.

    Attributes
    ----------
    stamp_ns : int
        Stamp of the wrench used [ns].
    stiffness, damping : float
        K_hat [N/m] and B_hat [N s/m].
    stiffness_std, damping_std : float
        Their standard deviations; NaN before the first update of the parameter.
    location : float
        x_e: estimated where the estimator does so, else as configured [m].
    inertia : float
        M_hat [kg]; NaN where not estimated.
    status : EstimateStatus
        Free, estimating or frozen.
    reason : str
        Why the estimate is frozen, or which parameter is; '' otherwise.
    model_fit : float
        Rms of the residual over that of the noise in the last 2 s of contact; NaN while unknown.

    """

    stamp_ns: int
    stiffness: float
    damping: float
    stiffness_std: float
    damping_std: float
    location: float
    inertia: float
    status: EstimateStatus
    reason: str
    model_fit: float = nan


class ParameterEstimate(NamedTuple):
    """
    The parameters as estimated after one row; NaN for what is not estimated.

    Attributes
    ----------
    stiffness, damping : float
        K_hat [N/m], B_hat [N s/m].
    stiffness_std, damping_std : float
        Their standard deviations.
    location_shift : float
        Estimated x_e less the configured one [m]; 0 where not estimated.
    inertia : float
        M_hat [kg].

    """

    stiffness: float
    damping: float
    stiffness_std: float
    damping_std: float
    location_shift: float
    inertia: float


AxesEstimates = tuple[Estimate, ...]
"""Estimates of one sample, one for each axis, the contact axis first."""

new_tuple = tuple.__new__
"""Makes a named tuple from a tuple of its fields, in half the time of a call of its class."""


class Frozen(NamedTuple):
    """Parameters not updated for lack of excitation: consider parameters (Schmidt)."""

    stiffness: bool
    damping: bool
