# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
Laws of the literature that are not in the vocabulary of the diagnosis, by name.

To add one: a file here and a line in one of the dictionaries.
"""

from __future__ import annotations

from .asymmetric_coulomb import AsymmetricCoulomb
from .base_vibration import BaseVibration
from .breathing_surface import BreathingSurface
from .cogging_torque import CoggingTorque
from .cross_talk import CrossTalk
from .elastoplastic_friction import ElastoplasticFriction
from .flexible_joint import FlexibleJoint
from .flexible_mount import FlexibleMount
from .foam_plateau import FoamPlateau
from .force_ripple import ForceRipple
from .fractional_relaxation import FractionalRelaxation
from .fung_elasticity import FungElasticity
from .jankowski_pounding import JankowskiPounding
from .jkr_adhesion import JkrAdhesion
from .joint_friction import JointFriction
from .kuwabara_kono import KuwabaraKono
from .law import ForeignLaw
from .load_cell_creep import LoadCellCreep
from .lugre_friction import LuGreFriction
from .magnetorheological_damper import MagnetorheologicalDamper
from .mains_hum import MainsHum
from .maxwell_slip import MaxwellSlip
from .neo_hookean import NeoHookean
from .power_characteristic import PowerCharacteristic
from .power_law_damper import PowerLawDamper
from .preisach_hysteresis import PreisachHysteresis
from .prony_relaxation import PronyRelaxation
from .quasi_linear_viscoelasticity import QuasiLinearViscoelasticity
from .resonant_mount import ResonantMount
from .ringing_panel import RingingPanel
from .rough_surface import RoughSurface
from .sampled_command import SampledCommand
from .second_order_filter import SecondOrderFilter
from .settling_bias import SettlingBias
from .slow_torque_loop import SlowTorqueLoop
from .soft_clipping import SoftClipping
from .soft_spell import SoftSpell
from .soft_tool import SoftTool
from .soft_torque_limit import SoftTorqueLimit
from .stiffness_ripple import StiffnessRipple
from .stribeck_joint import StribeckJoint
from .tsuji_damping import TsujiDamping
from .walton_braun import WaltonBraun
from .warming_sensor import WarmingSensor
from .warming_wall import WarmingWall
from .windage import Windage

FOREIGN_LAWS: dict[str, type[ForeignLaw]] = {
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
}
"""Laws that a family of effects describes acceptably."""

UNKNOWN_LAWS: dict[str, type[ForeignLaw]] = {
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
"""Laws that no effect describes: the right answer names nothing."""

ALL_LAWS = {**FOREIGN_LAWS, **UNKNOWN_LAWS}
