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


"""The experiment that would answer the open questions."""

from __future__ import annotations

from typing import Any

from .inputs import Inputs


def prepare(inputs: Inputs) -> dict[str, Any] | None:
    """Return text and file of the next experiment; None if nothing is open."""
    text = inputs.diagnosis.next_experiment
    return {'text': text, 'file': inputs.experiment_file} if text else None
