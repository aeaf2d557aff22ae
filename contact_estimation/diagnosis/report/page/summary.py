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


"""The verdict in one sentence, and its proof on held-out data."""

from __future__ import annotations

from typing import Any

from .inputs import Inputs
from ..wording import headline, held_out_result, trifle


def prepare(inputs: Inputs) -> dict[str, Any]:
    """Return verdict, headline, held-out result, what is too little, and the names."""
    return {
        'verdict': inputs.diagnosis.verdict,
        'headline': headline(inputs.diagnosis),
        'held_out_result': held_out_result(inputs.diagnosis),
        'trifle': trifle(inputs.diagnosis),
        'title': inputs.title,
    }
