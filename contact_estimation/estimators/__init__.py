# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The estimators by name. To add one: a file here and a line in the dictionary."""

from dataclasses import make_dataclass
from typing import Callable

from .estimator import OnlineEstimator
from .hunt_crossley import HuntCrossley
from .indirect_adaptive import IndirectAdaptive
from .instrumental_variable import InstrumentalVariable
from .kalman import Kalman
from .mrac import ModelReferenceAdaptive
from .offline_estimator import OfflineEstimator, TargetImpedance
from .rls import RecursiveLeastSquares
from .rls_adaptive import AdaptiveLeastSquares
from .signal_processing import SignalProcessing
from .signal_processing_refined import SignalProcessingRefined
from .stiffness_matrix import StiffnessMatrix
from ..parameters import group, ParameterGroup

ESTIMATORS: dict[str, type[OnlineEstimator]] = {
    'indirect_adaptive': IndirectAdaptive,
    'rls': RecursiveLeastSquares,
    'mrac': ModelReferenceAdaptive,
    'kalman': Kalman,
    'instrumental_variable': InstrumentalVariable,
    'hunt_crossley': HuntCrossley,
    'rls_adaptive': AdaptiveLeastSquares,
}

MULTIPLE_MODEL = 'multiple_model'
"""The posterior over laws, surfaces and changes, which finds the contact for all estimators."""

ONLINE_ESTIMATORS = (MULTIPLE_MODEL, *ESTIMATORS)
"""Names of all that node and replay run, the default first."""

OFFLINE_ESTIMATORS: dict[str, Callable[[TargetImpedance], OfflineEstimator]] = {
    'signal_processing': SignalProcessing,
    'signal_processing_refined': SignalProcessingRefined,
}
"""Need the whole recording, and the force alone; the node refuses them."""

MATRIX_ESTIMATORS: dict[str, type[StiffnessMatrix]] = {'stiffness_matrix': StiffnessMatrix}
"""Of the full matrices of three axes, beside the estimator of the single axes."""

EstimatorsTuning: type[ParameterGroup] = make_dataclass(
    'EstimatorsTuning',
    [(name, cls.Parameters, group(cls.Parameters)) for name, cls in ESTIMATORS.items()],
    bases=(ParameterGroup,), frozen=True)
EstimatorsTuning.__doc__ = 'The tuning of every estimator, each under its name.'
