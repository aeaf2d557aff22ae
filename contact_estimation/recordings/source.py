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

"""Topics of a recording that hold the contact signals."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Mapping

from ..exceptions import UnknownNameError

TOPICS = ('wrench', 'joint_states', 'reference_trajectory', 'robot_description', 'tf', 'tf_static')


@dataclass(frozen=True)
class RecordingSource:
    """
    Topics of a recording that hold the contact signals.

    Attributes
    ----------
    wrench, joint_states, reference_trajectory : str
        Topics.
    robot_description : str
        Topic of the URDF of an arm.
    tf, tf_static : str
        Topics of the transforms of frames.
    events : str
        Topic of the estimator node's events.

    """

    wrench: str = 'wrench'
    joint_states: str = 'joint_states'
    reference_trajectory: str = 'reference_trajectory'
    robot_description: str = 'robot_description'
    tf: str = 'tf'
    tf_static: str = 'tf_static'
    events: str = 'estimator_node/events'

    @classmethod
    def of_topics(cls, topics: Mapping[str, str]) -> 'RecordingSource':
        """
        Return the source with other topics than the default ones.

        Parameters
        ----------
        topics : mapping of str to str
            Recorded topic by its name here, one of `TOPICS`.

        Returns
        -------
        source : RecordingSource
            A topic that is not given keeps its default.

        Raises
        ------
        UnknownNameError
            If a name is not one of `TOPICS`.

        """
        for name in topics:
            if name.strip('/') not in TOPICS:
                raise UnknownNameError.among('topic', name, TOPICS)
        return cls(**{name.strip('/'): topic for name, topic in topics.items()})
