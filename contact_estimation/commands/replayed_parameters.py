# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Parameters of a replay that the command line chooses over those of the recording."""

from __future__ import annotations

from typing import Any

from .command_line import chosen_parameters
from ..estimators import ONLINE_ESTIMATORS
from ..exceptions import UnknownNameError
from ..parameters.values import without
from ..ros.estimator_node_parameters import EstimatorNodeParameters


def replayed_parameters(options: Any) -> dict[str, Any]:
    """Return the parameters chosen with --params, --estimator, --axis and --joint."""
    chosen = without(EstimatorNodeParameters, chosen_parameters(options))
    if options.estimator:
        if options.estimator not in ONLINE_ESTIMATORS:
            raise UnknownNameError.among('estimator', options.estimator, ONLINE_ESTIMATORS)
        chosen['estimator'] = options.estimator
    for name in ('axis', 'joint'):
        if getattr(options, name) is not None:
            chosen[name] = getattr(options, name)
    return chosen
