# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0


"""The corrected model as a parameter file."""

from __future__ import annotations

from typing import Any

import yaml

from ..conclude.result import Diagnosis
from ..fit.free_run import plant_of
from ...parameters.values import flatten
from ...plant.plant_parameters import PlantParameters


def model_file(diagnosis: Diagnosis) -> str:
    """Return the corrected model as a parameter file for plant and estimator."""
    plant = plant_of(diagnosis.corrected)
    default = dict(flatten(PlantParameters()))
    given = dict(flatten(diagnosis.nominal.nominal))
    changed = {
        name: value for name, value in flatten(plant).items()
        if name.startswith(('environment.', 'robot.'))
        or (value == value and (value != default[name] or value != given[name]))
    }
    physics = {name: value for name, value in changed.items() if name.startswith('physics.')}
    estimator = {
        'environment.location': changed['environment.location'],
        **physics,
    }
    nodes = {
        'plant_node': {'ros__parameters': _nested(changed)},
        'estimator_node': {'ros__parameters': _nested(estimator)},
    }
    return str(yaml.safe_dump(nodes, sort_keys=False, default_flow_style=False))


def _nested(values: dict[str, Any]) -> dict[str, Any]:
    tree: dict[str, Any] = {}
    for name, value in values.items():
        *groups, last = name.split('.')
        branch = tree
        for group in groups:
            branch = branch.setdefault(group, {})
        branch[last] = float(f'{value:.10g}') if isinstance(value, float) else value
    return tree
