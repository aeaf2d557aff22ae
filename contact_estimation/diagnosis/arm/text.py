# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The report of an arm as text and as plain data."""

from __future__ import annotations

from math import isfinite
from typing import Any

from .result import ArmDiagnosis, ArmEffect
from ..report.json_report import as_dict as contact_dict, finite
from ..report.text_report import as_text as contact_text
from ..result import Value

_COLUMNS = (('joint', '<24'), ('verdict', '<16'), ('range', '>9'), ('nominal', '>9'),
            ('recalibr.', '>10'), ('corrected', '>10'), ('explained', '>10'),
            ('F_c', '>9'), ('B', '>9'))
_LISTED = 3  # joints
_PLAIN = ('coulomb_friction', 'viscous_friction')


def headline(d: ArmDiagnosis) -> str:
    """Return the verdict as one plain sentence, without a full stop."""
    if d.refused:
        wrong = ' and '.join(one.name.replace('_', ' ') for one in d.checks
                             if one.fatal and not one.ok)
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
        'parameters': {name: {'value': value.value, 'std': value.std, 'unit': value.unit}
                       for name, value in one.parameters.items()},
        'indistinguishable_from': one.indistinguishable_from,
        'location': {'intervals_s': [list(pair) for pair in one.intervals_s],
                     'region': one.region},
        'note': one.note,
    }
