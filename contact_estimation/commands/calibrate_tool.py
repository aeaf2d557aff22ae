# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Identify mass, centre of gravity and sensor biases of a tool from a recording in free flight."""

from typing import Any, Callable
from xml.etree import ElementTree

from scipy.spatial.transform import Rotation
import yaml

from .command_line import (
    add_reading_options, as_json, check_outputs, command, Parser, source_of, write_results)
from ..exceptions import (
    EstimationError, ModelFileError, ParameterRangeError, RecordingError, UnknownNameError)
from ..kinematics.calibration_recording import BLOCK_S, read_blocks, recorded_frame
from ..kinematics.description import read_description
from ..kinematics.parameters import AXES, ForceSensorParameters
from ..kinematics.robot_model import RobotModel
from ..kinematics.tool_calibration import calibrate_tool, ToolCalibration
from ..parameter_files import read_parameter_file
from ..parameters import specifications
from ..pipeline.arm_kinematics import hint_of_driver
from ..pipeline.recorded_arm import recorded_description
from ..recordings import RecordingReader
from ..recordings.source import canonical, RecordingSource


def make_parser() -> Parser:
    """Build the command line of `calibrate_tool`."""
    parser = Parser(
        prog='calibrate_tool',
        description='Identify the load of the tool on a force/torque sensor from a recording of '
        'wrench and joint states: at least 12 poses of the arm in free flight, each held for 2 s, '
        'that turn the sensor in all directions; or slow motion through them.')
    parser.add_argument('recording', metavar='RECORDING',
                        help='an .mcap file, a rosbag2 folder or a table (CSV, Parquet, MAT)')
    parser.add_argument('--robot-description', metavar='FILE',
                        help="URDF of the arm, with the sensor's frame (default: as recorded)")
    parser.add_argument('--params', metavar='FILE', help='ROS 2 parameter file of estimator_node: '
                        'force_sensor.frame (default: that of the wrench), force_sensor.rpy and '
                        'force_sign')
    parser.add_argument('--output', required=True, metavar='tool.yaml',
                        help='ROS 2 parameter file to write, for estimator_node and replay')
    parser.add_argument('--json', metavar='FILE',
                        help='write values and standard deviations as JSON')
    add_reading_options(parser)
    return parser


def run(options: Any) -> int:
    """Calibrate, write the parameter file and print the tool."""
    check_outputs((options.output, options.json), {
        'the recording': [options.recording], 'the parameter file': [options.params],
        'the robot description': [options.robot_description]})
    given = read_parameter_file(options.params, 'estimator_node') if options.params else {}
    source = source_of(options)
    reader = RecordingReader(options.recording, source)
    frame = str(given.get('force_sensor.frame') or recorded_frame(reader, source))
    if not frame:
        raise RecordingError(
            f'the wrenches of {options.recording} have no frame_id; name the frame of the sensor '
            'in --params as force_sensor.frame (UR drivers that leave it empty: tool0, with '
            'force_sensor.axes: base)')
    urdf, origin = _description(options, reader, source)
    try:
        model = RobotModel(urdf, _root(urdf, origin), frame)
    except UnknownNameError as error:
        raise UnknownNameError(f'{error}{hint_of_driver(frame)}') from error
    sign = _force_sign(given)
    axes, base = (str(given.get(name) or default) for name, default in (
        ('force_sensor.axes', AXES[0]), ('kinematics.base', model.base)))
    if axes == 'base' and not given.get('kinematics.base'):
        raise ParameterRangeError(
            'force_sensor.axes: base needs kinematics.base in --params: the link in whose axes '
            f'the driver expresses the wrench, such as {base} if that is the base of the robot')

    def calibrated(axes: str) -> ToolCalibration:
        return calibrate_tool(read_blocks(
            reader, source, model, sign, _mount(given), base if axes == 'base' else ''), sign)

    found = _in_right_axes(calibrated, axes)
    write_results(options, {'output': lambda: _parameter_file(found, frame),
                            'json': lambda: as_json(_as_json(found))})
    _print(found, frame, options.output)
    return 0


def _in_right_axes(calibrated: Callable[[str], ToolCalibration], axes: str) -> ToolCalibration:
    """Calibrate; where no tool explains the wrenches, say whether one does in other axes."""
    if axes not in AXES:
        raise UnknownNameError.among('force_sensor.axes', axes, AXES)
    try:
        return calibrated(axes)
    except EstimationError as error:
        other, = set(AXES) - {axes}
        try:
            found = calibrated(other)
        except EstimationError:
            raise error from None
        raise EstimationError(
            f'the wrench is expressed in axes of the {other}, where its weight of '
            f'{found.tool.mass:.3g} kg {"keeps its direction" if other == "base" else "turns"}: '
            f'set force_sensor.axes: {other} in --params, and calibrate again') from error


def _description(
    options: Any, reader: RecordingReader, source: RecordingSource
) -> tuple[str, str]:
    """Return the URDF, and the file or recording that holds it."""
    if options.robot_description:
        return read_description(options.robot_description), options.robot_description
    try:
        return recorded_description(reader, source), f'in {options.recording}'
    except RecordingError as error:
        raise RecordingError(
            f'{options.recording} has no robot description on '
            f'{canonical(source.robot_description)}; give the URDF as --robot-description, or '
            'record the topic') from error


def _root(urdf: str, origin: str) -> str:
    """Return the link that carries all others; its z axis points up."""
    try:
        robot = ElementTree.fromstring(urdf)
    except ElementTree.ParseError as error:
        raise ModelFileError(
            f'robot description {origin} must be a URDF, which is XML: {error}; expand xacro first'
        ) from error
    children = {child.get('link') for child in robot.iterfind('joint/child')}
    roots = [link.get('name') or '' for link in robot.iterfind('link')
             if link.get('name') not in children]
    if len(roots) != 1:
        raise ModelFileError(
            f'robot description {origin} must have one root link, got {roots or "none"}')
    return roots[0]


def _force_sign(given: dict[str, Any]) -> float:
    sign = given.get('force_sign', 1)
    if sign not in (1, -1):
        raise ParameterRangeError(f'force_sign must be 1 or -1, got {sign!r}')
    return float(sign)


def _mount(given: dict[str, Any]) -> Any:
    """Return the axes of the wrench in those of the sensor's link."""
    spec = next(s for s in specifications(ForceSensorParameters) if s.name == 'rpy')
    rpy = spec.check(given.get('force_sensor.rpy', spec.default))
    return Rotation.from_euler('xyz', rpy).as_matrix()


def _parameter_file(found: ToolCalibration, frame: str) -> str:
    tool = found.tool
    values = {'mass': round(tool.mass, 6)} | {
        name: [round(value, 6) for value in getattr(tool, name)]
        for name in ('centre', 'force_bias', 'torque_bias')}
    # tool.* is the load of a tool at rest; its inertia along the normal is a known effect.
    inertia = {'tool_inertia': {'mass': values['mass']}}
    text = yaml.safe_dump({'/**': {'ros__parameters': {'tool': values, 'physics': inertia}}},
                          sort_keys=False, default_flow_style=None, width=99)
    head = [f'Tool on the sensor {frame}, found by calibrate_tool from {found.poses} poses.',
            f'Standard deviations: mass {found.mass_std:.2g} kg, '
            f'centre {_listed(found.centre_std)} m,',
            f'force_bias {_listed(found.force_bias_std)} N, '
            f'torque_bias {_listed(found.torque_bias_std)} N m']
    return '\n'.join(f'# {line}' for line in head) + '\n' + text


def _as_json(found: ToolCalibration) -> dict[str, Any]:
    tool = found.tool
    return {
        'mass_kg': {'value': tool.mass, 'std': found.mass_std},
        **{f'{name}_{unit}': {'value': list(getattr(tool, name)),
                              'std': getattr(found, f'{name}_std').tolist()}
           for name, unit in (('centre', 'm'), ('force_bias', 'n'), ('torque_bias', 'nm'))},
        'poses': found.poses,
        'force_rms_n': found.force_rms,
        'torque_rms_nm': found.torque_rms,
        'used_s': (found.blocks - found.fast - found.contact) * BLOCK_S,
        'fast_s': found.fast * BLOCK_S,
        'contact_s': found.contact * BLOCK_S,
    }


def _print(found: ToolCalibration, frame: str, output: str) -> None:
    tool = found.tool
    print(f'tool on {frame} from {found.poses} poses; left out: {found.fast * BLOCK_S:.1f} s of '
          f'fast motion, {found.contact * BLOCK_S:.1f} s that no weight explains')
    print(f'  mass         {tool.mass:.4f} +- {found.mass_std:.2g} kg')
    for name, values, std, unit in (
        ('centre', tool.centre, found.centre_std, 'm'),
        ('force_bias', tool.force_bias, found.force_bias_std, 'N'),
        ('torque_bias', tool.torque_bias, found.torque_bias_std, 'N m'),
    ):
        print(f'  {name:<12} {_listed(values, ".4f")} +- {_listed(std)} {unit}')
    print(f'  residuals between poses: {found.force_rms:.2g} N, {found.torque_rms:.2g} N m')
    print(f'written to {output}; give it to estimator_node after its own parameter file')


def _listed(values: Any, precision: str = '.2g') -> str:
    return '(' + ', '.join(f'{value:{precision}}' for value in values) + ')'


main = command(make_parser, run)
