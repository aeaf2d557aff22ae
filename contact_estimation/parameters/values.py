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

"""Parameters by their dotted names, as ROS, parameter files and recordings hold them."""

from __future__ import annotations

import dataclasses
from typing import Any, Mapping, TypeVar

from .specification import ParameterGroup, specifications, Value
from ..exceptions import ParameterReadOnlyError, UnknownNameError

Group = TypeVar('Group', bound=ParameterGroup)


def flatten(values: ParameterGroup, prefix: str = '') -> dict[str, Value]:
    """
    List a group's values by their dotted names.

    Parameters
    ----------
    values : ParameterGroup
        The group.
    prefix : str
        Put before every name, with its dot.

    Returns
    -------
    flat : dict
        Dotted name to value, in the order of declaration.

    """
    flat: dict[str, Value] = {}
    for field in dataclasses.fields(values):
        value = getattr(values, field.name)
        if 'group' in field.metadata:
            flat.update(flatten(value, prefix + field.name + '.'))
        else:
            flat[prefix + field.name] = value
    return flat


def flatten_mapping(nested: Mapping[str, Any], prefix: str = '') -> dict[str, Any]:
    """
    Turn nested mappings, as a YAML file holds them, into dotted names.

    Parameters
    ----------
    nested : mapping
        Names to values or to further mappings.
    prefix : str
        Put before every name, with its dot.

    Returns
    -------
    flat : dict
        Dotted name to value.

    """
    flat: dict[str, Any] = {}
    for key, value in nested.items():
        if isinstance(value, Mapping):
            flat.update(flatten_mapping(value, f'{prefix}{key}.'))
        else:
            flat[f'{prefix}{key}'] = value
    return flat


def build(cls: type[Group], flat: Mapping[str, Any]) -> Group:
    """
    Make a group from dotted names; what is missing takes its default.

    Parameters
    ----------
    cls : type of ParameterGroup
        The group's class.
    flat : mapping
        Dotted name to value.

    Returns
    -------
    values : ParameterGroup
        An instance of `cls`.

    Raises
    ------
    UnknownNameError
        If a name is no parameter of the group; it names the nearest.
    ParameterRangeError
        If a value is out of range.

    """
    known = {spec.name: spec for spec in specifications(cls)}
    for name in flat:
        if name not in known:
            raise UnknownNameError.among('parameter', name, known)
    return _build(cls, {name: known[name].check(value) for name, value in flat.items()}, '')


def _build(cls: type[Group], flat: Mapping[str, Any], prefix: str) -> Group:
    arguments: dict[str, Any] = {}
    for field in dataclasses.fields(cls):
        name = prefix + field.name
        if 'group' in field.metadata:
            arguments[field.name] = _build(field.metadata['group'], flat, name + '.')
        elif name in flat:
            arguments[field.name] = flat[name]
    return cls(**arguments)


def changed(values: Group, changes: Mapping[str, Any]) -> Group:
    """
    Return the group with some values changed.

    Parameters
    ----------
    values : ParameterGroup
        The present values.
    changes : mapping
        Dotted name to new value.

    Returns
    -------
    values : ParameterGroup
        A new group.

    Raises
    ------
    ParameterReadOnlyError
        If a parameter that is fixed at start would change.
    UnknownNameError, ParameterRangeError
        As `build`.

    """
    flat = flatten(values)
    for spec in specifications(type(values)):
        if spec.read_only and spec.name in changes and changes[spec.name] != flat[spec.name]:
            raise ParameterReadOnlyError(
                f'{spec.name} is fixed at start ({flat[spec.name]!r}), got '
                f'{changes[spec.name]!r}; set it in the parameter file and start again'
            )
    return build(type(values), {**flat, **changes})


def without(cls: type[ParameterGroup], values: Mapping[str, Any]) -> dict[str, Any]:
    """
    Leave out the parameters of a group.

    Parameters
    ----------
    cls : type of ParameterGroup
        The group.
    values : mapping
        Dotted name to value, of several groups.

    Returns
    -------
    rest : dict
        What is of other groups, or of none.

    """
    own = {spec.name for spec in specifications(cls)}
    return {name: value for name, value in values.items() if name not in own}


def divided(
    cls: type[ParameterGroup], values: Mapping[str, Any]
) -> tuple[dict[str, Any], dict[str, Any]]:
    """
    Tell the parameters of a group from the others.

    Parameters
    ----------
    cls : type of ParameterGroup
        The group.
    values : mapping
        Dotted name to value, of several groups.

    Returns
    -------
    others, own : dict
        What is not, and what is of the group.

    """
    others = without(cls, values)
    return others, {name: value for name, value in values.items() if name not in others}
