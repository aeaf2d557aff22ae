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

"""Raw CDR bytes to plain readings and back, without building message objects at 500 Hz."""

from .codec import Codec, RosbagsCodec
from .decoding import JointStateDecoder, TrajectoryDecoder, Vector3StampedDecoder, WrenchDecoder
from .encoding import (
    JointStateEncoder,
    StringEncoder,
    TrajectoryEncoder,
    Vector3StampedEncoder,
    WrenchEncoder,
)
from .readings import FORCE_OF_AXIS, JointReading, TrajectoryReading, WrenchReading
from .several_joints import SeveralJointsDecoder

__all__ = [
    'Codec',
    'FORCE_OF_AXIS',
    'JointReading',
    'JointStateDecoder',
    'JointStateEncoder',
    'RosbagsCodec',
    'SeveralJointsDecoder',
    'StringEncoder',
    'TrajectoryDecoder',
    'TrajectoryEncoder',
    'TrajectoryReading',
    'Vector3StampedDecoder',
    'Vector3StampedEncoder',
    'WrenchDecoder',
    'WrenchEncoder',
    'WrenchReading',
]
