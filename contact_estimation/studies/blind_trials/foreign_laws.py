# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
Laws of the literature that are not in the vocabulary of the diagnosis, by name.

To add one: a class in the file of its topic and a line in ALL_LAWS.
"""

from . import (
    foreign_damping, foreign_elasticity, foreign_friction, foreign_robot, foreign_sensor,
    foreign_surface)
from .foreign_law import ForeignLaw

ALL_LAWS: dict[str, type[ForeignLaw]] = {
    'lugre_friction': foreign_friction.LuGreFriction,
    'elastoplastic_friction': foreign_friction.ElastoplasticFriction,
    'asymmetric_coulomb': foreign_friction.AsymmetricCoulomb,
    'magnetorheological_damper': foreign_friction.MagnetorheologicalDamper,
    'maxwell_slip': foreign_friction.MaxwellSlip,
    'preisach_hysteresis': foreign_friction.PreisachHysteresis,
    'walton_braun': foreign_elasticity.WaltonBraun,
    'prony_relaxation': foreign_damping.PronyRelaxation,
    'fractional_relaxation': foreign_damping.FractionalRelaxation,
    'quasi_linear_viscoelasticity': foreign_damping.QuasiLinearViscoelasticity,
    'fung_elasticity': foreign_elasticity.FungElasticity,
    'foam_plateau': foreign_elasticity.FoamPlateau,
    'neo_hookean': foreign_elasticity.NeoHookean,
    'tsuji_damping': foreign_damping.TsujiDamping,
    'kuwabara_kono': foreign_damping.KuwabaraKono,
    'jankowski_pounding': foreign_damping.JankowskiPounding,
    'power_law_damper': foreign_damping.PowerLawDamper,
    'jkr_adhesion': foreign_elasticity.JkrAdhesion,
    'rough_surface': foreign_elasticity.RoughSurface,
    'breathing_surface': foreign_surface.BreathingSurface,
    'ringing_panel': foreign_surface.RingingPanel,
    'second_order_filter': foreign_sensor.SecondOrderFilter,
    'settling_bias': foreign_sensor.SettlingBias,
    'load_cell_creep': foreign_sensor.LoadCellCreep,
    'soft_clipping': foreign_sensor.SoftClipping,
    'power_characteristic': foreign_sensor.PowerCharacteristic,
    'soft_tool': foreign_sensor.SoftTool,
    'flexible_mount': foreign_sensor.FlexibleMount,
    'flexible_joint': foreign_robot.FlexibleJoint,
    'joint_friction': foreign_robot.JointFriction,
    'stribeck_joint': foreign_robot.StribeckJoint,
    'sampled_command': foreign_robot.SampledCommand,
    'slow_torque_loop': foreign_robot.SlowTorqueLoop,
    'soft_torque_limit': foreign_robot.SoftTorqueLimit,
    'windage': foreign_robot.Windage,
    'soft_spell': foreign_elasticity.SoftSpell,
    'warming_wall': foreign_elasticity.WarmingWall,
    'force_ripple': foreign_elasticity.ForceRipple,
    'stiffness_ripple': foreign_elasticity.StiffnessRipple,
    'base_vibration': foreign_surface.BaseVibration,
    'mains_hum': foreign_sensor.MainsHum,
    'cross_talk': foreign_sensor.CrossTalk,
    'warming_sensor': foreign_sensor.WarmingSensor,
    'resonant_mount': foreign_sensor.ResonantMount,
    'cogging_torque': foreign_robot.CoggingTorque,
}

FOREIGN_LAWS = [name for name, cls in ALL_LAWS.items() if cls.families]
"""Laws that a family of effects describes acceptably."""

UNKNOWN_LAWS = [name for name, cls in ALL_LAWS.items() if not cls.families]
"""Laws that no effect describes: the right answer names nothing."""
