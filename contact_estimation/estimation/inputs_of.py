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

"""The inputs that fit the parameters of a session."""

from __future__ import annotations

from .arm_inputs import ArmInputs
from .inputs import MessageInputs
from .session import ContactSession
from .transform_inputs import TransformInputs


def inputs_of(session: ContactSession) -> MessageInputs | ArmInputs:
    """Return the inputs that fit the parameters of a session."""
    if session.parameters.pose_source == 'tf':
        return TransformInputs(session)
    return ArmInputs(session) if session.parameters.kinematics.tip else MessageInputs(session)
