# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""All that the file of an effect needs, by one import."""

from dataclasses import dataclass
from typing import Any

from numpy.random import Generator

from .contact_effect import ContactEffect, State
from .effect import Need, Seen
from .force_sensor_effect import ForceSensorEffect, Reader
from .numeric import (
    Array, discretise, Flags, Motion, motion_of, Number, path_of, positive, stretches)
from .prior import log_uniform, Prior, random_sign, Scales, Strength, Tone
from .robot_effect import Joint, RobotEffect
from ..parameters import optional_parameter

__all__ = [
    'Any', 'Array', 'ContactEffect', 'dataclass', 'discretise', 'Flags', 'ForceSensorEffect',
    'Generator', 'Joint', 'log_uniform', 'Motion', 'motion_of', 'Need', 'Number',
    'optional_parameter', 'path_of', 'positive', 'Prior', 'random_sign', 'Reader', 'RobotEffect',
    'Scales', 'Seen', 'State', 'Strength', 'stretches', 'Tone']
