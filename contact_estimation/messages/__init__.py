# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""CDR messages to plain readings and back, with explicit layouts and no message library."""

from .encoding import (
    encode_arm, encode_float64, encode_multi_array, encode_string, ForceTorqueEncoder,
    JointStateEncoder, TrajectoryEncoder, Vector3StampedEncoder, WrenchEncoder)
from .joint_decoding import (
    ArmReading, decode_arm, JointStateDecoder, SeveralJointsDecoder, SomeJointsDecoder,
    TrajectoryDecoder)
from .plain_decoding import (
    decode_diagnostics, decode_float64, decode_string, DiagnosticReading, ForceTorqueDecoder,
    Vector3StampedDecoder, WrenchDecoder)
from .readings import FORCE_OF_AXIS, JointReading, TrajectoryReading, WrenchReading
from .transforms import StampedTransform, TransformsDecoder

__all__ = [
    'ArmReading',
    'DiagnosticReading',
    'FORCE_OF_AXIS',
    'ForceTorqueDecoder',
    'ForceTorqueEncoder',
    'JointReading',
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
