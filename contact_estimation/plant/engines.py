# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
The contact of a model in the formats of other simulators.

Two surfaces in contact combine their compliance in each engine: the values are for both of them
where an engine adds compliances, and for the wall alone where it takes them from one.

"""

from typing import Callable, Mapping

from .plant_parameters import PlantParameters
from ..exceptions import ParameterRangeError
from ..physics import effects_that_are_on

_IMPEDANCE = 1e-4  # the smallest of MuJoCo: larger ones add d / (1 - d) of the mass to the contact
_HALF_M, _AREA_M2 = 0.02, 1e-4  # half the thickness of a hydroelastic wall, area of the tool
_STEP_S = 2e-4  # of time in the exported MuJoCo model


def mujoco_xml(model: PlantParameters) -> str:
    """
    Return a MuJoCo model of robot and wall.

    With impedance d constant, MuJoCo's constraint a_1 = (1 - d) a_0 + d a_ref and regularisation
    R = w (1 - d) / d give, for solref = (-k, -b) and the inverse weight w of the body,
    F = (k delta + b delta_dot) / (w (1 - d)) - d / (w (1 - d)) a (MuJoCo, "Computation",
    solver parameters). So k = K_e w (1 - d) and b = B_e w (1 - d).
    """
    wall, robot, physics = model.environment, model.robot, model.physics
    inertia = _or_zero(physics.reflected_inertia.M_r)
    weight = 1.0 / (3.0 * (robot.mass + inertia))  # body_invweight0: the mean of x, y and z
    k, b = (value * weight * (1.0 - _IMPEDANCE) for value in (wall.stiffness, wall.damping))
    friction = _or_zero(physics.robot_friction.F_c)
    return f"""<mujoco model="contact">
  <!-- {_expressed(model, 'robot_friction', 'reflected_inertia')}
       solref holds for a body with body_invweight0 = {weight:.6g} 1/kg (a mass of
       {robot.mass + inertia:.6g} kg on one slide joint). In another model multiply both numbers by
       the sum of model.body_invweight0[body, 0] of the two bodies in contact over
       {weight:.6g}. One contact point; divide K_e and B_e among several. -->
  <option timestep="{_STEP_S:g}" gravity="0 0 0" integrator="implicitfast"/>
  <default>
    <geom condim="1" solref="{-k:.10g} {-b:.10g}"
          solimp="{_IMPEDANCE:g} {_IMPEDANCE:g} 0.001 0.5 2"/>
  </default>
  <worldbody>
    <geom name="wall" type="plane" pos="{wall.location:.10g} 0 0" zaxis="-1 0 0" size="1 1 0.01"/>
    <body name="tool">
      <joint name="x" type="slide" axis="1 0 0" damping="{robot.damping:.10g}"
             armature="{inertia:.10g}" frictionloss="{friction:.10g}"/>
      <geom name="tip" type="sphere" size="0.01" pos="-0.01 0 0" mass="{robot.mass:.10g}"/>
    </body>
  </worldbody>
  <actuator>
    <position name="x_r" joint="x" kp="{robot.stiffness:.10g}"/>
  </actuator>
</mujoco>
"""


def sdf_xml(model: PlantParameters) -> str:
    """Return the surface of an SDF collision, for Gazebo with ODE or Bullet."""
    # ODE combines 1/kp = 1/kp_1 + 1/kp_2 and kd = kd_1 + kd_2.
    wall = model.environment
    return f"""<!-- {_expressed(model)}
     Give the collisions of tool and wall the same surface. DART ignores kp and kd. One
     contact point: set max_contacts to 1. No force along the normal tells mu: measure it. -->
<surface>
  <contact>
    <ode>
      <kp>{2.0 * wall.stiffness:.10g}</kp>
      <kd>{0.5 * wall.damping:.10g}</kd>
      <max_vel>1000</max_vel>
      <min_depth>0</min_depth>
    </ode>
  </contact>
  <friction><ode><mu>1.0</mu><mu2>1.0</mu2></ode></friction>
</surface>
"""


def drake_xml(model: PlantParameters) -> str:
    """
    Return proximity properties of Drake, in SDF or URDF, for point and hydroelastic contact.

    Drake combines 1/k = 1/k_1 + 1/k_2 and tau = tau_1 + tau_2. Its solver SAP computes
    F = k (delta + tau delta_dot), so that tau = B_e / K_e; TAMSI and Similar compute
    F = k delta (1 + d delta_dot), so that d = chi / K_e of `hunt_crossley_damping`. The pressure
    in a compliant box grows linearly from 0 on its surface to the modulus E at its middle plane,
    at half its thickness h, so that a rigid tool of area A feels k = E A / h (Elandt, Drumwright,
    Sherman and Ruina, *A pressure field model for fast, robust approximation of net contact force
    and moment between nominally rigid objects*, IROS 2019).
    """
    wall = model.environment
    if wall.stiffness <= 0.0:
        raise ParameterRangeError(
            f'Drake needs environment.stiffness > 0, got {wall.stiffness:g}; export a wall that '
            'repels')
    chi = _or_zero(model.physics.hunt_crossley_damping.chi)
    tau, modulus = wall.damping / wall.stiffness, wall.stiffness * _HALF_M / _AREA_M2
    return f"""<!-- {_expressed(model, 'hunt_crossley_damping')}
     Point contact: give the collisions of tool and wall the same properties. With
     discrete_contact_approximation "sap" relaxation_time counts, with "tamsi" and "similar"
     hunt_crossley_dissipation. -->
<drake:proximity_properties>
  <drake:point_contact_stiffness>{2.0 * wall.stiffness:.10g}</drake:point_contact_stiffness>
  <drake:relaxation_time>{0.5 * tau:.10g}</drake:relaxation_time>
  <drake:hunt_crossley_dissipation>{chi / wall.stiffness:.10g}</drake:hunt_crossley_dissipation>
</drake:proximity_properties>

<!-- Hydroelastic contact instead: the wall a box, {2e3 * _HALF_M:g} mm thick, whose other sides
     are longer, and a flat rigid tool of {1e6 * _AREA_M2:g} mm^2. The modulus is K_e h / A, with h
     half the thickness: scale it to your wall and tool. With friction, the sides of a tool that is
     pressed in deep add to the force. -->
<drake:proximity_properties>
  <drake:compliant_hydroelastic/>
  <drake:hydroelastic_modulus>{modulus:.10g}</drake:hydroelastic_modulus>
  <drake:relaxation_time>{tau:.10g}</drake:relaxation_time>
  <drake:hunt_crossley_dissipation>{chi / wall.stiffness:.10g}</drake:hunt_crossley_dissipation>
</drake:proximity_properties>
<drake:proximity_properties>
  <drake:rigid_hydroelastic/>
  <drake:relaxation_time>0</drake:relaxation_time>
</drake:proximity_properties>
"""


def physx_usd(model: PlantParameters) -> str:
    """Return a physics material and joint of PhysX 5, for Isaac Sim and Isaac Lab."""
    # Compliant contact is a spring and a damper, F = K_e delta + B_e delta_dot.
    wall, physics = model.environment, model.physics
    return f"""#usda 1.0
# {_expressed(model, 'robot_friction', 'reflected_inertia')}
# Bind the material to the wall alone. One contact point; divide the values among several.
def Material "contact" (
    prepend apiSchemas = ["PhysicsMaterialAPI", "PhysxMaterialAPI"]
)
{{
    float physxMaterial:compliantContactStiffness = {wall.stiffness:.10g}
    float physxMaterial:compliantContactDamping = {wall.damping:.10g}
    bool physxMaterial:compliantContactAccelerationSpring = 0
}}
over "joint" (
    prepend apiSchemas = ["PhysxJointAPI"]
)
{{
    float physxJoint:armature = {_or_zero(physics.reflected_inertia.M_r):.10g}
    float physxJoint:jointFriction = {_or_zero(physics.robot_friction.F_c):.10g}
}}
"""


ENGINES: Mapping[str, Callable[[PlantParameters], str]] = {
    'mujoco': mujoco_xml, 'sdf': sdf_xml, 'drake': drake_xml, 'physx': physx_usd,
}
"""Text for an engine by its name."""


def _or_zero(value: float) -> float:
    return value if value == value else 0.0


def _expressed(model: PlantParameters, *names: str) -> str:
    """Say what the values are from, and which physics of the model the format lacks."""
    wall = model.environment
    lacking = [effect.name for effect in effects_that_are_on(model.physics)
               if effect.name not in names]
    text = f'K_e = {wall.stiffness:.6g} N/m, B_e = {wall.damping:.6g} N s/m.'
    return text + (f' Not expressed here: {", ".join(lacking)}.' if lacking else '')
