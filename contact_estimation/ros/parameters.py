# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Parameters of a dataclass as ROS parameters."""

from array import array
from typing import Any, Callable, Iterable, Mapping

from rcl_interfaces.msg import (
    FloatingPointRange, IntegerRange, ParameterDescriptor, SetParametersResult)
from rclpy.node import Node
from rclpy.parameter import Parameter

from ..exceptions import ContactEstimationError, UnknownNameError
from ..parameters import LARGEST, ParameterSpecification

_OF_RCLPY = ('use_sim_time', 'qos_overrides.', 'start_type_description_service')
_LARGEST_INTEGER = 2**63 - 1


def declare(node: Node, known: Iterable[ParameterSpecification]) -> dict[str, Any]:
    """Declare parameters on a node, with the values of its parameter files."""
    specs = {spec.name: spec for spec in known}
    # rclpy offers no public way to see overrides that were not declared.
    overrides = getattr(node, '_parameter_overrides', {})
    for name in overrides:
        if name not in specs and not name.startswith(_OF_RCLPY):
            raise UnknownNameError.among(f'parameter of {node.get_name()}', name, specs)
    values = {}
    for name, spec in specs.items():
        given = _plain(overrides[name].value) if name in overrides else spec.default
        values[name] = spec.check(given)
        value = values[name]
        declared = list(value) if isinstance(value, tuple) else value
        node.declare_parameter(name, declared, descriptor(spec), ignore_override=True)
    return values


def descriptor(spec: ParameterSpecification) -> ParameterDescriptor:
    """Return the ROS descriptor of a parameter."""
    unit = f' [{spec.unit}]' if spec.unit else ''
    message = ParameterDescriptor(
        name=spec.name, description=spec.description + unit,
        additional_constraints=spec.expectation, read_only=spec.read_only)
    if spec.minimum is None or spec.nan_is_off:
        return message  # rclpy's own range check would refuse NaN
    if isinstance(spec.default, float):
        high = LARGEST if spec.maximum is None else spec.maximum  # as `check` accepts
        message.floating_point_range = [FloatingPointRange(from_value=spec.minimum, to_value=high)]
    elif type(spec.default) is int:
        high = _LARGEST_INTEGER if spec.maximum is None else int(spec.maximum)
        message.integer_range = [IntegerRange(from_value=int(spec.minimum), to_value=high)]
    return message


def serve_changes(
    node: Node, known: Iterable[ParameterSpecification],
    change: Callable[[Mapping[str, Any]], None],
) -> None:
    """Apply changes of ROS parameters at run time."""

    def on_set(parameters: list[Any]) -> SetParametersResult:
        changes = {p.name: _plain(p.value) for p in parameters if not p.name.startswith(_OF_RCLPY)}
        try:
            change(changes)
        except ContactEstimationError as error:
            return SetParametersResult(successful=False, reason=str(error))
        return SetParametersResult(successful=True)

    numbers = {spec.name for spec in known if isinstance(spec.default, (float, tuple))}
    node.add_pre_set_parameters_callback(
        lambda parameters: [_as_number(p) if p.name in numbers else p for p in parameters])
    node.add_on_set_parameters_callback(on_set)


def _plain(value: Any) -> Any:
    """Turn the array that rclpy makes of a list into a list."""
    return value.tolist() if isinstance(value, array) else value


def _as_number(parameter: Parameter) -> Parameter:
    """
    Convert 500, '1e-06', 'nan' and [0, 0, 1] to floating-point numbers.

    `ros2 param set NAME 500` sends an integer, and `ros2 param load` sends what `ros2 param dump`
    has written as 1e-06 or nan as text.
    """
    value = parameter.value
    if parameter.type_ == Parameter.Type.INTEGER_ARRAY:  # [0, 0, 1] of a parameter file
        return Parameter(parameter.name, Parameter.Type.DOUBLE_ARRAY, [float(v) for v in value])
    if isinstance(value, (int, str)) and not isinstance(value, bool):
        try:
            return Parameter(parameter.name, Parameter.Type.DOUBLE, float(value))
        except ValueError:
            pass
    return parameter
