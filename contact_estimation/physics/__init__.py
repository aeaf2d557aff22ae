# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The effects by name. To add one: a file of its name here, and its name in EFFECTS."""

from dataclasses import make_dataclass
from importlib import import_module

from .effect import Effect
from .numeric import SIGN_VELOCITY
from ..parameters import group, own_specifications, ParameterGroup


def _class_of(name: str) -> type[Effect]:
    """Import the class of an effect from the file of its name."""
    found = vars(import_module(f'.{name}', __package__))[name.title().replace('_', '')]
    if not own_specifications(found):
        raise TypeError(f'{name} has no parameters; declare them by optional_parameter, and '
                        'decorate the class with @dataclass(frozen=True)')
    return found


EFFECTS: dict[str, type[Effect]] = {name: _class_of(name) for name in (
    'coulomb_friction', 'stribeck_friction', 'presliding_friction', 'environment_inertia',
    'environment_resonance', 'cubic_stiffness', 'power_law_stiffness', 'polynomial_stiffness',
    'exponential_stiffness', 'hunt_crossley_damping', 'power_law_damping', 'impact_damping',
    'quadratic_damping', 'asymmetric_damping', 'viscoelastic_relaxation', 'fractional_relaxation',
    'viscous_flow', 'bouc_wen_hysteresis', 'unloading_hysteresis', 'contact_offset',
    'moving_environment', 'beating_environment', 'adhesion', 'dmt_adhesion', 'dead_zone',
    'free_play', 'backlash', 'bilinear_stiffness', 'stiffness_drift', 'plastic_set', 'cogging',
    'tool_weight', 'tool_inertia', 'force_lag', 'force_delay', 'force_creep', 'force_decay',
    'force_gain', 'force_nonlinearity', 'force_bias', 'force_drift', 'settling_bias',
    'force_saturation', 'robot_friction', 'robot_drag', 'gravity_error', 'impedance_mismatch',
    'reflected_inertia', 'joint_flexibility', 'command_delay', 'actuator_lag',
    'actuator_saturation', 'torque_saturation',
)}
"""Contact, then force sensor in the order of its signal chain, then robot."""

PhysicsParameters: type[ParameterGroup] = make_dataclass(
    'PhysicsParameters',
    [(name, effect, group(effect, effect.description)) for name, effect in EFFECTS.items()],
    bases=(ParameterGroup,), frozen=True)
PhysicsParameters.__doc__ = 'Effects by name; all off by default.'


def effects_that_are_on(
    physics: ParameterGroup, sign_velocity: float = SIGN_VELOCITY
) -> list[Effect]:
    """Return the effects that are given (NaN: off), with the width of sgn(v) [m/s]."""
    effects: list[Effect] = [getattr(physics, name) for name in EFFECTS]
    return [effect.with_sign(sign_velocity) for effect in effects if effect.is_on()]
