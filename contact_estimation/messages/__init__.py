# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""CDR messages to plain readings and back, with explicit layouts and no message library."""

from .arm_joints import ArmReading, decode_arm
from .diagnostics import decode_diagnostics, DiagnosticReading
from .encoding import (
    encode_arm, encode_float64, encode_multi_array, encode_string, ForceTorqueEncoder,
    JointRowEncoder, JointStateEncoder, TrajectoryEncoder, Vector3StampedEncoder, WrenchEncoder)
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
