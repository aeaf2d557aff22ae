# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
Sphinx extension: write the pages that follow from the code.

`generated/effects_<port>.md` has one section per entry of EFFECTS, `generated/tuning.md` one
table per entry of ESTIMATORS, `generated/foreign_laws.md` one row per law of blind trials,
`generated/fleet_columns.md` one per column of the fleet's table: a new entry appears without an
edit here. `warnings.md`, one row per entry of CHECKS and REJECTIONS, is part of the checkout:
`python doc/generated_pages.py` writes it too.

"""

from __future__ import annotations

from math import isfinite
from pathlib import Path
import sys
from typing import Any

import contact_estimation as ce
from contact_estimation.fleet.table import COLUMNS
from contact_estimation.parameters import specifications
from contact_estimation.pipeline.checks import CHECKS, REJECTIONS
from contact_estimation.pipeline.checks.stream_checks import graph_warnings
from contact_estimation.studies.blind_trials.foreign_laws import ALL_LAWS
from contact_estimation.texts import markdown_table
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
    _write(folder.parent / 'warnings.md', warnings_page())
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
        parameter_table(cls),
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
        '`contact_estimation/studies/blind_trials/foreign_*.py` gives equation and source.',
        markdown_table(head, rows)])


WARNINGS = '''# Warnings

The node checks what it is given and says what is wrong, with the remedy: as the message of its
status in `/diagnostics` (level WARN; the most important first, all of them as `warning_1`,
`warning_2`, ...), in its log (at once, then every 10 s), and where a warning withholds estimates,
in `~/status`. `replay` prints the warnings of a recording (`warnings` in its JSON), and its exit
status is 1 if nothing could be estimated. A silent wrench topic is level ERROR.

While a warning *withholds* estimates, the status is `frozen` in contact, the estimator learns
nothing, and all standard deviations are NaN: K_hat and B_hat are then the values from before.
The checks use the last 2 s and depend on the samples alone. They run twice a second from a touch on, and less often,
but at least every 2 s, while they find nothing.
`python -m contact_estimation.studies online --only healthy` counts false warnings in healthy worlds.

## Signals

Numbers are examples. The first active row is the headline.'''

DESCRIPTION = (
    ('`revolute_joint`', "joint 'elbow_joint' turns, says the robot description: its positions are "
     'angles and not metres, and no estimate holds; for an arm set kinematics.base, '
     'kinematics.tip and contact.normal',
     'A joint of an arm was chosen as the contact axis; seen where `robot_description` is published.',
     'Set the parameters of an arm, see [](your_robot.md).', 'published'),
    ('`robot_description_changed`', 'the robot description on /robot_description has changed and '
     'is not used; start the node again to use it', 'Another robot, or another version of it.',
     'Start the node again.', 'published'),
)

STABILITY = (
    ('`stability`', 'the admittance has a phase margin of 20 deg, less than 45, on this wall '
     '(stable to 3.2e+04 N/m); raise stability.damping (B_t) to 560 N s/m',
     'The gains of `stability.*` are too weak, or their delay too long, for K_e as estimated.',
     'Change the gains of the controller; see [](stable_gains.md).', 'published'),
)

GRAPH = (
    ('`several_publishers_wrench`, `several_publishers_joint_states`',
     'A second driver, or a recording that is played beside the live one. Joint states of an arm, '
     'or beside those of other joints, may come from several.',
     'Stop or remap all but one.', 'published'),
    ('`node_name`', 'The node was started twice.',
     'Stop one, or start it under another name (`-r __node:=NAME`).', 'published'),
)

LIMITS = '''## What no check sees

- A lag of a few milliseconds: `synchronisation.timing_std` stands for it in the deviation of B_hat.
- A lag in a contact that moves little and slowly, until more motion comes: there a lag acts like
  another damping and stiffness, or like a mass. A warning needs a chi-squared of 40 in two consecutive
  checks, so that other physics is not taken for a lag. A lag of 50 ms, or of 5 ms in a quick
  touch-down, is found within 2 s.
- A lag where the noise of positions or velocities hides the motion: regressions take that noise into account,
  and where the motion is not clearly above it, lags are not checked.
- Which of two sources of one topic is right; and two sources whose levels are less than eight standard
  deviations of their noise apart.
- At what time within a contact the zero of the sensor stepped: the free flights before and after bound it.
- A wall that is off by less than three `environment.location_std`: this is found and corrected
  where the motion shows it.
- A revolute joint taken for the contact axis, where `environment.location` is nan and no
  `robot_description` is published: its angles look like metres.
- A force that is wrong by a factor, or in other units that still look like newtons.'''


# What sessions say of each kind of rejected message.
EXAMPLES = {
    'arm': 'no joint state has elbow_joint, which moves tool_tip relative to base_link; check '
           'joint_states and kinematics.*',
    'frame': "expected 'tool0', got 'wrist_3_link'; set frame_id",
    'joint': "joint 'contact_axis' is not in the message, which has 'cx', 'cy'; choose one of these "
             'with the parameter joint or --joint',
    'malformed': '12 bytes are not a geometry_msgs/msg/WrenchStamped: it ends in a field that '
                 'needs 16 bytes; check that publisher and subscriber use the same message '
                 'definition',
}
LAG = 'none has come; is joint_states published, or remapped?'


def warnings_page() -> str:
    """Return the page with a row for every warning."""
    head = ('check', 'message', 'cause', 'remedy', 'estimates')
    rows = [(f'`{check.name}`', check.message, check.cause, check.remedy,
             'withheld' if check.invalidates else 'published') for check in CHECKS]
    texts = graph_warnings({'/wrench': ['/ft_driver', '/rosbag2_player']}, '/estimator_node',
                           ['/estimator_node'] * 2).values()
    rejected = [(f'`{one.name}`', one.message.format(
        count=40, topic='wrench', text=EXAMPLES.get(one.name, '...'), lag=LAG),
        one.cause, one.remedy) for one in REJECTIONS]
    return '\n\n'.join([
        WARNINGS, markdown_table(head, rows),
        '## Rejected messages\n\nMessages that cannot be used are counted by reason in '
        '`/diagnostics`. Where they keep the node from estimating, the headline says why.',
        markdown_table(head[:4], rejected),
        '## Robot description', markdown_table(head, DESCRIPTION),
        '## Stability\n\nOf the node alone, with `stability.kind`.', markdown_table(head, STABILITY),
        '## Graph\n\nOf the node alone, looked at once a second.',
        markdown_table(head, [(name, text, *rest) for (name, *rest), text in zip(GRAPH, texts)]), LIMITS])


def columns_page() -> str:
    """Return the page with a row for every column of the fleet's table."""
    rows = [(f'`{column.name}`', column.kind, column.unit, column.meaning) for column in COLUMNS]
    return '\n\n'.join([
        '# Columns of the table', 'Of `table.parquet`, which [](../fleet.md) describes.',
        markdown_table(('column', 'type', 'unit', 'meaning'), rows)])


def parameter_table(group: Any) -> str:
    """Return a Markdown table of the parameters of a group: name, default, unit, meaning."""
    rows = [(f'`{spec.name}`', _default(spec.default), spec.unit, spec.description)
            for spec in specifications(group)]
    return markdown_table(('parameter', 'default', 'unit', 'meaning'), rows)


def _default(value: Any) -> str:
    if isinstance(value, float):
        return f'{value:g}' if isfinite(value) else 'off'
    return f'{value}'


def _first_line(cls: Any) -> str:
    """Return the summary of the module that defines a class."""
    text = sys.modules[cls.__module__].__doc__ or ''
    return text.strip().splitlines()[0]


def _write(path: Path, text: str) -> None:
    """Write a page if it changed, so that Sphinx rebuilds no more than needed."""
    text += '\n'
    if not path.exists() or path.read_text() != text:
        path.write_text(text)


if __name__ == '__main__':
    _write(Path(__file__).parent / 'warnings.md', warnings_page())
