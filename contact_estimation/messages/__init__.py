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

"""CDR messages to plain readings and back, with explicit layouts and no message library."""

from .arm_joints import ArmReading, decode_arm
from .diagnostics import decode_diagnostics, DiagnosticReading
from .encoding import (
    encode_arm,
    encode_float64,
    encode_multi_array,
    encode_string,
    ForceTorqueEncoder,
    JointRowEncoder,
    JointStateEncoder,
    TrajectoryEncoder,
    Vector3StampedEncoder,
    WrenchEncoder,
)
from .joint_decoding import JointStateDecoder, SeveralJointsDecoder, TrajectoryDecoder
from .plain_decoding import decode_float64, decode_string
from .readings import FORCE_OF_AXIS, JointReading, TrajectoryReading, WrenchReading
from .some_joints import SomeJointsDecoder
from .transforms import StampedTransform, TransformsDecoder
from .wrench_decoding import ForceTorqueDecoder, Vector3StampedDecoder, WrenchDecoder

__all__ = [
    'ArmReading',
    'DiagnosticReading',
    'FORCE_OF_AXIS',
    'ForceTorqueDecoder',
    'ForceTorqueEncoder',
    'JointReading',
    'JointRowEncoder',
    'JointStateDecoder',
    'JointStateEncoder',
    'SeveralJointsDecoder',
    'SomeJointsDecoder',
    'StampedTransform',
    'TrajectoryDecoder',
    'TrajectoryEncoder',
    'TrajectoryReading',
    'TransformsDecoder',
    'Vector3StampedDecoder',
    'Vector3StampedEncoder',
    'WrenchDecoder',
    'WrenchEncoder',
    'WrenchReading',
    'decode_arm',
    'decode_diagnostics',
    'decode_float64',
    'decode_string',
    'encode_arm',
    'encode_float64',
    'encode_multi_array',
    'encode_string',
]
