# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0


"""Exported contacts: MuJoCo computes our force; the other formats hold what they say."""

from __future__ import annotations

from typing import Any
from xml.etree import ElementTree

import contact_estimation as ce
from contact_estimation.parameters.values import build
from contact_estimation.plant.engines import ENGINES, mujoco_xml
from contact_estimation.plant.simulation import simulate_command
import numpy as np
from numpy.typing import NDArray
import pytest

SAMPLES, PERIOD_NS, START, GOAL = 5000, 200_000, -0.005, 0.02
Array = NDArray[np.float64]


def model(stiffness: float, damping: float, mass: float, **physics: float) -> Any:
    """Return a robot that is slower than its wall."""
    return build(ce.PlantParameters, {
        'environment.stiffness': stiffness, 'environment.damping': damping, 'robot.mass': mass,
        'robot.damping': 20.0 * mass, 'robot.stiffness': 100.0 * mass,
        'integration_rate': 20_000.0, 'sample_rate': 5000.0,
        **{'physics.' + name.replace('__', '.'): value for name, value in physics.items()}})


def force_of_mujoco(text: str) -> Array:
    """Return F_e of the exported model, whose robot is pulled into the wall."""
    mujoco = pytest.importorskip('mujoco')
    world = mujoco.MjModel.from_xml_string(text)
    state, contact, forces = mujoco.MjData(world), np.zeros(6), []
    state.qpos[0], state.ctrl[0] = START, GOAL
    for _ in range(SAMPLES):
        mujoco.mj_step(world, state)
        contact[:] = 0.0
        if state.ncon:
            mujoco.mj_contactForce(world, state, 0, contact)
        forces.append(-contact[0])
    return np.array(forces)


@pytest.mark.parametrize('world', [
    model(4800.0, 200.0, 50.0), model(20_000.0, 100.0, 5.0), model(800.0, 30.0, 2.0),
    model(4800.0, 200.0, 50.0, robot_friction__F_c=6.0),
    model(4800.0, 200.0, 10.0, reflected_inertia__M_r=5.0),
])
def test_mujoco_computes_our_force(world: Any) -> None:
    stamps_ns = PERIOD_NS * np.arange(SAMPLES)
    goal = np.array([[GOAL], [0.0], [0.0], [0.0]]) * np.ones(SAMPLES)
    ours = simulate_command(world, stamps_ns, stamps_ns, goal, (START, 0.0), True).measured[0]
    theirs = force_of_mujoco(mujoco_xml(world))
    assert np.min(ours) < -3.0
    assert np.sqrt(np.mean((theirs - ours)**2)) < 0.03 * np.sqrt(np.mean(ours**2))


def test_two_surfaces_of_sdf_and_drake_combine_to_the_wall() -> None:
    world = model(4800.0, 200.0, 50.0, hunt_crossley_damping__chi=960.0)
    drake = ElementTree.fromstring(
        f'<a xmlns:drake="d">{ENGINES["drake"](world)}</a>'.replace('drake:', ''))
    values = {one.tag: float(one.text or '') for one in drake[0]}
    assert 1.0 / (2.0 / values['point_contact_stiffness']) == pytest.approx(4800.0)
    assert 2.0 * values['relaxation_time'] == pytest.approx(200.0 / 4800.0)
    assert values['hunt_crossley_dissipation'] == pytest.approx(0.2)
    ode = ElementTree.fromstring(ENGINES['sdf'](world)).find('contact/ode')
    assert ode is not None
    assert 0.5 * float(ode.findtext('kp') or '') == 4800.0
    assert 2.0 * float(ode.findtext('kd') or '') == 200.0


@pytest.mark.parametrize('engine', ENGINES)
def test_exports_say_which_physics_they_lack(engine: str) -> None:
    text = ENGINES[engine](model(4800.0, 200.0, 50.0, coulomb_friction__F_c=6.0))
    assert 'K_e = 4800 N/m, B_e = 200 N s/m. Not expressed here: coulomb_friction.' in text
    assert 'Not expressed' not in ENGINES[engine](model(4800.0, 200.0, 50.0))
