# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

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
    """Build the page."""
    prepared = {name: prepare(fleet) for name, prepare in SECTIONS.items()}
    environment = diagnosis_page.environment(__package__, diagnosis_page.__name__)
    return environment.get_template('page.html').render(
        verdict='fleet', title=f'{len(fleet.entries)} recordings',
        sections={name: data for name, data in prepared.items() if data is not None},
    )
