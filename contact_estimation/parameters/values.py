# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Conversion between parameter groups and dotted names, as ROS and parameter files use."""

from __future__ import annotations

import dataclasses
from typing import Any, Mapping, TypeVar

from .specification import ParameterGroup, specifications, Value
from ..exceptions import ParameterReadOnlyError, UnknownNameError

Group = TypeVar('Group', bound=ParameterGroup)


def flatten(values: ParameterGroup, prefix: str = '') -> dict[str, Value]:
    """Return the values of a group by dotted names that begin with a prefix, in order."""
    flat: dict[str, Value] = {}
    for field in dataclasses.fields(values):
        value = getattr(values, field.name)
        if 'group' in field.metadata:
            flat.update(flatten(value, prefix + field.name + '.'))
        else:
            flat[prefix + field.name] = value
    return flat


def flatten_mapping(nested: Mapping[str, Any], prefix: str = '') -> dict[str, Any]:
    """Flatten nested mappings, as read from YAML, to names that begin with a prefix."""
    flat: dict[str, Any] = {}
    for key, value in nested.items():
        if isinstance(value, Mapping):
            flat.update(flatten_mapping(value, f'{prefix}{key}.'))
        else:
            flat[f'{prefix}{key}'] = value
    return flat


def build(cls: type[Group], flat: Mapping[str, Any]) -> Group:
    """Build a group from dotted names; missing parameters take their default."""
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
    """Return the group with some values changed."""
    flat = flatten(values)
    for spec in specifications(type(values)):
        if not spec.read_only or spec.name not in changes:
            continue
        if spec.check(changes[spec.name]) != flat[spec.name]:
            raise ParameterReadOnlyError(
                f'{spec.name} is fixed at start ({flat[spec.name]!r}), got '
                f'{changes[spec.name]!r}; set it in the parameter file and start again'
            )
    return build(type(values), {**flat, **changes})


def without(cls: type[ParameterGroup], values: Mapping[str, Any]) -> dict[str, Any]:
    """Return values by dotted names without those of a group."""
    own = {spec.name for spec in specifications(cls)}
    return {name: value for name, value in values.items() if name not in own}


def divided(
    cls: type[ParameterGroup], values: Mapping[str, Any]
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Split values by dotted names into those of other groups and those of one group."""
    others = without(cls, values)
    return others, {name: value for name, value in values.items() if name not in others}
