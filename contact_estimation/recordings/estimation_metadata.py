# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The parameters at start, as the metadata record of a recording holds them."""

from __future__ import annotations

import json
from typing import Any, Mapping

from ..exceptions import RecordingError
from ..texts import json_content

RECORD = 'estimator_node'


def to_metadata(parameters: Mapping[str, Any]) -> dict[str, str]:
    """Write parameters as the texts that a metadata record takes."""
    return {name: json.dumps(value) for name, value in parameters.items()}


def from_metadata(records: Mapping[str, Mapping[str, str]]) -> dict[str, Any]:
    """Read the parameters at start."""
    try:
        return {name: json_content(text) for name, text in records.get(RECORD, {}).items()}
    except ValueError as error:
        raise RecordingError(
            f'metadata record {RECORD!r} must hold JSON values, got an unreadable one: {error}; '
            'write a copy without it by `convert`, to CSV and back') from error
