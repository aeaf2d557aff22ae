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


"""Data shared by all sections of the page."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from ..plot_data import plot_data, PlotData
from ...conclude.result import Diagnosis


@dataclass(frozen=True, eq=False)
class Inputs:
    """
    Inputs of the sections.

    Attributes
    ----------
    diagnosis : Diagnosis
        The result.
    title : str
        Names of the recordings.
    experiment_file : str or None
        Path of the next experiment's file.

    """

    diagnosis: Diagnosis
    title: str
    experiment_file: str | None

    @cached_property
    def plots(self) -> PlotData:
        """Signals of the recording that is shown."""
        return plot_data(self.diagnosis)
