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

"""Laws that one mark in the force tells, where no law predicts much of the misfit."""

from __future__ import annotations

from typing import Sequence, Union

from .fitting import Fit
from .pull_offs import adhesion_at_release, PullOffs
from .reversal_steps import friction_at_reversals, ReversalSteps
from ..observe.prepared_recording import Recordings

Mark = Union[ReversalSteps, PullOffs]
"""What was seen: its `spread` and, for texts, `words`."""


def law_by_mark(
    recordings: Recordings, present: Fit, found: Sequence[Fit]
) -> tuple[Fit, Mark] | None:
    """
    Return the law that a mark tells.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        As fitted.
    present : Fit
        Without the candidates.
    found : sequence of Fit
        Candidates, the best first.

    Returns
    -------
    law : (Fit, Mark) or None
        One of the candidates, and what tells it.

    """
    return (friction_at_reversals(recordings, present, found)
            or adhesion_at_release(recordings, present, found))
