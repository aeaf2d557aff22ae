# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Exported contacts: MuJoCo and Drake compute our force; other formats hold what they say."""

import re
from typing import Any
from xml.etree import ElementTree

import contact_estimation as ce
from contact_estimation.parameters import build
from contact_estimation.plant.engines import drake_xml, ENGINES, mujoco_xml
from contact_estimation.plant.simulation import simulate_command
import numpy as np
from numpy.typing import NDArray
import pytest

SAMPLES, PERIOD_NS, START, GOAL = 5000, 200_000, -0.005, 0.02
Array = NDArray[np.float64]
SDF = """<sdf version="1.7" xmlns:drake="http://drake.mit.edu"><model name="contact">
<link name="wall"><collision name="wall"><pose>0.02 0 0 0 0 0</pose>
<geometry><box><size>0.04 0.5 0.5</size></box></geometry>{wall}</collision></link>
<joint name="fixed" type="fixed"><parent>world</parent><child>wall</child></joint>
<link name="tool"><inertial><mass>{mass}</mass></inertial>
<collision name="tool"><pose>{place}</pose>
<geometry>{shape}</geometry>{tool}</collision></link>
<joint name="x" type="prismatic"><parent>world</parent><child>tool</child>
<axis><xyz>1 0 0</xyz><dynamics><damping>{damping}</damping></dynamics></axis></joint>
</model></sdf>"""


def model(stiffness: float, damping: float, mass: float, **physics: float) -> Any:
    """Return a robot that is slower than its wall."""
    return build(ce.PlantParameters, {
        'environment.stiffness': stiffness, 'environment.damping': damping, 'robot.mass': mass,
        'robot.damping': 20.0 * mass, 'robot.stiffness': 100.0 * mass,
        'integration_rate': 20_000.0, 'sample_rate': 5000.0,
        **{'physics.' + name.replace('__', '.'): value for name, value in physics.items()}})


def our_force(world: Any) -> Array:
    """Return F_e of a robot that is pulled into the wall."""
    stamps_ns = PERIOD_NS * np.arange(SAMPLES)
    goal = np.array([[GOAL], [0.0], [0.0], [0.0]]) * np.ones(SAMPLES)
    run = simulate_command(world, stamps_ns, stamps_ns, goal, (START, 0.0), True)
    return np.asarray(run.measured[0])


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


def force_of_drake(text: str, world: Any, hydroelastic: bool) -> Array:
    """Return F_e in Drake of a tool that is pulled into a wall, with the exported properties."""
    pytest.importorskip('pydrake')
    from pydrake.multibody.parsing import Parser
    from pydrake.multibody.plant import AddMultibodyPlantSceneGraph, ContactModel
    from pydrake.multibody.plant import DiscreteContactApproximation
    from pydrake.systems.analysis import Simulator
    from pydrake.systems.framework import DiagramBuilder

    point, of_wall, of_tool = re.findall(
        '<drake:proximity_properties>.*?</drake:proximity_properties>', text, re.DOTALL)
    if not hydroelastic:
        of_wall = of_tool = point
    slippery = '<drake:mu_dynamic>0</drake:mu_dynamic></drake:proximity_properties>'
    of_wall, of_tool = (  # else the sides of a tool that is pressed in deep rub
        one.replace('</drake:proximity_properties>', slippery) for one in (of_wall, of_tool))
    builder = DiagramBuilder()
    plant, _ = AddMultibodyPlantSceneGraph(builder, 1e-9 * PERIOD_NS)
    plant.set_contact_model(ContactModel.kHydroelastic if hydroelastic else ContactModel.kPoint)
    plant.set_discrete_contact_approximation(DiscreteContactApproximation.kSap)
    # Edges that lie on those of the wall's mesh would be counted twice now and then.
    shape, place = ('<box><size>0.06 0.01 0.01</size></box>', '-0.03 0.0113 0.0271 0.3 0 0') if (
        hydroelastic) else ('<sphere><radius>0.005</radius></sphere>', '-0.005 0 0 0 0 0')
    Parser(plant).AddModelsFromString(SDF.format(
        mass=world.robot.mass, damping=world.robot.damping, wall=of_wall, tool=of_tool,
        shape=shape, place=place), 'sdf')
    plant.mutable_gravity_field().set_gravity_vector([0.0, 0.0, 0.0])
    joint = plant.GetJointByName('x')
    plant.Finalize()
    simulator = Simulator(builder.Build())
    context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    joint.set_translation(context, START)
    pull, forces = plant.get_applied_generalized_force_input_port(), []
    for k in range(SAMPLES):
        pull.FixValue(context, [world.robot.stiffness * (GOAL - joint.get_translation(context))])
        simulator.AdvanceTo(1e-9 * PERIOD_NS * (k + 1))
        found = plant.get_contact_results_output_port().Eval(context)
        forces.append(sum(
            abs(found.hydroelastic_contact_info(i).F_Ac_W().translational()[0])
            for i in range(found.num_hydroelastic_contacts())) + sum(
            abs(found.point_pair_contact_info(i).contact_force()[0])
            for i in range(found.num_point_pair_contacts())))
    return -np.array(forces)


@pytest.mark.slow
@pytest.mark.parametrize('world, hydroelastic', [
    (model(4800.0, 200.0, 50.0), False), (model(20_000.0, 100.0, 5.0), True)])
def test_drake_computes_our_force(world: Any, hydroelastic: bool) -> None:
    ours = our_force(world)
    theirs = force_of_drake(drake_xml(world), world, hydroelastic)
    assert np.sqrt(np.mean((theirs - ours)**2)) < 0.03 * np.sqrt(np.mean(ours**2))


@pytest.mark.parametrize('world', [
    model(4800.0, 200.0, 50.0), model(20_000.0, 100.0, 5.0), model(800.0, 30.0, 2.0),
    model(4800.0, 200.0, 50.0, robot_friction__F_c=6.0),
    model(4800.0, 200.0, 10.0, reflected_inertia__M_r=5.0)])
def test_mujoco_computes_our_force(world: Any) -> None:
    ours = our_force(world)
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
