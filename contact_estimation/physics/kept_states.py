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

"""Internal states along a recorded motion, kept while law and motion stay the same."""

from __future__ import annotations

from collections import OrderedDict
from typing import Callable, Hashable

from .numeric import Array

_MOST_BYTES = 1 << 26


class KeptStates:
    """
    The states of the latest laws along the latest motions.

    Most derivatives of a fit are for parameters that no state depends on, such as K_e. Only a
    motion whose arrays are read-only is known not to have changed.

    """

    def __init__(self) -> None:
        self._kept: OrderedDict[Hashable, tuple[Array, Array, Array]] = OrderedDict()
        self._bytes = 0

    def along(self, law: Hashable, x: Array, v: Array, compute: Callable[[], Array]) -> Array:
        """
        Return the states, computed only if they are not known.

        Parameters
        ----------
        law : hashable
            All on which the states depend beside the motion.
        x, v : ndarray, shape (N,)
            Position [m] and velocity [m/s].
        compute : callable
            Returns the states.

        Returns
        -------
        states : ndarray, shape (states, N)
            Read-only if they are kept.

        """
        if x.flags.writeable or v.flags.writeable:
            return compute()
        key = (id(x), id(v), law)
        if key in self._kept:  # the entry holds the arrays: no other ones have their identity
            self._kept.move_to_end(key)
            return self._kept[key][2]
        states = compute()
        states.flags.writeable = False
        self._kept[key] = (x, v, states)
        self._bytes += states.nbytes
        while self._bytes > _MOST_BYTES and len(self._kept) > 1:
            _, (_, _, oldest) = self._kept.popitem(last=False)
            self._bytes -= oldest.nbytes
        return states
