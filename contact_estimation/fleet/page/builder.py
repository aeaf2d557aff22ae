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

"""The fleet as one self-contained HTML page, with the style of the diagnosis's page."""

from __future__ import annotations

from typing import Any, Callable, Mapping

from . import changes, differences, errors, names, pooled, recordings, summary, trends
from ..run import Fleet
from ...diagnosis.report import page as diagnosis_page

SECTIONS: Mapping[str, Callable[[Fleet], Mapping[str, Any] | None]] = {
    'summary': summary.prepare,
    'changes': changes.prepare,
    'trends': trends.prepare,
    'differences': differences.prepare,
    'names': names.prepare,
    'pooled': pooled.prepare,
    'errors': errors.prepare,
    'recordings': recordings.prepare,
}
"""In the order of the page. A section whose data are None is left out."""


def as_html(fleet: Fleet) -> str:
    """
    Build the page.

    Parameters
    ----------
    fleet : Fleet
        Results of a run.

    Returns
    -------
    page : str
        HTML with style and figures embedded: no script; links to the pages of the recordings.

    Raises
    ------
    MissingPackageError
        If matplotlib is not installed.

    """
    prepared = {name: prepare(fleet) for name, prepare in SECTIONS.items()}
    environment = diagnosis_page.environment(__package__, diagnosis_page.__name__)
    return environment.get_template('page.html').render(
        verdict='fleet', title=f'{len(fleet.entries)} recordings',
        sections={name: data for name, data in prepared.items() if data is not None},
    )
