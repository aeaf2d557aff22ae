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


"""The report as text for a terminal."""

from __future__ import annotations

from math import isfinite

from .wording import (
    headline,
    improvement,
    place_of,
    PORTS,
    remainder,
    share_of,
    significant,
    tested_dependences,
    trifle,
)
from ..conclude.naming import listed
from ..conclude.result import Diagnosis, Errors, NamedEffect, Value

_MODELS = ('nominal', 'recalibrated', 'corrected')
_BETWEEN = {'smooth': 'smooth', 'held': 'held constant'}


def as_text(diagnosis: Diagnosis) -> str:
    """
    Return the report as text.

    Parameters
    ----------
    diagnosis : Diagnosis
        The result.

    Returns
    -------
    text : str
        Failed checks, verdict, effects, what they leave, model parameters, held-out errors,
        location of the mismatch, course of inputs between samples, next experiment.

    """
    d = diagnosis
    failed = _failed_checks(d)
    if d.refused:
        return '\n\n'.join('\n'.join(lines) for lines in (failed, _verdict(d)))
    sections = [failed, _verdict(d), *(_effect(effect) for effect in d.effects), _remainder(d),
                _parameters(d), _held_out(d), _location(d), _how_it_was_read(d)]
    if d.next_experiment:
        sections.append([f'Next experiment: {d.next_experiment}'])
    return '\n\n'.join('\n'.join(lines) for lines in sections if lines)


def _failed_checks(d: Diagnosis) -> list[str]:
    return [f'Check {check.name}: {check.text}' for check in d.checks if not check.ok]


def _verdict(d: Diagnosis) -> list[str]:
    sentence = headline(d)
    lines = [f'{d.verdict.replace("_", " ")}: {sentence[0].lower()}{sentence[1:]}.']
    if d.verdict == 'physics_missing':
        lines.append('Recalibrating K_e and B_e alone cannot explain the recording.')
    left = trifle(d)
    return [*lines, f'{left}.'] if left else lines


def _effect(effect: NamedEffect) -> list[str]:
    values = ', '.join(f'{name} = {_with_std(value)}{_unit(value)}'
                       for name, value in effect.parameters.items())
    lines = [
        f'{effect.name} ({PORTS[effect.port]}), family {effect.family}, '
        f'probability {effect.probability:.3f}',
        f'  {effect.equation}',
        f'  {values}',
        f'  {share_of(effect)}',
    ]
    if len(effect.parts) > 1:
        lines.append(f'  fitted on each of {len(effect.parts)} parts alone: {_ranges(effect)}')
    lines.append(f'  visible {place_of(effect.location)}')
    if effect.indistinguishable_from:
        names = listed(effect.indistinguishable_from)
        lines.append(f'  this recording cannot distinguish it from {names}')
    return lines


def _ranges(effect: NamedEffect) -> str:
    """Give the least and greatest value of each parameter over the parts."""
    texts = []
    for name, value in effect.parameters.items():
        found = [part.parameters[name] for part in effect.parts]
        texts.append(f'{name} = {min(found):.3g} to {max(found):.3g}{_unit(value)}')
    return ', '.join(texts)


def _remainder(d: Diagnosis) -> list[str]:
    sentence = remainder(d)
    return [f'{sentence}.'] if sentence else []


def _unit(value: Value) -> str:
    return '' if value.unit in ('', '1') else f' {value.unit}'


def _with_std(value: Value) -> str:
    """Format a value; one at the limit of its range has no standard deviation."""
    return f'{value.value:.6g}' + (f' +- {value.std:.2g}' if isfinite(value.std) else '')


def _parameters(d: Diagnosis) -> list[str]:
    lines = [_row('Model parameters', *_MODELS)]
    symbols = (('K_e [N/m]', d.stiffness), ('B_e [N s/m]', d.damping))
    for place, (symbol, corrected) in enumerate(symbols):
        last = _with_std(corrected) if d.corrected.free[place] else 'replaced by the effect'
        lines.append(_row(f'  {symbol}', f'{d.nominal.values[place]:.6g}',
                          f'{d.recalibrated.values[place]:.6g}', last))
    if d.nominal.with_inertia:
        masses = (f'{getattr(d, name).values[2]:.6g}' for name in _MODELS)
        lines.append(_row('  M_e [kg]', *masses))
    return lines


def _held_out(d: Diagnosis) -> list[str]:
    lines = [_row('Held-out errors (rms)', *_MODELS),
             _row('  force [N]', *_numbers(d.force, 1.0))]
    if d.motion.nominal is not None:
        lines.append(_row('  free-run position [um]', *_numbers(d.motion, 1e6)))
    lines.append(f'  force noise {d.noise_floor:.3g} N; held out: '
                 + ', '.join(part.name for part in d.holdouts))
    if improvement(d):
        lines.append(f'  {improvement(d)}')
    return lines


def _row(label: str, *cells: str) -> str:
    first, second, last = cells
    return f'{label:<26}{first:>13}{second:>14}   {last}'


def _numbers(errors: Errors, factor: float) -> list[str]:
    values = (errors.nominal, errors.recalibrated, errors.corrected)
    return ['-' if value is None else f'{factor * value:.4g}' for value in values]


def _location(d: Diagnosis) -> list[str]:
    """Describe where the mismatch sits and on what the residuals depend."""
    if d.location is None:
        return []
    lines = []
    if d.verdict == 'unexplained':
        which = 'Mismatch of the recalibrated model' if d.effects else 'Unexplained mismatch'
        lines.append(f'{which}: {PORTS[d.location.port]}, {place_of(d.location)}')
    if len(d.recordings) > 1:
        lines.append(f'All times are those of {d.shown}, the recording explained worst.')
    tested = tested_dependences(d)
    if tested:
        lines.append(f'Share of the {d.located_channel} residuals explained by')
        lines += [f'  {name + " model:":<20}{significant(found)}'
                  for name, found in tested.items()]
    return lines


def _how_it_was_read(d: Diagnosis) -> list[str]:
    lines = []
    if d.rests_left_out:
        lines.append('Where the drive stands still was left out: friction holds any force there.')
    if d.between_samples in _BETWEEN:
        lines.append(f'Between its samples the force is {_BETWEEN[d.between_samples]}; straight '
                     'lines explain less.')
    elif d.holds_reference:
        lines.append('The robot holds its reference between setpoints; straight lines explain '
                     'its motion less.')
    return lines
