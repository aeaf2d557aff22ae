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

"""The sums of a fourth-order Runge-Kutta step."""

from __future__ import annotations

State = tuple[float, ...]
"""x [m], v [m/s], then the internal states of the effects."""


def shift(state: State, h: float, rates: State) -> State:
    """Return state + h rates."""
    return tuple([s + h * rate for s, rate in zip(state, rates)])


def combine(
    state: State, h: float, k1: State, k2: State, k3: State, k4: State
) -> list[float]:
    """Return the state after a step h [s] with rates k1 to k4."""
    sixth = h / 6.0
    return [s + sixth * (a + 2.0 * b + 2.0 * c + d)
            for s, a, b, c, d in zip(state, k1, k2, k3, k4)]
