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

"""The report as one page with pictures: no script, nothing that lies outside the file."""

from __future__ import annotations

from base64 import b64encode
from html import escape
import inspect
from typing import Iterable, Sequence

from .page_style import STYLE
from .pictures import draw
from .report import place_of, PORTS
from .written_numbers import plain, with_std
from ..conclude.result import Diagnosis, Errors, NamedEffect
from ...parameters.specification import specifications
from ...physics import EFFECTS

_CAPTIONS = {
    'overlay': 'Recording and simulations. Force: what each model predicts for the measured '
               'motion. Position: each model run free from the command alone.',
    'residuals': 'What the models leave over, in blocks of time. The grey band is the noise of '
                 'the sensors; a right model stays in it. The shaded part was held out: no fit '
                 'has seen it.',
    'plane': 'What is left over the motion, in standard deviations of the noise. A pattern on '
             'the left is physics; on the right there should be none.',
    'dependence': 'What is left over, averaged where a quantity is alike, in standard deviations '
                  'of the noise, with the 95 % bands of a block bootstrap. In the titles the '
                  'share of its mean square that this explains, before and after. Its own past: '
                  'the autocorrelation; noise has none.',
    'evidence': 'How much of the misfit each candidate alone would explain, refitted with K_e '
                'and B_e; blue is what was taken.',
}
_COLUMNS = ('nominal', 'recalibrated', 'corrected')


def as_html(diagnosis: Diagnosis, title: str, experiment_file: str | None = None) -> str:
    """
    Write the page.

    Parameters
    ----------
    diagnosis : Diagnosis
        The result.
    title : str
        Names of the recordings.
    experiment_file : str, optional
        Where the next experiment was written.

    Returns
    -------
    page : str
        HTML with its pictures in it.

    Raises
    ------
    MissingPackageError
        If matplotlib is not installed.

    """
    d = diagnosis
    pictures = {name: _picture(name, data) for name, data in draw(d).items()}
    parts = [
        f'<header><p class="verdict {d.verdict}">{escape(d.verdict.replace("_", " "))}</p>'
        f'<h1>{escape(headline(d))}</h1>',
        f'<p class="lead">{escape(proof(d))}</p><p class="muted">{escape(title)}</p></header>',
        *(_effect(effect) for effect in d.effects),
        _located(d),
        '<h2>Before and after</h2>', _shown(d), pictures['overlay'], pictures['residuals'],
        pictures['plane'], pictures.get('dependence', ''),
        '<h2>Values</h2>', _values(d),
        '<h2>On what no fit has seen</h2>', _held_out(d),
        '<h2>Evidence</h2>', pictures['evidence'],
        _next(d, experiment_file),
    ]
    body = '\n'.join(part for part in parts if part)
    return (
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f'<title>{escape(d.verdict.replace("_", " "))}: {escape(title)}</title>'
        f'<style>{STYLE}</style></head>\n<body><main>\n{body}\n</main></body></html>\n'
    )


def headline(diagnosis: Diagnosis) -> str:
    """
    Say the verdict as one would to a colleague.

    Parameters
    ----------
    diagnosis : Diagnosis
        The result.

    Returns
    -------
    headline : str
        One sentence without full stop.

    """
    d = diagnosis
    if d.verdict == 'consistent':
        return 'Nothing is missing: the simulation explains the recording to its noise'
    if d.verdict == 'recalibrate':
        old, new = d.nominal, d.recalibrated
        return (
            f'The physics are right, the values are not: K_e is {new.stiffness:.5g} N/m instead '
            f'of {old.stiffness:.5g}, B_e {new.damping:.4g} N s/m instead of {old.damping:.4g}'
        )
    names = ' and '.join(_spoken(effect) for effect in d.effects)
    if d.verdict == 'physics_missing':
        return f'The simulation lacks {names}'
    known = f', beside {names}' if names else ''
    return f'Something is missing that the library has no name for{known}'


def _spoken(effect: NamedEffect) -> str:
    values = ', '.join(
        f'{name} = {value.value:.4g}{_unit(value.unit)}'
        for name, value in effect.parameters.items()
    )
    return f'{effect.name.replace("_", " ")} {PORTS[effect.port]} ({values})'


def _unit(unit: str) -> str:
    return '' if unit in ('', '1') else f' {unit}'


def proof(diagnosis: Diagnosis) -> str:
    """
    Say what the models are worth on held-out data.

    Parameters
    ----------
    diagnosis : Diagnosis
        The result.

    Returns
    -------
    proof : str
        A sentence or two.

    """
    d = diagnosis
    before = 'recalibrated' if d.effects else 'nominal'
    after = 'corrected' if d.effects else 'recalibrated'
    said = []
    for errors, what, factor, unit in (
        (d.force, 'force', 1.0, 'N'), (d.motion, 'free-run position', 1e6, 'µm'),
    ):
        first, last = getattr(errors, before), getattr(errors, after)
        if first is None or last is None:
            continue
        if d.verdict in ('consistent', 'unexplained') and not d.effects:
            said.append(f'the {what} error is {factor * first:.3g} {unit}')
        else:
            said.append(f'the {what} error goes from {factor * first:.3g} to '
                        f'{factor * last:.3g} {unit}')
    if not said:
        return ''
    sentence = f'On data that no fit has seen {" and ".join(said)}; the noise of the force is '
    return sentence + f'{d.noise_floor:.3g} N.'


def meaning(name: str) -> str:
    """
    Say in plain words what an effect is.

    Parameters
    ----------
    name : str
        Key of EFFECTS.

    Returns
    -------
    meaning : str
        The first line of its file.

    """
    module = inspect.getmodule(EFFECTS[name])
    return inspect.cleandoc((module and module.__doc__) or '').split('\n')[0]


def _picture(name: str, data: bytes) -> str:
    caption = escape(_CAPTIONS[name])
    encoded = b64encode(data).decode('ascii')
    return (f'<figure><img alt="{caption}" src="data:image/png;base64,{encoded}">'
            f'<figcaption>{caption}</figcaption></figure>')


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Make a table of cells that are HTML already."""
    top = ''.join(f'<th scope="col">{cell}</th>' for cell in head)
    body = ''.join(
        '<tr><th scope="row">' + cells[0] + '</th>'
        + ''.join(f'<td>{cell}</td>' for cell in cells[1:]) + '</tr>' for cells in rows
    )
    return f'<table><thead><tr>{top}</tr></thead><tbody>{body}</tbody></table>'


def _effect(effect: NamedEffect) -> str:
    specs = specifications(EFFECTS[effect.name].Parameters)
    told = {spec.name: spec.description for spec in specs}
    table = _table(('', 'value', 'unit', 'meaning'), (
        (escape(name), with_std(value.value, value.std), escape(value.unit),
         escape(told.get(name, '')))
        for name, value in effect.parameters.items()
    ))
    alike = ''
    if effect.indistinguishable_from:
        names = ' or '.join(f'<b>{escape(name)}</b> ({escape(meaning(name))})'
                            for name in effect.indistinguishable_from)
        alike = f'<p class="warning">This recording cannot tell it from {names}.</p>'
    return (
        f'<section class="effect"><h2>{escape(effect.name)}</h2><p>{escape(meaning(effect.name))} '
        f'It acts {PORTS[effect.port]}; probability {effect.probability:.3f}.</p>'
        f'<p class="equation">{escape(effect.equation)}</p>{table}{alike}'
        f'<p class="muted">Seen {escape(place_of(effect.location))}.</p></section>'
    )


def _located(d: Diagnosis) -> str:
    if d.location is None or d.verdict != 'unexplained':
        return ''
    return (f'<p class="warning">What no effect explains sits '
            f'{PORTS[d.location.port]}, {escape(place_of(d.location))}. It is '
            f'{d.residual_power:.3g} times the noise in mean square.</p>')


def _shown(d: Diagnosis) -> str:
    if len(d.recordings) == 1:
        return ''
    return (f'<p class="muted">Shown is {escape(d.shown)}, the recording of '
            f'{len(d.recordings)} that the refitted model explains worst.</p>')


def _values(d: Diagnosis) -> str:
    rows = []
    bases = (('K_e', 'N/m', d.stiffness, 0), ('B_e', 'N s/m', d.damping, 1))
    for symbol, unit, value, place in bases:
        last = with_std(value.value, value.std)
        if not d.corrected.free[place]:
            last = 'the effect takes its place'
        rows.append((symbol, plain(d.nominal.values[place]), plain(d.recalibrated.values[place]),
                     last, unit))
    if d.nominal.with_inertia:
        inertia = [plain(m.values[2]) for m in (d.nominal, d.recalibrated, d.corrected)]
        rows.append(('M_e', inertia[0], inertia[1], inertia[2], 'kg'))
    return _table(('', *_COLUMNS, 'unit'), rows)


def _held_out(d: Diagnosis) -> str:
    parts = [(part.name, part.force, part.motion) for part in d.holdouts]
    if len(parts) > 1:
        parts.append(('all', d.force, d.motion))
    rows = []
    for name, force, motion in parts:
        rows.append((f'{escape(name)}, force [N]', *_errors(force, 1.0)))
        if motion.nominal is not None:
            rows.append((f'{escape(name)}, free-run position [µm]', *_errors(motion, 1e6)))
    table = _table(('', *_COLUMNS), rows)
    text = f'<p>Root-mean-square errors; noise floor of the force {d.noise_floor:.3g} N.'
    if d.improvement is not None and d.effects:
        low, high = (100.0 * value for value in d.improvement)
        text += f' The correction takes {low:.0f} to {high:.0f} % off the force error (95 %).'
    return table + text + '</p>'


def _errors(errors: Errors, factor: float) -> tuple[str, str, str]:
    values = (errors.nominal, errors.recalibrated, errors.corrected)
    first, second, third = (
        '&ndash;' if value is None else f'{factor * value:.4g}' for value in values)
    return first, second, third


def _next(d: Diagnosis, experiment_file: str | None) -> str:
    if not d.next_experiment:
        return ''
    file = ''
    if experiment_file is not None:
        file = (f'<p class="muted">Ready to be played: <code>loop --experiment '
                f'{escape(experiment_file)}</code></p>')
    return f'<h2>Next experiment</h2><p>{escape(d.next_experiment)}</p>{file}'
