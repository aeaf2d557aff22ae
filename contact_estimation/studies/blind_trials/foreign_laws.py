# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
Laws of the literature that are not in the vocabulary of the diagnosis, by name.

To add one: a class in the file of its topic and a line in ALL_LAWS.
"""

from .foreign_damping import (
    FractionalRelaxation, JankowskiPounding, KuwabaraKono, PowerLawDamper, PronyRelaxation,
    QuasiLinearViscoelasticity, TsujiDamping)
from .foreign_elasticity import (
    FoamPlateau, ForceRipple, FungElasticity, JkrAdhesion, NeoHookean, RoughSurface, SoftSpell,
    StiffnessRipple, WaltonBraun, WarmingWall)
from .foreign_friction import (
    AsymmetricCoulomb, ElastoplasticFriction, LuGreFriction, MagnetorheologicalDamper, MaxwellSlip,
    PreisachHysteresis)
from .foreign_law import ForeignLaw
from .foreign_robot import (
    CoggingTorque, FlexibleJoint, JointFriction, SampledCommand, SlowTorqueLoop, SoftTorqueLimit,
    StribeckJoint, Windage)
from .foreign_sensor import (
    CrossTalk, FlexibleMount, LoadCellCreep, MainsHum, PowerCharacteristic, ResonantMount,
    SecondOrderFilter, SettlingBias, SoftClipping, SoftTool, WarmingSensor)
from .foreign_surface import BaseVibration, BreathingSurface, RingingPanel

ALL_LAWS: dict[str, type[ForeignLaw]] = {
    'lugre_friction': LuGreFriction,
    'elastoplastic_friction': ElastoplasticFriction,
    'asymmetric_coulomb': AsymmetricCoulomb,
    'magnetorheological_damper': MagnetorheologicalDamper,
    'maxwell_slip': MaxwellSlip,
    'preisach_hysteresis': PreisachHysteresis,
    'walton_braun': WaltonBraun,
    'prony_relaxation': PronyRelaxation,
    'fractional_relaxation': FractionalRelaxation,
    'quasi_linear_viscoelasticity': QuasiLinearViscoelasticity,
    'fung_elasticity': FungElasticity,
    'foam_plateau': FoamPlateau,
    'neo_hookean': NeoHookean,
    'tsuji_damping': TsujiDamping,
    'kuwabara_kono': KuwabaraKono,
    'jankowski_pounding': JankowskiPounding,
    'power_law_damper': PowerLawDamper,
    'jkr_adhesion': JkrAdhesion,
    'rough_surface': RoughSurface,
    'breathing_surface': BreathingSurface,
    'ringing_panel': RingingPanel,
    'second_order_filter': SecondOrderFilter,
    'settling_bias': SettlingBias,
    'load_cell_creep': LoadCellCreep,
    'soft_clipping': SoftClipping,
    'power_characteristic': PowerCharacteristic,
    'soft_tool': SoftTool,
    'flexible_mount': FlexibleMount,
    'flexible_joint': FlexibleJoint,
    'joint_friction': JointFriction,
    'stribeck_joint': StribeckJoint,
    'sampled_command': SampledCommand,
    'slow_torque_loop': SlowTorqueLoop,
    'soft_torque_limit': SoftTorqueLimit,
    'windage': Windage,
    'soft_spell': SoftSpell,
    'warming_wall': WarmingWall,
    'force_ripple': ForceRipple,
    'stiffness_ripple': StiffnessRipple,
    'base_vibration': BaseVibration,
    'mains_hum': MainsHum,
    'cross_talk': CrossTalk,
    'warming_sensor': WarmingSensor,
    'resonant_mount': ResonantMount,
    'cogging_torque': CoggingTorque,
}

FOREIGN_LAWS = [name for name, cls in ALL_LAWS.items() if cls.families]
"""Laws that a family of effects describes acceptably."""

UNKNOWN_LAWS = [name for name, cls in ALL_LAWS.items() if not cls.families]
"""Laws that no effect describes: the right answer names nothing."""
