# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The report of an arm as one HTML page with its figures."""

from __future__ import annotations

from typing import Any

import numpy as np

from .arm_recording import Array
from .result import ArmDiagnosis
from .text import headline, value_text
from ..report.page import environment
from ..report.text_report import as_text as contact_text
from ...figures import BLUE, figure_style, GREY, INK, MUTED, new_figure, ORANGE
from ...kinematics.arm_dynamics import ArmDynamics

_WIDTH = 4.8  # [inch], as of the figures of a contact
_MOST_POINTS = 1500
_VIEW = np.array([[0.8, -0.6, 0.0], [-0.25, -0.33, 0.91]])  # axes of the picture in space
_LACKS_MOST = 0.5  # of a torque, which has the darkest colour


def as_html(d: ArmDiagnosis, title: str) -> str:
    """Build the page."""
    verdict = 'recording refused' if d.refused else d.verdict.replace('_', ' ')
    template = environment('contact_estimation.diagnosis.report').get_template('arm.html')
    shown = d.joints and d.channels is not None
    return template.render(
        d=d, title=title, verdict=verdict, headline=headline(d), value_text=value_text,
        contact=d.contact and contact_text(d.contact),
        failed=[one for one in d.checks if not one.ok],
        passed=[one for one in d.checks if one.ok],
        arm=plot_arm(d) if shown else None, joints=plot_joints(d) if shown else None,
        torques=plot_torques(d) if shown else None)


@figure_style()
def plot_arm(d: ArmDiagnosis) -> Any:
    """Draw the arm in the middle of its motion, joints coloured by what they lack."""
    assert d.channels is not None
    arm: ArmDynamics = d.channels.arm
    points = _apart(arm.frame_positions(d.channels.middle) @ _VIEW.T)
    figure, axis = new_figure((1.2 * _WIDTH, 3.6))
    axis.plot(*points.T, color=MUTED, linewidth=6.0, solid_capstyle='round', zorder=1)
    lacks = {one.name: max(0.0, one.share - one.share_nominal) for one in d.joints}
    known = [k for k, name in enumerate(arm.joints) if name in lacks]
    dots = axis.scatter(*points[1:-1][known].T, c=[lacks[arm.joints[k]] for k in known],
                        cmap='OrRd', s=90, vmin=0.0, vmax=_LACKS_MOST, edgecolors=INK, zorder=3)
    bad = {one.name for one in d.joints if one.verdict == 'unexplained'}
    heights = np.linspace(0.03, 0.93, len(arm.joints))
    for name, link, at, height in zip(arm.joints, arm.links, points[1:-1], heights):
        laws = [one.name.replace('_', ' ') for one in d.effects if one.link == link or (
            not one.link and one.term.place is not None and name in one.joints)]
        laws += ['unexplained'] * (name in bad)
        text = axis.annotate(
            '\n'.join([name, ', '.join(laws)]), at, xytext=(1.1, height), fontsize=6, va='center',
            textcoords='axes fraction', annotation_clip=False,
            color=ORANGE if name in bad else INK,
            arrowprops={'arrowstyle': '-', 'color': MUTED, 'linewidth': 0.5, 'relpos': (0.0, 0.5)})
        text.set_in_layout(False)  # it may stand beside the axes
    axis.set_aspect('equal', adjustable='datalim')
    axis.set_axis_off()
    bar = figure.colorbar(dots, ax=axis, location='bottom', shrink=0.8, pad=0.02, extend='max')
    bar.set_label('share of torque that is lacking', fontsize=7)
    figure.get_layout_engine().set(rect=(0.0, 0.0, 0.42, 1.0))
    return figure


def _apart(points: Array) -> Array:
    """Move joints that coincide in the picture a little apart."""
    size, moved = float(np.ptp(points, axis=0).max()), points.copy()
    for k in range(1, len(points)):
        while np.linalg.norm(moved[:k] - moved[k], axis=1).min() < 0.06 * size:
            moved[k] += (0.07 * size, 0.02 * size)
    return moved


@figure_style()
def plot_joints(d: ArmDiagnosis) -> Any:
    """Plot the errors of all joints over the range of their torques."""
    figure, axis = new_figure((_WIDTH, 0.9 + 0.42 * len(d.joints)))
    for offset, name, colour in ((-0.27, 'nominal', GREY), (0.0, 'recalibrated', ORANGE),
                                 (0.27, 'corrected', BLUE)):
        axis.barh([k + offset for k in range(len(d.joints))],
                  [100.0 * getattr(one, name) / one.torque_range for one in d.joints],
                  height=0.25, color=colour, label=name)
    axis.set_yticks(range(len(d.joints)), [one.name for one in d.joints])
    axis.invert_yaxis()
    axis.grid(False, axis='y')
    axis.set_xlabel('error on blocks left out [% of the range of the torque]')
    figure.legend(*axis.get_legend_handles_labels(), ncols=3, loc='outside upper left')
    return figure


@figure_style()
def plot_torques(d: ArmDiagnosis) -> Any:
    """Plot each joint's torque, recorded and simulated, along the first piece."""
    assert d.channels is not None
    piece, joints = d.channels.pieces[0], d.channels.measured
    figure, axes = new_figure((2.0 * _WIDTH, 1.3 * len(joints) + 0.5), len(joints), squeeze=False,
                              sharex=True)
    some = slice(None, None, max(1, len(piece.t) // _MOST_POINTS))
    for axis, j in zip(axes[:, 0], joints):
        nominal = piece.tau[:, j] - piece.residual[:, j]
        axis.plot(piece.t[some], piece.tau[some, j], color=INK, linewidth=2.4, alpha=0.35,
                  label='recorded')
        axis.plot(piece.t[some], nominal[some], color=GREY, linewidth=0.9, label='description',
                  linestyle=(0, (4, 2)))
        axis.plot(piece.t[some], (nominal + d.predicted(piece, j))[some], color=BLUE,
                  linewidth=0.9, label='corrected')
        axis.set_ylabel(f'{d.channels.arm.joints[j]}\n[N m]', fontsize=7)
    axes[-1, 0].set_xlabel('time [s]')
    figure.legend(*axes[0, 0].get_legend_handles_labels(), ncols=3, loc='outside upper left')
    return figure
