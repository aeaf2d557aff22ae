"""The estimators by name. To add one: a file here and a line in the dictionary."""

from __future__ import annotations

from dataclasses import make_dataclass

from ..parameters import ParameterGroup, group
from .estimator import OnlineEstimator
from .indirect_adaptive import IndirectAdaptive
from .kalman import Kalman
from .mrac import ModelReferenceAdaptive
from .rls import RecursiveLeastSquares

ESTIMATORS: dict[str, type[OnlineEstimator]] = {
    'indirect_adaptive': IndirectAdaptive,
    'rls': RecursiveLeastSquares,
    'mrac': ModelReferenceAdaptive,
    'kalman': Kalman,
}

EstimatorsTuning: type[ParameterGroup] = make_dataclass(
    'EstimatorsTuning',
    [(name, cls.Parameters, group(cls.Parameters)) for name, cls in ESTIMATORS.items()],
    bases=(ParameterGroup,),
    frozen=True,
)
EstimatorsTuning.__doc__ = 'The tuning of every estimator, each under its name.'
