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

"""
Results of the latest models.

A derivative by a value of the robot or of the force sensor leaves the wall's force as it is, and
candidates of both start from the same wall.
"""

from __future__ import annotations

from typing import Any, Callable

_MOST = 8  # a model and those that differ from it in one value


class Latest:
    """The latest results of a function, by what they depend on."""

    def __init__(self) -> None:
        self._known: list[tuple[object, Any]] = []

    def of(self, key: object, compute: Callable[[], Any]) -> Any:
        """Return a result, computed only if it is not among the latest."""
        for place, (known, result) in enumerate(self._known):
            if known == key:
                self._known.append(self._known.pop(place))
                return result
        result = compute()
        self._known.append((key, result))
        del self._known[:-_MOST]
        return result
