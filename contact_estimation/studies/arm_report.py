# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Table and pictures of the study on simulated arms."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Mapping, Sequence

import numpy as np

from .arm_files import ArmFiles, tool_parameters
from .arm_models import mujoco, mujoco_model, SENSOR, TIP
from .arm_simulation import Run, TIMESTEP, World
from ..figures import BLUE, figure_style, GREY, INK, new_figure, ORANGE
from ..pipeline.replay import RecordingReplay
from ..recordings import RecordingReader
from ..recordings.source import RecordingSource
from ..texts import markdown_table as _table

_AXES = (('x', ORANGE), ('y', '#2f855a'), ('z', BLUE))
_AXIS_M = 0.12  # length of drawn axes
_PER_PLOT = 5  # samples to one plotted


def as_markdown(results: Mapping[str, Any]) -> str:
    """Return the tables of the study."""
    tool = [[row['arm'], row['seed'], f'{row["mass_error_g"]:+.2f} +- {row["mass_std_g"]:.2f}',
             f'{row["centre_error_mm"]:.3f} +- {row["centre_std_mm"]:.3f}',
             f'{row["bias_error_n"]:.3f}'] for row in results['tool']]
    contact = [[row['arm'], row['estimator'], row['compensation'],
                _pair(row, 'stiffness'), _pair(row, 'damping'),
                f'{row["location_error_mm"]:+.2f}', row['withheld'] or 'to the end',
                ', '.join(row['warnings']) or 'none']
               for row in results['contact']]
    parts = [
        _table(('arm', 'seed', 'error of the mass [g]', 'worst error of the centre [mm]',
                'worst error of the force bias [N]'), tool),
        _table(('arm', 'estimator', 'taken out of the force', 'error of K_e [%]',
                'error of B_e [%]', 'error of x_e [mm]', 'estimated until', 'warnings'), contact),
        _table(('arm', 'kinematics, processor time [us a sample]', 'to filterpy predict + update'),
               [[row['arm'], f'{row["kinematics_us"]:.1f}', f'{row["to_filterpy"]:.2f}']
                for row in results['cost']]),
    ]
    if results['diagnosis']:
        parts.append(_table(('arm', 'concealed', 'right first name', 'no other port named',
                             'names (number of seeds)'), _diagnoses(results['diagnosis'])))
    return '\n\n'.join(parts) + '\n'


def _pair(row: Mapping[str, Any], name: str) -> str:
    error, std = row[f'{name}_error_percent'], row[f'{name}_std_percent']
    return f'{error:+.2f} +- {std:.2f}'


def _diagnoses(rows: Sequence[Mapping[str, Any]]) -> list[list[Any]]:
    table = []
    for arm, concealed in dict.fromkeys((row['arm'], row['concealed']) for row in rows):
        own = [row for row in rows if (row['arm'], row['concealed']) == (arm, concealed)]
        counts: dict[str, int] = {}
        for name in (name for row in own for name in row['names']):
            counts[name] = counts.get(name, 0) + 1
        named = ', '.join(f'{name} ({count})' for name, count in counts.items()) or 'none'
        table.append([arm, concealed, f'{sum(row["right"] for row in own)} of {len(own)}',
                      f'{sum(row["alone"] for row in own)} of {len(own)}', named])
    return table


@figure_style()
def plot_contact(
    path: Path, files: ArmFiles, run: Run, recording: Path, tool: Path, world: World
) -> None:
    """Plot the force with and without the tool, and the estimates of a run."""
    whole = tool_parameters(tool)
    rows = _estimates(files, run, recording, whole)
    figure, axes = new_figure((7.0, 5.2), rows=3, sharex=True)
    t = np.arange(len(run.force))[::_PER_PLOT] * TIMESTEP
    for values, color, label in (
        (files.force_along_normal(run, {}), GREY, 'measured, with the tool'),
        (files.force_along_normal(run, whole), BLUE, 'compensated'),
        (run.force, INK, 'true F_e'),
    ):
        axes[0].plot(t, values[::_PER_PLOT], color=color, label=label, linewidth=0.8,
                     linestyle='--' if color == INK else '-')
    axes[0].set(ylabel='force along normal [N]', title=f'{files.arm.name}: three touches')
    axes[0].legend(ncols=3, loc='lower left')
    for axis, column, truth, unit in (
        (axes[1], 1, world.K_e, 'K_e [N/m]'), (axes[2], 3, world.B_e, 'B_e [N s/m]'),
    ):
        value, std = rows[:, column], rows[:, column + 1]
        axis.fill_between(rows[:, 0], value - 2 * std, value + 2 * std, color=BLUE, alpha=0.2,
                          linewidth=0)
        axis.plot(rows[:, 0], value, color=BLUE)
        axis.axhline(truth, color=INK, linestyle='--', linewidth=0.8)
        axis.set(ylabel=unit, ylim=(0.6 * truth, 1.4 * truth))
    axes[2].set(xlabel='time [s]')
    figure.savefig(path)


def _estimates(
    files: ArmFiles, run: Run, recording: Path, tool: Mapping[str, Any]
) -> np.ndarray:
    """Return t, K_hat, its deviation, B_hat and its deviation, (N, 5)."""
    replay = RecordingReplay(
        RecordingReader(recording), RecordingSource(), {**files.parameters(run), **tool})
    values = np.array([
        (estimate.stamp_ns, estimate.stiffness, estimate.stiffness_std, estimate.damping,
         estimate.damping_std) for batch in replay.estimates() for (estimate,) in batch
    ], float)[::_PER_PLOT]
    values[:, 0] = (values[:, 0] - values[0, 0]) * 1e-9
    return values


@figure_style()
def plot_frames(path: Path, files: ArmFiles, run: Run) -> None:
    """Draw the arm at the wall with the frames that the parameters name."""
    model = mujoco_model(files.description.read_text(), 1e-3)
    data = mujoco().MjData(model)
    data.qpos[:] = run.q[int(np.argmin(run.force))]
    mujoco().mj_forward(model, data)
    names = [model.body(k).name for k in range(model.nbody)]
    chain = [data.body(name).xpos for name in names[1:] if name not in ('base', 'ee_link')]
    figure, axis = new_figure((6.0, 5.0), subplot_kw={'projection': '3d'})
    axis.plot(*np.array(chain).T, color=GREY, linewidth=4, solid_capstyle='round')
    tip = data.site(TIP).xpos
    frames = {'kinematics.base': data.body(files.arm.base), 'force_sensor.frame':
              data.body(SENSOR), 'kinematics.tip': data.body(TIP)}
    for name, body in frames.items():
        for column, (_, color) in zip(body.xmat.reshape(3, 3).T, _AXES):
            axis.quiver(*body.xpos, *(_AXIS_M * column), color=color, linewidth=1.5)
        axis.text(*(body.xpos + [0.03, -0.05, 0.0]), name, fontsize=8, color=INK)
    axis.quiver(*tip, *(2 * _AXIS_M * run.normal), color=INK, linewidth=2)
    axis.text(*(tip + 2.2 * _AXIS_M * run.normal), 'contact.normal', fontsize=8, color=INK)
    _draw_wall(axis, tip, run.normal)
    axis.view_init(elev=18, azim=-80)
    axis.set_box_aspect(np.ptp([*chain, tip + 0.2 * run.normal], axis=0) + 0.2)
    axis.set(xlabel='x [m]', ylabel='y [m]', zlabel='z [m]',
             title=f'{files.arm.name} at the wall; axes x orange, y green, z blue')
    figure.savefig(path)


def _draw_wall(axis: object, tip: np.ndarray, normal: np.ndarray) -> None:
    tangents = np.linalg.svd(normal[None])[2][1:]
    corners = np.array([[-1, 1], [-1, 1]]) * 0.15
    u, v = np.meshgrid(*corners)
    surface = tip[:, None, None] + tangents[0][:, None, None] * u + (
        tangents[1][:, None, None] * v)
    axis.plot_surface(*surface, color=ORANGE, alpha=0.25)  # type: ignore[attr-defined]
