# Copyright 2026 contact_estimation authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""The physics of an arm by name. To add one: a file here and a line in the dictionary."""

from __future__ import annotations

from .carried_load import BaseTilt, LinkInertia, Payload
from .joint_drive import (
    Backlash,
    Counterbalance,
    FlexibleJoint,
    JointSpring,
    LinkSideEncoder,
    PolynomialSpring,
    RotorInertia,
    TorqueBias,
    TorqueDelay,
    TorqueGain,
)
from .joint_effect import JointEffect, JointMotion, Place
from .joint_friction import (
    AsymmetricJoint,
    CoulombJoint,
    CoupledFriction,
    LoadFriction,
    PreslidingJoint,
    QuadraticJoint,
    StribeckJoint,
    ViscousJoint,
)

__all__ = ['JOINT_EFFECTS', 'JointEffect', 'JointMotion', 'Place']

JOINT_EFFECTS: dict[str, type[JointEffect]] = {
    'coulomb_friction': CoulombJoint,
    'viscous_friction': ViscousJoint,
    'force_bias': TorqueBias,
    'reflected_inertia': RotorInertia,
    'stribeck_friction': StribeckJoint,
    'presliding_friction': PreslidingJoint,
    'load_dependent_friction': LoadFriction,
    'quadratic_damping': QuadraticJoint,
    'asymmetric_damping': AsymmetricJoint,
    'coupled_friction': CoupledFriction,
    'force_gain': TorqueGain,
    'force_delay': TorqueDelay,
    'joint_spring': JointSpring,
    'counterbalance': Counterbalance,
    'polynomial_stiffness': PolynomialSpring,
    'joint_flexibility': FlexibleJoint,
    'joint_flexibility_link_side': LinkSideEncoder,
    'backlash': Backlash,
    'payload': Payload,
    'link_inertia': LinkInertia,
    'base_tilt': BaseTilt,
}
"""From the plainest to the least likely: the order of laws that the data do not tell apart."""
