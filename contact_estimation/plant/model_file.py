# Copyright 2026 contact_estimation authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

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
