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

"""The checks in the order of their importance."""

from __future__ import annotations

from .check import Check
from .force_checks import ForceBias, ForceDirection, ForceNoise, ForceSign, OtherAxis
from .force_checks import OutsideForce, WeakContact
from .joint_checks import JointRate, JointStill, JointVelocity, PositionUnit
from .state_checks import EstimatorHindrance, ModelMismatch, SampleRate
from .surface_checks import Surface, SurfaceLine, SurfaceShifted, SurfaceUnchecked
from .timing_checks import StampSkew, StampSkewOrMass

CHECKS: tuple[Check, ...] = (
    JointStill(), PositionUnit(), JointVelocity(), ForceSign(), OtherAxis(), OutsideForce(),
    ForceDirection(), Surface(), SurfaceLine(), StampSkew(), StampSkewOrMass(), JointRate(),
    ForceBias(), ForceNoise(), WeakContact(), SampleRate(), ModelMismatch(), EstimatorHindrance(),
    SurfaceShifted(), SurfaceUnchecked(),
)
"""Every check of an axis; the first active one is the headline."""
