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

"""Model files as command-line arguments."""

from __future__ import annotations

import dataclasses

from ..exceptions import ModelFileError
from ..parameters.file import read_parameter_file
from ..parameters.values import build, without
from ..plant.plant_parameters import PlantParameters
from ..ros.plant_node_parameters import PlantNodeParameters


def read_model(path: str, seed: int | None = None) -> PlantParameters:
    """
    Read a model file.

    Parameters
    ----------
    path : str
        Parameter file with a section plant_node.
    seed : int, optional
        Of all noise; the file's by default.

    Returns
    -------
    model : PlantParameters
        Parameters missing in the file have their defaults.

    Raises
    ------
    ModelFileError
        If the file is missing or has no such section.
    ContactEstimationError
        If a key is unknown or a value not valid.

    """
    values = read_parameter_file(path, 'plant_node')
    if not values:
        raise ModelFileError(
            f'model file {path} must have a section plant_node with ros__parameters, got none; '
            'see the README for an example'
        )
    model = build(PlantParameters, without(PlantNodeParameters, values))
    return model if seed is None else dataclasses.replace(model, seed=seed)
