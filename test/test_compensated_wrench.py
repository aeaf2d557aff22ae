# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from typing import Any

from arm_contact import CENTRE, MASS, PARAMETERS
from contact_estimation.kinematics.contact_kinematics import ArmSample
from contact_estimation.kinematics.tool_load import tool_wrench, ToolParameters
from contact_estimation.parameters import build
from contact_estimation.pipeline.arm_kinematics import kinematics_of
from contact_estimation.pipeline.arm_outputs import CompensatedWrench
from contact_estimation.pipeline.parameters import EstimationParameters
import numpy as np
from numpy.typing import NDArray
import pytest
from scipy.spatial.transform import Rotation
from small_arm import pose, urdf

Array = NDArray[np.float64]
STEP = 1e-3  # [s]
WITH_INERTIA: dict[str, Any] = {
    **PARAMETERS, 'force_sensor.frame': 'sensor', 'physics.tool_inertia.mass': MASS,
    'conditioning.cutoff_frequency': 0.0}
TOOL = ToolParameters(mass=MASS, centre=tuple(CENTRE.tolist()))


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
    return tool_wrench(TOOL, T[1][:3, :3], a, w, alpha)


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
