# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The effects by name. To add one: a file here and a line in the dictionary."""

from __future__ import annotations

from dataclasses import make_dataclass

from .actuator_lag import ActuatorLag
from .actuator_saturation import ActuatorSaturation
from .adhesion import Adhesion
from .asymmetric_damping import AsymmetricDamping
from .backlash import Backlash
from .beating_environment import BeatingEnvironment
from .bilinear_stiffness import BilinearStiffness
from .bouc_wen_hysteresis import BoucWenHysteresis
from .command_delay import CommandDelay
from .contact_offset import ContactOffset
from .coulomb_friction import CoulombFriction
from .cubic_stiffness import CubicStiffness
from .dead_zone import DeadZone
from .dmt_adhesion import DmtAdhesion
from .effect import Effect
from .environment_inertia import EnvironmentInertia
from .environment_resonance import EnvironmentResonance
from .exponential_stiffness import ExponentialStiffness
from .force_bias import ForceBias
from .force_creep import ForceCreep
from .force_decay import ForceDecay
from .force_delay import ForceDelay
from .force_drift import ForceDrift
from .force_gain import ForceGain
from .force_lag import ForceLag
from .force_nonlinearity import ForceNonlinearity
from .force_saturation import ForceSaturation
from .fractional_relaxation import FractionalRelaxation
from .free_play import FreePlay
from .gravity_error import GravityError
from .hunt_crossley_damping import HuntCrossleyDamping
from .impact_damping import ImpactDamping
from .impedance_mismatch import ImpedanceMismatch
from .joint_flexibility import JointFlexibility
from .moving_environment import MovingEnvironment
from .numeric import SIGN_VELOCITY
from .plastic_set import PlasticSet
from .polynomial_stiffness import PolynomialStiffness
from .power_law_damping import PowerLawDamping
from .power_law_stiffness import PowerLawStiffness
from .presliding_friction import PreslidingFriction
from .quadratic_damping import QuadraticDamping
from .reflected_inertia import ReflectedInertia
from .robot_drag import RobotDrag
from .robot_friction import RobotFriction
from .settling_bias import SettlingBias
from .stiffness_drift import StiffnessDrift
from .stribeck_friction import StribeckFriction
from .tool_inertia import ToolInertia
from .tool_weight import ToolWeight
from .torque_saturation import TorqueSaturation
from .unloading_hysteresis import UnloadingHysteresis
from .viscoelastic_relaxation import ViscoelasticRelaxation
from .viscous_flow import ViscousFlow
from ..parameters.specification import group, ParameterGroup

EFFECTS: dict[str, type[Effect]] = {
    'coulomb_friction': CoulombFriction,
    'stribeck_friction': StribeckFriction,
    'presliding_friction': PreslidingFriction,
    'environment_inertia': EnvironmentInertia,
    'environment_resonance': EnvironmentResonance,
    'cubic_stiffness': CubicStiffness,
    'power_law_stiffness': PowerLawStiffness,
    'polynomial_stiffness': PolynomialStiffness,
    'exponential_stiffness': ExponentialStiffness,
    'hunt_crossley_damping': HuntCrossleyDamping,
    'power_law_damping': PowerLawDamping,
    'impact_damping': ImpactDamping,
    'quadratic_damping': QuadraticDamping,
    'asymmetric_damping': AsymmetricDamping,
    'viscoelastic_relaxation': ViscoelasticRelaxation,
    'fractional_relaxation': FractionalRelaxation,
    'viscous_flow': ViscousFlow,
    'bouc_wen_hysteresis': BoucWenHysteresis,
    'unloading_hysteresis': UnloadingHysteresis,
    'contact_offset': ContactOffset,
    'moving_environment': MovingEnvironment,
    'beating_environment': BeatingEnvironment,
    'adhesion': Adhesion,
    'dmt_adhesion': DmtAdhesion,
    'dead_zone': DeadZone,
    'free_play': FreePlay,
    'backlash': Backlash,
    'bilinear_stiffness': BilinearStiffness,
    'stiffness_drift': StiffnessDrift,
    'plastic_set': PlasticSet,
    'tool_weight': ToolWeight,
    'tool_inertia': ToolInertia,
    'force_lag': ForceLag,
    'force_delay': ForceDelay,
    'force_creep': ForceCreep,
    'force_decay': ForceDecay,
    'force_gain': ForceGain,
    'force_nonlinearity': ForceNonlinearity,
    'force_bias': ForceBias,
    'force_drift': ForceDrift,
    'settling_bias': SettlingBias,
    'force_saturation': ForceSaturation,
    'robot_friction': RobotFriction,
    'robot_drag': RobotDrag,
    'gravity_error': GravityError,
    'impedance_mismatch': ImpedanceMismatch,
    'reflected_inertia': ReflectedInertia,
    'joint_flexibility': JointFlexibility,
    'command_delay': CommandDelay,
    'actuator_lag': ActuatorLag,
    'actuator_saturation': ActuatorSaturation,
    'torque_saturation': TorqueSaturation,
}
"""Contact, then force sensor in the order of its signal chain, then robot."""

PhysicsParameters: type[ParameterGroup] = make_dataclass(
    'PhysicsParameters',
    [(name, effect, group(effect, effect.description)) for name, effect in EFFECTS.items()],
    bases=(ParameterGroup,),
    frozen=True,
)
PhysicsParameters.__doc__ = 'Effects by name; all off by default.'


def effects_that_are_on(
    physics: ParameterGroup, sign_velocity: float = SIGN_VELOCITY
) -> list[Effect]:
    """
    Return the effects whose parameters are given.

    physics: all effects; NaN means off
    sign_velocity: width of the smooth sign of a velocity [m/s]
    """
    effects: list[Effect] = [getattr(physics, name) for name in EFFECTS]
    return [effect.with_sign(sign_velocity) for effect in effects if effect.is_on()]
