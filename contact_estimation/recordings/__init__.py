# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""MCAP files and rosbag2 folders; a killed recorder loses at most the last second."""

from .bag_folder import OfferedQos
from .reading import RecordedMessage, RecordingReader
from .writing import RecordingWriter

__all__ = ['OfferedQos', 'RecordedMessage', 'RecordingReader', 'RecordingWriter']
