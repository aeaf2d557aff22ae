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
The executables that need no ROS.

Each sets the default of one thread before it imports its command, and with it numpy, which reads
OMP_NUM_THREADS only then. The matrices are small: a second thread of the linear algebra only
waits, and beside other work it made a diagnosis six times as slow. Importing the library sets
nothing: its user chooses the number of threads.
"""

from __future__ import annotations

from importlib import import_module
import os
from typing import Callable


def _entry_point(name: str) -> Callable[[], int]:
    def entry_point() -> int:
        os.environ.setdefault('OMP_NUM_THREADS', '1')
        return int(import_module(f'{__package__}.{name}').main())

    return entry_point


blind_trials = _entry_point('blind_trials')
demonstrate = _entry_point('demonstrate')
diagnose = _entry_point('diagnose')
fleet = _entry_point('fleet')
loop = _entry_point('loop')
replay = _entry_point('replay')
reproduce = _entry_point('reproduce')
simulate = _entry_point('simulate')
