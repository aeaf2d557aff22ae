# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""ROS 2 parameter files without ROS: written with comments, and read."""

import dataclasses
from pathlib import Path
from textwrap import wrap
from typing import Any, Iterator, Mapping, Sequence

import yaml

from .exceptions import ModelFileError, UnknownNameError
from .parameters import flatten_mapping, ParameterGroup, ParameterSpecification, specification
from .texts import yaml_file

_WIDTH = 99
_INDENT = '  '


def parameter_file(node: str, title: str, groups: Sequence[ParameterGroup]) -> str:
    """Write a ROS 2 parameter file."""
    lines = [*_comment(title, ''), f'{node}:', f'{_INDENT}ros__parameters:']
    for values in groups:
        lines += _group_lines(values, 2 * _INDENT)
    return '\n'.join(lines) + '\n'


def parameter_sections(**nodes: Mapping[str, Any]) -> str:
    """Write parameters, nested or by dotted name, as those of nodes; `any_node` is every one."""
    return str(yaml.safe_dump(
        {ANY_NODE if node == 'any_node' else node: {'ros__parameters': dict(values)}
         for node, values in nodes.items()}, sort_keys=False))


def _group_lines(values: ParameterGroup, indent: str) -> Iterator[str]:
    for field in dataclasses.fields(values):
        value = getattr(values, field.name)
        if 'group' in field.metadata:
            yield from _comment(field.metadata['description'], indent)
            yield f'{indent}{field.name}:'
            yield from _group_lines(value, indent + _INDENT)
        else:
            yield from _comment(_explanation(specification(field, field.name)), indent)
            # rcl reads 1.0e-06 as a number but 1e-06 as text; PyYAML writes the former.
            plain = list(value) if isinstance(value, tuple) else value
            text = yaml.safe_dump(plain, default_flow_style=True).splitlines()[0]
            yield f'{indent}{field.name}: {text}'


def _explanation(spec: ParameterSpecification) -> str:
    unit = f' [{spec.unit}]' if spec.unit not in ('', '1') else ''
    fixed = 'fixed at start' if spec.read_only else ''
    return '; '.join(part for part in (spec.description + unit, spec.valid_range, fixed) if part)


def _comment(text: str, indent: str) -> list[str]:
    return wrap(text, _WIDTH, initial_indent=f'{indent}# ', subsequent_indent=f'{indent}# ',
                break_long_words=False, break_on_hyphens=False)


ANY_NODE = '/**'
KNOWN_NODES = ('estimator_node', 'plant_node', 'recorder_node')


def read_parameter_file(path: Path | str, node: str) -> dict[str, Any]:
    """Read the parameters of one node."""
    content = _load(Path(path))
    for section in content:
        if str(section).strip('/') not in KNOWN_NODES and section != ANY_NODE:
            raise UnknownNameError.among(
                f'node in parameter file {path}', section, (*KNOWN_NODES, ANY_NODE))
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
            f'{type(content).__name__}')
    return content


def _section(content: Any, path: Path | str, section: str) -> dict[str, Any]:
    inner = content.get('ros__parameters') if isinstance(content, Mapping) else None
    if not isinstance(inner, Mapping):
        raise ModelFileError(
            f'section {section!r} of parameter file {path} must hold `ros__parameters` with a '
            f'mapping, got {content!r}')
    return flatten_mapping(inner)
