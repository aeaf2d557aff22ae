# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The load of a tool: calibrated, and taken out of the wrench."""

import json
from pathlib import Path
import re
from typing import Any, Sequence

from arm_contact import (
    CENTRE as TOOL_CENTRE, JOINTS as ARM_JOINTS, MASS as TOOL_MASS, PARAMETERS, pose, urdf)
import contact_estimation as ce
from contact_estimation.commands.calibrate_tool import main
from contact_estimation.kinematics.contact_kinematics import ArmSample
from contact_estimation.kinematics.tool_load import (
    load_regressor, load_vector, specific_force, ToolParameters)
from contact_estimation.parameters import build
from contact_estimation.pipeline.arm_kinematics import kinematics_of
from contact_estimation.pipeline.arm_outputs import CompensatedWrench
from contact_estimation.pipeline.parameters import EstimationParameters
from contact_estimation.recordings import RecordingWriter
import numpy as np
from numpy.typing import NDArray
import pytest
from reference_messages import joint_state_bytes, JOINTS, WRENCH, wrench_bytes
from scipy.spatial.transform import Rotation
import yaml

pytest.importorskip('pinocchio')

MASS, CENTRE = 1.2, np.array([0.01, -0.02, 0.06])
FORCE_BIAS, TORQUE_BIAS = np.array([1.0, -2.0, 3.0]), np.array([0.1, 0.2, -0.3])
NEGATIVE = 'estimator_node: {ros__parameters: {force_sign: -1}}'
CONTROLLER = '/**: {ros__parameters: {force_sensor: {frame: tool0_controller}}}'
POSES = np.random.default_rng(3).uniform(-2.0, 2.0, (12, 3))
PERIOD_S, HOLD_S = 0.01, 0.8


def write(
    path: Path, poses: Any, sign: float = 1.0, contact: Sequence[int] = (), moved: float = 1.0,
    axes: str = 'sensor', mass: float = MASS,
) -> None:
    """Record the arm held in poses; in some of them the environment presses with 20 N."""
    rng, order = np.random.default_rng(1), [2, 0, 1]
    names = [ARM_JOINTS[i] for i in order]
    with RecordingWriter.file(path) as writer:
        for k in range(int(len(poses) * HOLD_S / PERIOD_S)):
            stamp, number = int(k * PERIOD_S * 1e9), int(k * PERIOD_S / HOLD_S)
            q = np.asarray(poses[number])
            f = pose(list(q), 'sensor', 'world')[:3, :3].T @ [0.0, 0.0, -9.80665]
            F, T = mass * f + FORCE_BIAS, np.cross(CENTRE, mass * f) + TORQUE_BIAS
            if number in contact:
                F = F + [0.0, 0.0, -20.0]
            F, T = sign * (F + rng.normal(0, 0.1, 3)), sign * (T + rng.normal(0, 0.01, 3))
            if axes == 'base':
                R = pose(list(q), 'sensor')[:3, :3]
                F, T = R @ F, R @ T
            writer.write('/wrench', WRENCH, wrench_bytes(
                F, T, stamp_ns=stamp, frame_id='sensor'), stamp)
            writer.write('/joint_states', JOINTS, joint_state_bytes(
                names, (moved * q[order]).tolist(), stamp_ns=stamp), stamp)


def calibrate(folder: Path, parameters: str = '') -> int:
    """Run the command on the recording in a folder, and on parameters if given."""
    (folder / 'arm.urdf').write_text(urdf())
    (folder / 'params.yaml').write_text(parameters)
    return main([str(folder / 'run.mcap'), '--robot-description', str(folder / 'arm.urdf'),
                 '--output', str(folder / 'tool.yaml'), '--json', str(folder / 'tool.json'),
                 *['--params', str(folder / 'params.yaml')] * bool(parameters)])


def test_tool_is_found_within_its_deviations_and_written_as_parameters(tmp_path: Path) -> None:
    write(tmp_path / 'run.mcap', POSES)
    assert calibrate(tmp_path) == 0
    found = json.loads((tmp_path / 'tool.json').read_text())
    truths = {'mass_kg': MASS, 'centre_m': CENTRE, 'force_bias_n': FORCE_BIAS,
              'torque_bias_nm': TORQUE_BIAS}
    for name, truth in truths.items():
        value, std = (np.array(found[name][key]) for key in ('value', 'std'))
        assert np.all(np.abs(value - truth) < 4 * std), name
    assert found['mass_kg']['std'] < 0.01 and max(found['centre_m']['std']) < 0.001
    written = yaml.safe_load((tmp_path / 'tool.yaml').read_text())['/**']['ros__parameters']
    assert written['tool']['mass'] == pytest.approx(found['mass_kg']['value'], abs=1e-6)
    assert written['physics']['tool_inertia']['mass'] == written['tool']['mass']
    assert written['tool']['centre'] == pytest.approx(found['centre_m']['value'], abs=1e-6)


@pytest.mark.parametrize('options, parameters, message', [
    ({'poses': [POSES[0]] * 12}, '', r'hardly varies .* gravity points along [xyz] and [xyz] of'),
    ({'poses': [(t, 0.3, 0.0) for t in np.linspace(0, 1, 12)]}, '', 'does not determine'),
    ({'poses': POSES, 'contact': range(7)}, '', 'the wrench is not that of a tool alone'),
    ({'poses': POSES, 'sign': -1.0}, '', r'change the sign of force_sign \(now 1\)'),
    ({'poses': POSES}, NEGATIVE, r'change the sign of force_sign \(now -1\)'),
    ({'poses': POSES, 'moved': 57.3}, '', 'not that of a tool alone|no weight explains'),
    ({'poses': POSES, 'mass': 0.0}, '', 'so the sensor carries no tool'),
    ({'poses': POSES[:1]}, CONTROLLER, 'set force_sensor.frame to tool0'),
    ({'poses': POSES[:2]}, '', 'does not determine|at least 4')])
def test_refusal_says_what_is_wrong(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], options: dict[str, Any], parameters: str,
    message: str,
) -> None:
    write(tmp_path / 'run.mcap', **options)
    assert calibrate(tmp_path, parameters) == 1
    assert re.search(message, capsys.readouterr().err)


def test_force_sign_of_the_parameter_file_is_applied(tmp_path: Path) -> None:
    write(tmp_path / 'run.mcap', POSES, sign=-1.0)
    assert calibrate(tmp_path, NEGATIVE) == 0
    found = json.loads((tmp_path / 'tool.json').read_text())
    assert found['force_bias_n']['value'] == pytest.approx(FORCE_BIAS, abs=0.1)


@pytest.mark.parametrize('recorded, given', [('base', 'sensor'), ('sensor', 'base')])
def test_axes_of_the_wrench_are_recognised_and_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], recorded: str, given: str
) -> None:
    write(tmp_path / 'run.mcap', POSES, axes=recorded)
    for axes, code in ((given, 1), (recorded, 0)):
        parameters = f'kinematics: {{base: base_link}}, force_sensor: {{axes: {axes}}}'
        assert calibrate(tmp_path, f'/**: {{ros__parameters: {{{parameters}}}}}') == code
    assert re.search(f'expressed in axes of the {recorded}, where its weight of 1.2 kg .*'
                     f'force_sensor.axes: {recorded}', capsys.readouterr().err)
    found = json.loads((tmp_path / 'tool.json').read_text())
    assert found['mass_kg']['value'] == pytest.approx(MASS, abs=0.02)
    assert found['centre_m']['value'] == pytest.approx(CENTRE, abs=0.002)
    assert calibrate(tmp_path, '/**: {ros__parameters: {force_sensor: {axes: base}}}') == 1
    assert 'axes: base needs kinematics.base' in capsys.readouterr().err


@pytest.mark.parametrize('recorded, given', [
    ('base', 'sensor'), ('sensor', 'base'), ('base', 'base'), ('sensor', 'sensor')])
def test_axes_of_the_wrench_are_recognised_in_a_recording_to_be_diagnosed(
    tmp_path: Path, recorded: str, given: str
) -> None:
    write(tmp_path / 'run.mcap', POSES, axes=recorded)
    (tmp_path / 'arm.urdf').write_text(urdf())
    found = ce.read_recording(tmp_path / 'run.mcap', parameters={
        **PARAMETERS, 'tool.mass': 0.0, 'force_sensor.axes': given,
        'robot_description_file': str(tmp_path / 'arm.urdf')}).foreign_axes
    assert (f'set force_sensor.axes to {recorded}' in found) == bool(found) == (recorded != given)


Array = NDArray[np.float64]
STEP = 1e-3  # [s]
WITH_INERTIA: dict[str, Any] = {
    **PARAMETERS, 'force_sensor.frame': 'sensor', 'physics.tool_inertia.mass': TOOL_MASS,
    'conditioning.cutoff_frequency': 0.0}
TOOL = ToolParameters(mass=TOOL_MASS, centre=tuple(TOOL_CENTRE.tolist()))


def published(rows: Any, parameters: dict[str, Any]) -> Array:
    """Return the wrenches published for rows of stamp [ns], q, q_dot and measured wrench."""
    given = build(EstimationParameters, parameters)
    arm, outputs = kinematics_of(given, urdf()), CompensatedWrench(given)
    found = []
    for stamp_ns, q, q_dot, wrench in rows:
        arm.contact(ArmSample(stamp_ns, [*q, *q_dot], wrench))
        assert arm.state is not None
        found.append(outputs.take(stamp_ns, arm.state))
    return np.array(found)


def swing(t: float) -> tuple[Array, Array]:
    """Return joints and their rates of a motion that turns and accelerates the tool."""
    amplitude, rate = np.array([0.3, 0.4, 0.5]), np.array([7.0, 9.0, 11.0])
    return 0.5 + amplitude * np.sin(rate * t), amplitude * rate * np.cos(rate * t)


def felt(t: float) -> Array:
    """Return what the sensor of a swinging arm feels of its tool, from its poses alone."""
    h = 1e-4
    T = [pose(tuple(swing(t + k * h)[0]), 'sensor', 'world') for k in (-1, 0, 1)]
    a = (T[2][:3, 3] - 2.0 * T[1][:3, 3] + T[0][:3, 3]) / h**2
    turned = [Rotation.from_matrix(T[1][:3, :3].T @ each[:3, :3]).as_rotvec() for each in T]
    w, alpha = (turned[2] - turned[0]) / (2.0 * h), (turned[2] + turned[0]) / h**2
    return load_regressor(specific_force(T[1][:3, :3], a), w, alpha) @ load_vector(TOOL)


@pytest.mark.parametrize('measured', [True, False], ids=['rates measured', 'positions alone'])
def test_a_tool_swung_in_free_flight_leaves_no_wrench(measured: bool) -> None:
    times = STEP * np.arange(300)
    rows = [(round(t * 1e9), q, q_dot if measured else np.full(3, np.nan), felt(t))
            for t in times for q, q_dot in [swing(t)]]
    inertia = published(rows, {**WITH_INERTIA, 'physics.tool_inertia.mass': np.nan})
    left = published(rows, WITH_INERTIA)[2:]
    assert np.abs(inertia[:, :3]).max() > 20.0
    np.testing.assert_allclose(left[:, :3], 0.0, atol=5e-3)
    np.testing.assert_allclose(left[:, 3:], 0.0, atol=5e-4)
