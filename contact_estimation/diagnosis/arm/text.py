# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The report of an arm as text, as plain data and as a page."""

from math import isfinite
from typing import Any

import numpy as np

from .arm_recording import Array
from .result import ArmDiagnosis, ArmEffect
from ..report.json_report import as_dict as contact_dict, finite
from ..report.page import rendered
from ..report.text_report import as_text as contact_text
from ..result import Value
from ...figures import BLUE, figure_style, GREY, INK, MUTED, new_figure, ORANGE
from ...kinematics.arm_dynamics import ArmDynamics

_COLUMNS = (('joint', '<24'), ('verdict', '<16'), ('range', '>9'), ('nominal', '>9'),
            ('recalibr.', '>10'), ('corrected', '>10'), ('explained', '>10'),
            ('F_c', '>9'), ('B', '>9'))
_LISTED = 3  # joints
_PLAIN = ('coulomb_friction', 'viscous_friction')


def headline(d: ArmDiagnosis) -> str:
    """Return the verdict as one plain sentence, without a full stop."""
    if d.refused:
        wrong = ' and '.join(one.name.replace('_', ' ') for one in d.checks if one.fatal)
        return f'Fix this first: {wrong}'
    names = ', '.join(dict.fromkeys(_named(d)))
    bad = ', '.join(one.name for one in d.joints if one.verdict == 'unexplained')
    if d.verdict == 'unexplained':
        lacks = f'lacks {names}; ' if names else ''
        return f'The description {lacks}no law explains the torque of {bad}'
    return {'physics_missing': f'The description lacks {names}',
            'recalibrate': 'The description has the right physics; links that differ by some 5 % '
            'explain the torques',
            'consistent': 'The description explains the torques'}[d.verdict]


def _named(d: ArmDiagnosis) -> list[str]:
    """Return names with places; plain friction once, with all its joints."""
    plain = list(dict.fromkeys(joint for one in d.effects if one.name in _PLAIN
                               for joint in one.joints))
    names = [f'{one.name.replace("_", " ")} at {one.place}' for one in d.effects
             if one.name not in _PLAIN]
    return names + ([f'friction at {", ".join(plain)}'] if plain else [])


def as_text(d: ArmDiagnosis) -> str:
    """Return the report as text for a terminal."""
    sentence = headline(d)
    sections = [[f'Check {one.name}: {one.text}' for one in d.checks if not one.ok],
                [f'{d.verdict.replace("_", " ")}: {sentence[0].lower()}{sentence[1:]}.']]
    sections += [_effect(one) for one in d.effects]
    if d.joints:
        sections.append(_joints(d))
    sections += [_held_out(d)] if d.holdouts else []
    if d.apparent_mass:
        sections.append(['Apparent mass of the tip along the direction in which it presses: '
                         '{:.3g} kg ({:.3g} to {:.3g} kg)'.format(*d.apparent_mass)])
    sections.append([f'Check {one.name}: {one.text}' for one in d.checks if not one.tested])
    if d.next_experiment:
        sections.append([f'Next experiment: {d.next_experiment}.'])
    if d.contact is not None:
        sections += [['What the tip touches:'], [contact_text(d.contact)]]
    return '\n\n'.join('\n'.join(lines) for lines in sections if lines)


def _effect(one: ArmEffect) -> list[str]:
    values = ', '.join(f'{name} = {value_text(value)}' for name, value in one.parameters.items())
    lines = [f'{one.name} at {one.place}, family {one.family}, probability {one.probability:.3f}',
             f'  {one.equation}', f'  {values}']
    shares = sorted(one.torque_shares.items(), key=lambda pair: -pair[1])
    lines.append('  its torque over that of the joint, as mean squares: ' + ', '.join(
        f'{joint} {100.0 * share:.1f} %' for joint, share in shares[:_LISTED]))
    times = ', '.join(f'{first:.1f} to {last:.1f} s' for first, last in one.intervals_s)
    lines.append(f'  largest in {one.region}' + (f' ({times})' if times else ''))
    if one.indistinguishable_from:
        lines.append('  this recording cannot distinguish it from '
                     + ', '.join(one.indistinguishable_from))
    return lines + [f'  {one.note}'] * bool(one.note)


def value_text(value: Value) -> str:
    """Format a value with its standard deviation and unit."""
    std = f' +- {value.std:.2g}' if isfinite(value.std) else ''
    unit = '' if value.unit in ('', '1') else f' {value.unit}'
    return f'{value.value:.4g}{std}{unit}'


def _joints(d: ArmDiagnosis) -> list[str]:
    lines = ['Errors of torques on blocks left out (rms [N m]), the share of their variance that '
             'is explained, and the nearest Coulomb [N m] and viscous friction [N m s/rad]',
             _row([name for name, _ in _COLUMNS])]
    for one in d.joints:
        lines.append(_row([
            one.name, one.verdict.replace('_', ' '),
            *(f'{value:.3g}' for value in (
                one.torque_range, one.nominal, one.recalibrated, one.corrected)),
            f'{100.0 * one.share:.1f} %', *(f'{value:.3g}' for value in one.friction)]))
    return lines + [f'{name}: {reason}' for name, reason in d.left_out.items()]


def _row(cells: list[str]) -> str:
    return '  ' + ''.join(f'{cell:{width}}' for cell, (_, width) in zip(cells, _COLUMNS)).rstrip()


def _held_out(d: ArmDiagnosis) -> list[str]:
    lines = ['Share of the torque explained in recordings that were not fitted, while the joint '
             'moves (with its rests, where friction may hold anything)']
    for one in d.holdouts:
        lines += [f'  {one.name}: ' + ', '.join(
            f'{joint} {100.0 * share:.1f} % ({100.0 * one.with_rests[joint]:.1f} %)'
            for joint, share in one.corrected.items())]
    return lines


def as_dict(d: ArmDiagnosis) -> dict[str, Any]:
    """Return the report as nested dictionaries, ready for JSON."""
    return finite({
        'verdict': d.verdict,
        'headline': headline(d),
        'effects': [_effect_dict(one) for one in d.effects],
        'joints': [{
            'name': one.name, 'verdict': one.verdict, 'torque_range_nm': one.torque_range,
            'torque_rmse_nm': {'nominal': one.nominal, 'recalibrated': one.recalibrated,
                               'corrected': one.corrected},
            'friction': {'F_c': one.friction[0], 'B': one.friction[1]},
            'noise_nm': one.noise, 'share': one.share, 'share_nominal': one.share_nominal,
            'remainder': {'share': 1.0 - one.share, 'torque_nm': one.corrected},
        } for one in d.joints],
        'joints_left_out': d.left_out,
        'checks': [{'name': one.name, 'ok': one.ok, 'text': one.text, 'fatal': one.fatal}
                   for one in d.checks],
        'fit': {'holdouts': [{'name': one.name, 'share': one.corrected,
                              'share_nominal': one.nominal,
                              'share_with_rests': one.with_rests} for one in d.holdouts]},
        'next_experiment': {'text': d.next_experiment} if d.next_experiment else None,
        'apparent_mass_kg': d.apparent_mass and dict(
            zip(('mean', 'least', 'most'), d.apparent_mass)),
        'contact': d.contact and contact_dict(d.contact),
    })


def _effect_dict(one: ArmEffect) -> dict[str, Any]:
    return {
        'name': one.name, 'family': one.family, 'port': 'robot', 'place': one.place,
        'joint': one.joints[0] if len(one.joints) == 1 and not one.link else None,
        'joints': list(one.joints), 'link': one.link or None, 'recording': one.recording or None,
        'probability': one.probability, 'equation': one.equation, 'share': one.share,
        'share_interval': list(one.share_interval), 'torque_shares': one.torque_shares,
        'evidence_nat': one.gain,
        'parameters': {name: vars(value) for name, value in one.parameters.items()},
        'indistinguishable_from': one.indistinguishable_from,
        'location': {'intervals_s': [list(pair) for pair in one.intervals_s],
                     'region': one.region},
        'note': one.note,
    }


_WIDTH = 4.8  # [inch], as of the figures of a contact
_MOST_POINTS = 1500
_VIEW = np.array([[0.8, -0.6, 0.0], [-0.25, -0.33, 0.91]])  # axes of the picture in space
_LACKS_MOST = 0.5  # of a torque, which has the darkest colour


def as_html(d: ArmDiagnosis, title: str) -> str:
    """Build the page."""
    arm, joints, torques = (plot(d) if d.joints and d.channels is not None else None
                            for plot in (plot_arm, plot_joints, plot_torques))
    return rendered(
        'arm.html', d, title=title, headline=headline(d), value_text=value_text,
        contact=d.contact and contact_text(d.contact), arm=arm, joints=joints, torques=torques,
        tested=[f'in {one.name} [%]' for one in d.holdouts])


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
