# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Results as text tables."""

from __future__ import annotations

from typing import Any, Mapping, Sequence


def print_table(title: str, rows: Sequence[Mapping[str, Any]]) -> None:
    """Print rows that share their columns."""
    names = list(rows[0])
    lines = [names, *([_text(row[name]) for name in names] for row in rows)]
    widths = [max(map(len, column)) for column in zip(*lines)]
    print(f'\n{title}')
    for line in lines:
        print('  ' + '  '.join(f'{text:>{width}}' for text, width in zip(line, widths)))


def _text(value: Any) -> str:
    if value is None:
        return '-'
    return f'{value:.4g}' if isinstance(value, float) else str(value)
