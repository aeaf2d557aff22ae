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

"""Results as text tables."""

from __future__ import annotations

from typing import Any, Mapping, Sequence


def print_table(title: str, rows: Sequence[Mapping[str, Any]]) -> None:
    """
    Print rows that share their columns.

    Parameters
    ----------
    title : str
        Heading.
    rows : sequence of mapping
        Column name to number, text or None; the first row defines the columns.

    """
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
