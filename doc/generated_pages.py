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

"""
Sphinx extension: write the pages that follow from the code.

`generated/effects_<port>.md` has one section per entry of EFFECTS, `generated/tuning.md` one
table per entry of ESTIMATORS, `generated/foreign_laws.md` one row per law of blind trials,
`generated/fleet_columns.md` one per column of the fleet's table: a new entry appears without an
edit here.

"""

from __future__ import annotations

from math import isfinite
from pathlib import Path
import sys
from typing import Any, Iterable

import contact_estimation as ce
from contact_estimation.fleet.columns import COLUMNS
from contact_estimation.foreign_laws import ALL_LAWS
from contact_estimation.parameters.specification import specifications
from effect_plots import plot_effect

PORTS = {
    'contact': ('Effects in the contact', 'R is the additional force that resists penetration; '
                'in contact `F_e = min(0, -(K_e d + B_e v + sum of all R))`, `d` is the '
                'penetration, `v` its rate.'),
    'force_sensor': ('Effects in the force sensor', 'These laws describe what the sensor makes '
                     'of the true force. They act in free flight too, in the order of this '
                     'page.'),
    'robot': ('Effects in the robot', 'These laws change how the robot follows its reference: '
              '`M_t xdd = clip(u) - F_c sgn(xd) + F_e` with '
              '`u = M_t xdd_r - B_t (xd - xd_r) - K_t (x - x_r)`.'),
}


def setup(app: Any) -> dict[str, bool]:
    """Register the generator with Sphinx."""
    app.connect('builder-inited', write_pages)
    return {'parallel_read_safe': True}


def write_pages(app: Any) -> None:
    """Write all pages and plots below `generated/` of the source folder."""
    folder = Path(app.srcdir) / 'generated'
    folder.mkdir(exist_ok=True)
    for port in PORTS:
        _write(folder / f'effects_{port}.md', effects_page(port, folder))
    _write(folder / 'tuning.md', tuning_page())
    _write(folder / 'foreign_laws.md', laws_page())
    _write(folder / 'fleet_columns.md', columns_page())


def effects_page(port: str, folder: Path) -> str:
    """Return the page of all effects of a port, and write their plots."""
    title, introduction = PORTS[port]
    sections = [f'# {title}', introduction]
    for name, cls in ce.EFFECTS.items():
        if cls.port == port:
            sections.append(_effect_section(name, cls, plot_effect(name, folder)))
    return '\n\n'.join(sections)


def _effect_section(name: str, cls: Any, shown: dict[str, float]) -> str:
    values = ', '.join(f'{key}: {value:g}' for key, value in shown.items())
    return '\n\n'.join([
        f'## {name}', cls.description, f'```text\n{cls.equation}\n```',
        parameter_table(cls.Parameters),
        f':::{{figure}} {name}.png\n:alt: Simulation with and without {name}\n\n'
        f'Simulated with `{name}: {{{values}}}` (blue) and without (grey).\n:::',
    ])


def tuning_page() -> str:
    """Return the page with the tuning parameters of every estimator."""
    sections = ['# Tuning parameters', 'The node declares the parameter `FIELD` of the estimator '
                '`NAME` as `tuning.NAME.FIELD`. All parameters can change while the node runs.']
    for name, cls in ce.ESTIMATORS.items():
        sections += [f'## {name}', _first_line(cls), parameter_table(cls.Parameters)]
    return '\n\n'.join(sections)


def laws_page() -> str:
    """Return the page with a row for every law of the literature."""
    head = ('law', 'what it is', 'port', 'right families')
    rows = [(f'`{name}`', _first_line(cls), f'`{cls.port}`',
             ', '.join(f'`{family}`' for family in cls.families) or 'none')
            for name, cls in ALL_LAWS.items()]
    return '\n\n'.join([
        '# Laws of the literature', '`blind_trials --foreign` draws from the laws that a family '
        'of effects describes, `--unknown` from the others. Each file of '
        '`contact_estimation/foreign_laws` gives equation and source.', _table(head, rows)])


def columns_page() -> str:
    """Return the page with a row for every column of the fleet's table."""
    rows = [(f'`{column.name}`', column.kind, column.unit, column.meaning) for column in COLUMNS]
    return '\n\n'.join([
        '# Columns of the table', 'Of `table.parquet`, which [](../fleet.md) describes.',
        _table(('column', 'type', 'unit', 'meaning'), rows)])


def parameter_table(group: Any) -> str:
    """Return a Markdown table of the parameters of a group: name, default, unit, meaning."""
    rows = [(f'`{spec.name}`', _default(spec.default), spec.unit, spec.description)
            for spec in specifications(group)]
    return _table(('parameter', 'default', 'unit', 'meaning'), rows)


def _default(value: Any) -> str:
    if isinstance(value, float):
        return f'{value:g}' if isfinite(value) else 'off'
    return f'{value}'


def _first_line(cls: Any) -> str:
    """Return the summary of the module that defines a class."""
    text = sys.modules[cls.__module__].__doc__ or ''
    return text.strip().splitlines()[0]


def _table(head: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    lines = [list(head), ['---'] * len(list(head)), *[list(row) for row in rows]]
    return '\n'.join('| ' + ' | '.join(line) + ' |' for line in lines)


def _write(path: Path, text: str) -> None:
    """Write a page if it changed, so that Sphinx rebuilds no more than needed."""
    text += '\n'
    if not path.exists() or path.read_text() != text:
        path.write_text(text)
