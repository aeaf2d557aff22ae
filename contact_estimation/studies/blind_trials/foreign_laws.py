# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
Laws of the literature that are not in the vocabulary of the diagnosis, by name.

To add one: a class in the file of its topic and its name in ALL_LAWS.
"""

from . import (
    foreign_damping, foreign_elasticity, foreign_friction, foreign_robot, foreign_sensor,
    foreign_surface)
from .foreign_law import ForeignLaw

_FILES = (foreign_damping, foreign_elasticity, foreign_friction, foreign_robot, foreign_sensor,
          foreign_surface)


def _class_of(name: str) -> type[ForeignLaw]:
    """Return the class of a law, which is called as the law is, whatever its file."""
    called = name.title().replace('_', '')
    return next(vars(file)[called] for file in _FILES if called in vars(file))


ALL_LAWS: dict[str, type[ForeignLaw]] = {name: _class_of(name) for name in (
    'lugre_friction', 'elastoplastic_friction', 'asymmetric_coulomb', 'magnetorheological_damper',
    'maxwell_slip', 'preisach_hysteresis', 'walton_braun', 'prony_relaxation',
    'fractional_relaxation', 'quasi_linear_viscoelasticity', 'fung_elasticity', 'foam_plateau',
    'neo_hookean', 'tsuji_damping', 'kuwabara_kono', 'jankowski_pounding', 'power_law_damper',
    'jkr_adhesion', 'rough_surface', 'breathing_surface', 'ringing_panel', 'second_order_filter',
    'settling_bias', 'load_cell_creep', 'soft_clipping', 'power_characteristic', 'soft_tool',
    'flexible_mount', 'flexible_joint', 'joint_friction', 'stribeck_joint', 'sampled_command',
    'slow_torque_loop', 'soft_torque_limit', 'windage', 'soft_spell', 'warming_wall',
    'force_ripple', 'stiffness_ripple', 'base_vibration', 'mains_hum', 'cross_talk',
    'warming_sensor', 'resonant_mount', 'cogging_torque',
)}

FOREIGN_LAWS = [name for name, cls in ALL_LAWS.items() if cls.families]
"""Laws that a family of effects describes acceptably."""

UNKNOWN_LAWS = [name for name, cls in ALL_LAWS.items() if not cls.families]
"""Laws that no effect describes: the right answer names nothing."""
