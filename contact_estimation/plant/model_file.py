# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Model files: parameter files of the plant node."""

from __future__ import annotations

from dataclasses import replace
from os import PathLike
from pathlib import Path

from .plant_node_parameters import PlantNodeParameters
from .plant_parameters import PlantParameters
from ..exceptions import ModelFileError
from ..parameters.file import read_parameter_file
from ..parameters.values import build, without


def read_model(path: str | PathLike[str], seed: int | None = None) -> PlantParameters:
    """
    Read a model file: the section `plant_node` of a ROS 2 parameter file.

    Parameters
    ----------
    path : str or path-like
        YAML file; a missing key has its default.
    seed : int, optional
        Seed of all noise, >= 0; default: the seed of the file.

    Returns
    -------
    model : PlantParameters
        Environment, robot, sensors and physics.

    Raises
    ------
    ModelFileError
        If the file is missing or has no section `plant_node`.
    ContactEstimationError
        If a key is unknown or a value is out of range.

    """
    values = read_parameter_file(Path(path), 'plant_node')
    if not values:
        raise ModelFileError(
            f'model file {path} must have a section plant_node with ros__parameters, got none; '
            'see config/plant_node.yaml for an example'
        )
    model = build(PlantParameters, without(PlantNodeParameters, values))
    return model if seed is None else replace(model, seed=seed)
