# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Stability on a wall that MuJoCo computes, on which the tool rests and may lift off."""

from __future__ import annotations

from typing import Any

from contact_estimation.parameters import build
from contact_estimation.plant.engines import mujoco_xml
from contact_estimation.plant.plant_parameters import PlantParameters
import numpy as np
from numpy.typing import NDArray
import pytest
from scipy.linalg import expm
from test_stable_gains import CASES, on_wall, Robot

mujoco = pytest.importorskip('mujoco')

DEPTH, START = 0.02, 1e-6  # of the tool at rest, and off it at first [m]
STEPS = 20  # of MuJoCo in a sample: all delays are multiples of one


class Wall:
    """The tool on the exported wall, pressed so that it rests at `DEPTH`."""

    def __init__(self, robot: Robot, K_e: float) -> None:
        text = mujoco_xml(build(PlantParameters, {
            'environment.stiffness': K_e, 'environment.damping': robot.B_e,
            'environment.location': 0.0, 'robot.mass': robot.M_t, 'robot.damping': 0.0,
            'robot.stiffness': 0.0}))
        self._model = mujoco.MjModel.from_xml_string(text)
        self._model.opt.timestep = robot.sample_time / STEPS
        self._data: Any = mujoco.MjData(self._model)
        self._rest = K_e * DEPTH
        self.place(START, 0.0)

    def place(self, x: float, v: float) -> None:
        """Move the tool to a distance from where it rests."""
        self._data.qpos[0], self._data.qvel[0] = DEPTH + x, v

    @property
    def state(self) -> NDArray[np.float64]:
        """Return x and v from where it rests."""
        return np.array([self._data.qpos[0] - DEPTH, self._data.qvel[0]])

    @property
    def force(self) -> float:
        """Return F_e less that at rest."""
        mujoco.mj_forward(self._model, self._data)
        contact = np.zeros(6)
        if self._data.ncon:
            mujoco.mj_contactForce(self._model, self._data, 0, contact)
        return float(self._rest - contact[0])

    def step(self, force: float) -> None:
        """Advance by a step, the robot applying a force beside that at rest."""
        self._data.qfrc_applied[0] = self._rest + force
        mujoco.mj_step(self._model, self._data)


def grows(robot: Robot, K_e: float, cycles: int = 240) -> bool:
    """Close the sampled loop; return whether the motion grows."""
    T, late, wall = robot.sample_time, round(robot.delay / robot.sample_time * STEPS), Wall(
        robot, K_e)
    system = np.zeros((3, 3))
    system[0, 1], system[1] = 1.0, np.array([-robot.K_t, -robot.B_t, 1.0]) / robot.M_t
    step, wanted = expm(system * T), np.array([START, 0.0])
    sent: list[tuple[float, ...]] = []
    moved = []
    for k in range(cycles * STEPS):
        of, since = divmod(k - late, STEPS)
        if robot.kind == 'admittance' and of >= 0:  # it follows its reference exactly
            x, v, a = sent[of] if of < len(sent) else (*wanted, 0.0)
            dt = since * T / STEPS
            wall.place(x + dt * (v + 0.5 * dt * a), v + dt * a)
        if k % STEPS == 0:
            if robot.kind == 'admittance':
                force = wall.force
                sent.append((*wanted, (force - robot.B_t * wanted[1] - robot.K_t * wanted[0])
                             / robot.M_t))
                wanted = step[:2, :2] @ wanted + step[:2, 2] * force
            else:
                sent.append((-float(wall.state @ [robot.K_t, robot.B_t]),))
            moved.append(abs(wall.state[0]))
            if moved[-1] > 1e3 * START:
                return True
        if robot.kind == 'impedance':
            of = (k - late) // STEPS
            wall.step(sent[of][0] if of >= 0 else 0.0)
    return max(moved[-cycles // 4:]) > max(moved[cycles // 4:cycles // 2])


@pytest.mark.slow
@pytest.mark.parametrize('robot', CASES)
def test_mujoco_becomes_unstable_within_ten_percent_of_the_predicted_wall(robot: Robot) -> None:
    K_e = on_wall(robot, 5000.0).stiffest_wall
    assert [grows(robot, 0.9 * K_e), grows(robot, 1.1 * K_e)] == [False, True]
