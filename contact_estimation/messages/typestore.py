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

"""The message types of ROS 2 Jazzy as rosbags knows them, loaded once and only when needed."""

from __future__ import annotations

import functools
from typing import Any

from ..exceptions import MissingPackageError


@functools.lru_cache(maxsize=None)
def jazzy_typestore() -> Any:
    """
    Load the typestore of ROS 2 Jazzy.

    Imported here and not at the top: a node on a ROS installation does not need rosbags, and
    loading takes 0.1 s.

    Returns
    -------
    typestore : rosbags.typesys.store.Typestore
        The same object at every call.

    Raises
    ------
    MissingPackageError
        If rosbags is not installed.

    """
    try:
        from rosbags.typesys import get_typestore, Stores
    except ImportError as error:
        raise MissingPackageError.of(
            'rosbags', 'handling ROS 2 messages without a ROS installation'
        ) from error
    return get_typestore(Stores.ROS2_JAZZY)
