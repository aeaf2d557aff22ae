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

"""Motion and force at one instant."""

from __future__ import annotations

from typing import NamedTuple


class ContactSample(NamedTuple):
    """
    Motion and force at one instant, along one axis.

    A NamedTuple: creating a frozen dataclass of this size takes longer than an estimator update.

    Attributes
    ----------
    stamp_ns : int
        Header stamp of the wrench [ns].
    position : float
        x of the end-effector [m], +x into the wall.
    velocity : float
        Its rate [m/s]; NaN where not measured.
    force : float
        Measured F_e [N], negative while pressing.

    """

    stamp_ns: int
    position: float
    velocity: float
    force: float


AxesSample = tuple[ContactSample, ...]
"""One sample of each estimated axis, all with the same stamp, the contact axis first."""
