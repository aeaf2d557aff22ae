# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Reading of ROS 2 parameter files without ROS."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Mapping

from .values import flatten_mapping
from ..exceptions import ModelFileError, UnknownNameError
from ..texts import yaml_file

ANY_NODE = '/**'
KNOWN_NODES = ('estimator_node', 'plant_node', 'recorder_node')


def read_parameter_file(path: Path | str, node: str) -> dict[str, Any]:
    """Read the parameters of one node."""
    content = _load(Path(path))
    for section in content:
        if str(section).strip('/') not in KNOWN_NODES and section != ANY_NODE:
            raise UnknownNameError.among(
                f'node in parameter file {path}', section, (*KNOWN_NODES, ANY_NODE)
            )
    parameters: dict[str, Any] = {}
    for section in (ANY_NODE, node, f'/{node}'):
        if section in content:
            parameters.update(_section(content[section], path, section))
    return parameters


def _load(path: Path) -> Mapping[str, Any]:
    try:
        content = yaml_file(path)
    except (OSError, ValueError) as error:
        reason = getattr(error, 'strerror', None) or error
        raise ModelFileError(f'parameter file {path} cannot be read: {reason}') from error
    if not isinstance(content, Mapping):
        raise ModelFileError(
            f'parameter file {path} must hold `NODE: {{ros__parameters: ...}}`, got '
            f'{type(content).__name__}'
        )
    return content


def _section(content: Any, path: Path | str, section: str) -> dict[str, Any]:
    inner = content.get('ros__parameters') if isinstance(content, Mapping) else None
    if not isinstance(inner, Mapping):
        raise ModelFileError(
            f'section {section!r} of parameter file {path} must hold `ros__parameters` with a '
            f'mapping, got {content!r}'
        )
    return flatten_mapping(inner)
