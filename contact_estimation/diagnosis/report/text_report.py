# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The report as text for a terminal."""

from math import isfinite

from .wording import (
    headline, how_it_was_read, improvement, mismatch, MODELS, negligible, place_of, PORTS,
    remainder, share_of, significant, tested_dependences)
from ..next_experiment import listed
from ..observe.model import names_of
from ..result import Diagnosis, Errors, NamedEffect, Value


def as_text(diagnosis: Diagnosis) -> str:
    """Return the report as text."""
    d = diagnosis
    sections = [[f'Check {check.name}: {check.text}' for check in d.checks if not check.ok],
                _verdict(d)]
    if not d.refused:
        rest = remainder(d)
        sections += [*map(_effect, d.effects), [f'{rest}.'] if rest else [], _parameters(d),
                     _held_out(d), _location(d), how_it_was_read(d), _untried(d)]
        if d.next_experiment:
            sections.append([f'Next experiment: {d.next_experiment}'])
    return '\n\n'.join('\n'.join(lines) for lines in sections if lines)


def _verdict(d: Diagnosis) -> list[str]:
    sentence = headline(d)
    lines = [f'{d.verdict.replace("_", " ")}: {sentence[0].lower()}{sentence[1:]}.']
    if d.verdict == 'physics_missing':
        lines.append('Recalibrating K_e and B_e alone cannot explain the recording.')
    return lines + [f'{one.rstrip(".")}.' for one in (negligible(d), d.nearly) if one]


def _effect(effect: NamedEffect) -> list[str]:
    values = ', '.join(f'{name} = {_with_std(value)}{_unit(value)}'
                       for name, value in effect.parameters.items())
    lines = [
        f'{effect.name} ({PORTS[effect.port]}), family {effect.family}, '
        f'probability {effect.probability:.3f}',
        f'  {effect.equation}',
        f'  {values}',
        f'  {share_of(effect)}']
    if len(effect.parts) > 1:
        lines.append(f'  fitted on each of {len(effect.parts)} folds alone: {_ranges(effect)}')
    lines.append(f'  visible {place_of(effect.location)}')
    if effect.indistinguishable_from:
        names = listed(effect.indistinguishable_from)
        lines.append(f'  this recording cannot distinguish it from {names}')
    return lines


def _ranges(effect: NamedEffect) -> str:
    """Give the least and greatest value of each parameter over the folds."""
    texts = []
    for name, value in effect.parameters.items():
        found = [part.parameters[name] for part in effect.parts]
        texts.append(f'{name} = {min(found):.3g} to {max(found):.3g}{_unit(value)}')
    return ', '.join(texts)


def _unit(value: Value) -> str:
    return '' if value.unit in ('', '1') else f' {value.unit}'


def _with_std(value: Value) -> str:
    """Format a value; one at the limit of its range has no standard deviation."""
    return f'{value.value:.6g}' + (f' +- {value.std:.2g}' if isfinite(value.std) else '')


def _parameters(d: Diagnosis) -> list[str]:
    lines = [_row('Model parameters', *MODELS)]
    symbols = (('K_e [N/m]', d.stiffness), ('B_e [N s/m]', d.damping))
    for place, (symbol, corrected) in enumerate(symbols):
        last = _with_std(corrected) if d.corrected.free[place] else 'replaced by the effect'
        lines.append(_row(f'  {symbol}', f'{d.nominal.values[place]:.6g}',
                          f'{d.recalibrated.values[place]:.6g}', last))
    if d.nominal.with_inertia:
        masses = (f'{getattr(d, name).values[2]:.6g}' for name in MODELS)
        lines.append(_row('  M_e [kg]', *masses))
    named = {one.name for one in d.effects}
    for effect in d.corrected.effects:  # those of the nominal model, and zeros that are no names
        for place, key in enumerate(names_of(effect) if effect not in named else ()):
            lines.append(_row(f'  {effect}.{key}', *(
                f'{model.values[model.place(effect)][place]:.6g}' if effect in model.effects
                else '-' for model in (d.nominal, d.recalibrated, d.corrected))))
    return lines


def _held_out(d: Diagnosis) -> list[str]:
    lines = [_row('Held-out errors (rms)', *MODELS), _row('  force [N]', *_numbers(d.force, 1.0))]
    if d.motion.nominal is not None:
        lines.append(_row('  free-run position [um]', *_numbers(d.motion, 1e6)))
    lines.append(f'  force noise {d.noise_floor:.3g} N; held out: '
                 + ', '.join(part.name for part in d.holdouts))
    return lines + [f'  {one}' for one in [improvement(d)] if one]


def _row(label: str, *cells: str) -> str:
    first, second, last = cells
    return f'{label:<26}{first:>13}{second:>14}   {last}'


def _numbers(errors: Errors, factor: float) -> list[str]:
    values = (getattr(errors, name) for name in MODELS)
    return ['-' if value is None else f'{factor * value:.4g}' for value in values]


def _location(d: Diagnosis) -> list[str]:
    """Describe where the mismatch sits and on what the residuals depend."""
    if d.location is None:
        return []
    lines = [mismatch(d)] if d.verdict == 'unexplained' else []
    if len(d.recordings) > 1:
        lines.append(f'All times are those of {d.shown}, the recording explained worst.')
    tested = tested_dependences(d)
    if tested:
        lines.append(f'Share of the {d.located_channel} residuals explained by')
        lines += [f'  {name + " model:":<20}{significant(found)}'
                  for name, found in tested.items()]
    return lines


def _untried(d: Diagnosis) -> list[str]:
    untried = d.untried
    return ['Not tried', *(f'  {family}: {reason}' for family, reason in untried)] * bool(untried)
