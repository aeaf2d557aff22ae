# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The fleet as one self-contained HTML page, with the style of the diagnosis's page."""

from __future__ import annotations

from typing import Any, Callable, Mapping

from .sections import (
    prepare_changes, prepare_differences, prepare_errors, prepare_names, prepare_pooled,
    prepare_recordings, prepare_summary, prepare_trends)
from ..run import Fleet
from ...diagnosis.report import page as diagnosis_page

SECTIONS: Mapping[str, Callable[[Fleet], Mapping[str, Any] | None]] = {
    'summary': prepare_summary,
    'changes': prepare_changes,
    'trends': prepare_trends,
    'differences': prepare_differences,
    'names': prepare_names,
    'pooled': prepare_pooled,
    'errors': prepare_errors,
    'recordings': prepare_recordings,
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
