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

"""The physics of an arm by name. To add one: an entry of FRICTION, DRIVE or LOAD."""

from __future__ import annotations

from .carried_load import LOAD
from .joint_drive import DRIVE
from .joint_effect import JointEffect, JointMotion, Place
from .joint_friction import FRICTION

__all__ = ['JOINT_EFFECTS', 'JointEffect', 'JointMotion', 'Place']

LINK_SIDE = 'joint_flexibility_link_side'
"""Key of the second law of one name."""

JOINT_EFFECTS: dict[str, JointEffect] = {}
for _one in (*FRICTION, *DRIVE, *LOAD):
    JOINT_EFFECTS[LINK_SIDE if _one.name in JOINT_EFFECTS else _one.name] = _one
