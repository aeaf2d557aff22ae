# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""A parameter file with every parameter at a value, each commented from its specification."""

from __future__ import annotations

import dataclasses
from textwrap import wrap
from typing import Iterator, Sequence

import yaml

from .specification import ParameterGroup, ParameterSpecification, specification

_WIDTH = 99
_INDENT = '  '


def parameter_file(node: str, title: str, groups: Sequence[ParameterGroup]) -> str:
    """Write a ROS 2 parameter file."""
    lines = [*_comment(title, ''), f'{node}:', f'{_INDENT}ros__parameters:']
    for values in groups:
        lines += _group_lines(values, 2 * _INDENT)
    return '\n'.join(lines) + '\n'


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
