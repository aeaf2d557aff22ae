# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Every effect with parameters of a plausible size, for the tests over all of them."""

from typing import Any

from contact_estimation.physics import EFFECTS
from contact_estimation.physics.effect import Effect
from contact_estimation.physics.prior import Scales

SCALES = Scales(
    depth=0.013, speed=0.1, force=60.0, control=200.0, greatest_pull=0.0, duration=1.4,
    stiffness=4800.0, damping=200.0, mass=50.0)
EXAMPLES: dict[str, tuple[float, ...]] = {
    'coulomb_friction': (6.0,),
    'stribeck_friction': (4.0, 9.0, 0.02),
    'presliding_friction': (9.0, 15000.0),
    'environment_inertia': (8.0,),
    'environment_resonance': (6.0, 7.0, 0.08),
    'cubic_stiffness': (1.5e7,),
    'power_law_stiffness': (1.3, 18000.0),
    'polynomial_stiffness': (-4e5, 4e7),
    'exponential_stiffness': (2.0, 0.004),
    'hunt_crossley_damping': (25000.0,),
    'power_law_damping': (2500.0, 0.5),
    'impact_damping': (2500.0,),
    'quadratic_damping': (1500.0,),
    'asymmetric_damping': (-40.0,),
    'viscoelastic_relaxation': (2000.0, 0.15),
    'fractional_relaxation': (900.0, 0.4),
    'bouc_wen_hysteresis': (2000.0, 150.0, 40.0),
    'contact_offset': (-0.0015,),
    'moving_environment': (0.001, 2.0, 0.7),
    'beating_environment': (0.001, 2.0, 0.7, 0.0006, 3.1, -0.4),
    'adhesion': (4.0,),
    'dmt_adhesion': (5.0, 0.003),
    'dead_zone': (0.002,),
    'free_play': (0.002, 0.0004, 0.3),
    'backlash': (0.001,),
    'bilinear_stiffness': (3000.0, 0.005),
    'stiffness_drift': (0.2,),
    'plastic_set': (0.3, 0.001),
    'cogging': (3.0, 0.001, 0.7),
    'tool_weight': (-3.0,),
    'viscous_flow': (0.2,),
    'unloading_hysteresis': (0.4,),
    'tool_inertia': (2.0,),
    'force_lag': (0.02,),
    'force_creep': (0.1, 0.5),
    'force_decay': (0.1, 0.5),
    'force_delay': (0.0123,),
    'force_gain': (1.2,),
    'force_nonlinearity': (-0.002, 0.9),
    'force_bias': (3.0,),
    'force_drift': (-2.0,),
    'settling_bias': (3.0, 0.4, -1.0),
    'force_saturation': (30.0,),
    'robot_friction': (8.0,),
    'robot_drag': (800.0,),
    'gravity_error': (-12.0,),
    'impedance_mismatch': (0.8, 1.2, 1.1),
    'reflected_inertia': (6.0,),
    'joint_flexibility': (5e-5, 0.2, 0.1),
    'command_delay': (0.013,),
    'actuator_lag': (0.012,),
    'actuator_saturation': (40.0,),
    'torque_saturation': (60.0,),
}
"""Values in the order of the parameters; an effect that is not here starts its own search."""


def example_values(name: str) -> tuple[float, ...]:
    """Give all parameters of an effect."""
    return EXAMPLES.get(name) or EFFECTS[name].prior(SCALES).starts[0]


def example(name: str, values: tuple[float, ...] | None = None) -> Any:
    """Make an effect, of its usual values by default."""
    cls: type[Effect] = EFFECTS[name]
    return cls(*(values or example_values(name)))


def switched_on(name: str, prefix: str = 'physics.') -> dict[str, float]:
    """Give the parameters that switch an effect on, by their dotted names."""
    return {f'{prefix}{name}.{key}': value
            for key, value in zip(EFFECTS[name].neutral(), example_values(name))}
