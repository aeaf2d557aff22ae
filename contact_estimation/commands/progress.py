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

"""Progress of a long command, on one line of a terminal."""

from __future__ import annotations

import sys
import time

_EVERY_S = 0.5


class Progress:
    """
    Show how far a command is, where somebody can see it.

    Parameters
    ----------
    name : str
        What is going on.

    """

    def __init__(self, name: str) -> None:
        self._name, self._begin = name, time.monotonic()
        self._next = self._begin + _EVERY_S
        self._visible = sys.stderr.isatty()
        self._shown = False

    def show(self, fraction: float, text: str = '') -> None:
        """
        Show the progress, not more often than twice a second.

        Parameters
        ----------
        fraction : float
            From 0 to 1.
        text : str
            Further words.

        """
        now = time.monotonic()
        if not self._visible or now < self._next:
            return
        self._next, self._shown = now + _EVERY_S, True
        left = (now - self._begin) * (1.0 - fraction) / max(fraction, 1e-9)
        print(f'\r{self._name} {100 * fraction:5.1f} %  {left:5.0f} s left  {text}\x1b[K',
              end='', file=sys.stderr, flush=True)

    def done(self) -> None:
        """Clear the line."""
        if self._shown:
            print('\r\x1b[K', end='', file=sys.stderr, flush=True)
