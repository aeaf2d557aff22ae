# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
Declaration of parameters: the dataclass field holds default, unit, range and meaning.

Groups of parameters are converted to dotted names and back, as ROS and parameter files use them.
"""

import dataclasses
import functools
import math
import re
from typing import Any, Iterator, Mapping, Sequence, TypeVar

from .exceptions import ParameterRangeError, ParameterReadOnlyError, UnknownNameError

Value = bool | int | float | str | tuple[float, ...]

_LARGE = 1e6  # from here on zeros are tedious to count


def number_text(number: float) -> str:
    """Return a number to six digits, its exponent as people write it: 1e6, not 1e+06."""
    return re.sub(r'e([+-])0*', lambda found: 'e' + found[1].strip('+'), f'{number:g}')


def value_text(value: Value) -> str:
    """Return the value of a parameter: true, [0.0, 0.0, 0.0], 1e10, NaN."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, tuple):
        return '[' + ', '.join(value_text(element) for element in value) + ']'
    if isinstance(value, float):
        if math.isnan(value):
            return 'NaN'
        short = number_text(value)
        if (abs(value) >= _LARGE or 'e' in repr(value)) and float(short) == value:
            return short
    return repr(value)


LARGEST = 1e15
"""Of any parameter in SI units: products of a few of them must not overflow."""

_LARGEST_OF_EFFECT = 1e150  # K_n of a cubic law in micrometres is beyond 1e15 N/m^3


@dataclasses.dataclass(frozen=True)
class ParameterSpecification:
    """Declaration of one parameter."""

    name: str  # dotted name, such as 'conditioning.cutoff_frequency'
    # value without configuration; its type is the parameter's type: a tuple is a vector
    default: Value
    description: str  # meaning, and the consequence of changing it
    unit: str = ''  # SI unit, '' or '1' where there is none
    # minimum, maximum: inclusive range, of each element of a vector
    minimum: float | None = None
    maximum: float | None = None
    # valid values of a string parameter; empty where any string is valid
    choices: tuple[str, ...] = ()
    read_only: bool = False  # whether the parameter is fixed at start
    nan_is_off: bool = False  # whether NaN is valid and switches the feature off
    neutral: float = 0.0  # value at which an effect vanishes
    linear: bool = False  # whether a law is linear in it, as it is in its first parameter
    logarithmic: bool = False  # whether it is searched on a logarithmic scale

    @property
    def valid_range(self) -> str:
        """Return the valid values without type and unit; empty where the type says everything."""
        if self.choices:
            return 'one of ' + ', '.join(self.choices)
        if self.minimum is not None and self.maximum is not None:
            return f'{number_text(self.minimum)} to {number_text(self.maximum)}'
        if self.minimum is not None:
            return f'at least {number_text(self.minimum)}'
        return '' if self.maximum is None else f'at most {number_text(self.maximum)}'

    @property
    def expectation(self) -> str:
        """Return the valid values as error messages state them."""
        if self.choices:
            return self.valid_range
        kind = {bool: 'true or false', int: 'an integer', float: 'a number', str: 'text',
                tuple: '3 numbers'}[type(self.default)]
        low = '' if self.minimum is None else f' >= {number_text(self.minimum)}'
        high = '' if self.maximum is None else f' <= {number_text(self.maximum)}'
        off = ' or NaN (off)' if self.nan_is_off else ''
        unit = '' if self.unit in ('', '1') else f' [{self.unit}]'
        return f'{kind}{low}{" and" if low and high else ""}{high}{unit}{off}'

    def check(self, value: Any) -> Value:
        """
        Return the value converted to the parameter's type, or raise if it is not valid.

        value: value received; integers are accepted for floats, and any sequence for a vector
        """
        if isinstance(self.default, tuple):
            return self._checked_vector(value)
        value = self._as_meant(value)
        if type(value) is not type(self.default):
            raise self._error(value)
        if self.choices and value not in self.choices:
            raise UnknownNameError.among(self.name, value, self.choices)
        if isinstance(value, (int, float)) and not isinstance(value, bool):
            self._check_range(value)
        return value  # type: ignore[no-any-return]

    def _checked_vector(self, values: Any) -> tuple[float, ...]:
        assert isinstance(self.default, tuple)
        given = values.tolist() if hasattr(values, 'tolist') else values  # of numpy, of rclpy
        element = dataclasses.replace(self, default=0.0)
        try:
            numbers = [element.check(value) for value in given if not isinstance(value, bool)]
        except (TypeError, ParameterRangeError) as error:
            raise self._error(given) from error
        if isinstance(given, str) or len(numbers) != len(self.default):
            raise self._error(given)
        return tuple(numbers)  # type: ignore[arg-type]

    def _as_meant(self, value: Any) -> Any:
        """Undo misreadings of YAML: PyYAML reads 1e5 as text, rcl reads y as true."""
        if isinstance(self.default, float) and type(value) in (int, str):
            try:
                return float(value)
            except (ValueError, OverflowError):
                return value
        return 'y' if value is True and 'y' in self.choices else value

    def _check_range(self, value: float) -> None:
        if self.nan_is_off and math.isnan(value):
            return
        too_low = self.minimum is not None and value < self.minimum
        too_high = self.maximum is not None and value > self.maximum
        if not math.isfinite(value) or too_low or too_high:
            raise self._error(value)
        largest = _LARGEST_OF_EFFECT if self.nan_is_off else LARGEST
        if self.maximum is None and abs(value) > largest:
            raise ParameterRangeError(
                f'{self.name} must be {self.expectation}, and at most {number_text(largest)} in '
                f'magnitude, got {value!r}: its square would overflow; default '
                + value_text(self.default))

    def _error(self, value: Any) -> ParameterRangeError:
        return ParameterRangeError(
            f'{self.name} must be {self.expectation}, got {value!r}; default '
            + value_text(self.default))


def parameter(
    default: Value, description: str, unit: str = '', minimum: float | None = None,
    maximum: float | None = None, choices: tuple[str, ...] = (), read_only: bool = False,
    nan_is_off: bool = False,
) -> Any:
    """
    Declare one parameter as a dataclass field.

    Returns field: to be assigned in the body of a `ParameterGroup`
    """
    facts = {
        'description': description,
        'unit': unit,
        'minimum': minimum,
        'maximum': maximum,
        'choices': choices,
        'read_only': read_only,
        'nan_is_off': nan_is_off,
    }
    return dataclasses.field(default=default, metadata=facts)


def optional_parameter(
    description: str, unit: str, minimum: float | None = None, maximum: float | None = None,
    **search: float | bool,
) -> Any:
    """
    Declare a number that is NaN by default, which switches its feature off.

    search: `neutral`, `linear` or `logarithmic` of `ParameterSpecification`
    Returns field: to be assigned in the body of a `ParameterGroup`
    """
    declared = parameter(math.nan, description, unit, minimum, maximum, nan_is_off=True)
    return dataclasses.field(default=math.nan, metadata={**declared.metadata, **search})


def group(cls: 'type[ParameterGroup]', description: str = '') -> Any:
    """Declare a nested group of parameters, with the defaults of its class, as a field."""
    return dataclasses.field(
        default_factory=cls, metadata={'group': cls, 'description': description})


@dataclasses.dataclass(frozen=True)
class ParameterGroup:
    """Base class of all parameter dataclasses; values are checked at construction."""

    def __post_init__(self) -> None:
        """Check types, ranges and choices of all fields."""
        for own in own_specifications(type(self)):
            object.__setattr__(self, own.name, own.check(getattr(self, own.name)))


Group = TypeVar('Group', bound=ParameterGroup)


def of_valid(cls: type[Group], values: Sequence[float]) -> Group:
    """Construct a group without checks, for a search that keeps to the ranges."""
    made = object.__new__(cls)
    made.__dict__.update(zip([own.name for own in own_specifications(cls)], values))
    return made


def own_specifications(cls: type[ParameterGroup]) -> tuple[ParameterSpecification, ...]:
    """List the parameters of a class without nested groups."""
    hashable: Any = cls  # mypy takes it for unhashable, as its instances may be
    return _own_specifications(hashable)


@functools.lru_cache(maxsize=None)  # fits construct many of each class
def _own_specifications(cls: type[ParameterGroup]) -> tuple[ParameterSpecification, ...]:
    return tuple(specification(field, field.name) for field in dataclasses.fields(cls)
                 if 'group' not in field.metadata)


def specification(field: dataclasses.Field[Any], name: str) -> ParameterSpecification:
    """Return the specification declared by a dataclass field."""
    return ParameterSpecification(name, field.default, **field.metadata)  # type: ignore[arg-type]


def specifications(
    cls: type[ParameterGroup], prefix: str = ''
) -> Iterator[ParameterSpecification]:
    """
    Iterate over all parameters of a group and of its nested groups.

    prefix: prefix of all names, including its dot
    """
    for field in dataclasses.fields(cls):
        name = prefix + field.name
        if 'group' in field.metadata:
            yield from specifications(field.metadata['group'], name + '.')
        else:
            yield specification(field, name)


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
                f'{changes[spec.name]!r}; set it in the parameter file and start again')
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
