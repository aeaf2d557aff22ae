# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
The report as one self-contained HTML page.

`diagnosis.html` is its text, in the order of the page: the finding, its picture, its proof on each
part, what to change, what is open, and then everything else.
"""

from math import floor, isfinite, log10
from typing import Any

from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from . import figures, wording
from .plot_data import plot_data
from ..result import Diagnosis
from ...figures import as_data_uri
from ...parameters import specifications
from ...physics import EFFECTS

DASH = Markup('&ndash;')


def as_html(diagnosis: Diagnosis, title: str, experiment_file: str | None = None) -> str:
    """Build the page."""
    return rendered('diagnosis.html', diagnosis, title=title, experiment_file=experiment_file,
                    **_shown(diagnosis) if diagnosis.recordings else {})


def rendered(template: str, d: Any, **shown: Any) -> str:
    """Render the page of a diagnosis, of a contact or an arm: its verdict, checks, and more."""
    return environment(__package__).get_template(template).render(
        d=d, verdict='recording refused' if d.refused else d.verdict.replace('_', ' '),
        failed=[one for one in d.checks if not one.ok], passed=[one for one in d.checks if one.ok],
        **shown)


def _shown(d: Diagnosis) -> dict[str, Any]:
    """Return what is shown of recordings that were fitted."""
    data = plot_data(d)
    tested = wording.tested_dependences(d)
    return {
        'force': figures.plot_comparison(data, data.force),
        'position': data.position and figures.plot_comparison(data, data.position),
        'residuals': [(one.label, figures.plot_residuals(data, one)) for one in data.residuals],
        'parts': {effect.name: figures.plot_parts(effect) for effect in d.effects},
        'descriptions': {
            effect.name: {spec.name: spec.description
                          for spec in specifications(EFFECTS[effect.name])}
            for effect in d.effects},
        'significant': {name: wording.significant(found) for name, found in tested.items()},
        'plane': figures.plot_plane(data),
        'dependences': figures.plot_dependences(tested) if tested else None,
        'evidence': figures.plot_evidence(d) if d.evidence else None,
        'models': [getattr(d, name) for name in wording.MODELS],
        'shown_models': list(_models(d)),
        'held_out': _held_out(d),
    }


def _models(d: Diagnosis) -> tuple[str, ...]:
    """Return the models that differ: without effects the corrected one is the recalibrated."""
    return wording.MODELS if d.effects else wording.MODELS[:2]


def _held_out(d: Diagnosis) -> list[tuple[str, str, list[float | None]]]:
    """Return name, channel and the errors of all models on each held-out part."""
    parts = [(part.name, part.force, part.motion) for part in d.holdouts]
    if len(parts) > 1:
        parts.append(('all parts', d.force, d.motion))
    rows = []
    for name, force, motion in parts:
        for channel, errors, factor in (('force [N]', force, 1.0),
                                        ('free-run position [µm]', motion, 1e6)):
            values = [getattr(errors, model) for model in _models(d)]
            if channel.startswith('force') or values[0] is not None:
                rows.append((name, channel, [None if value is None else factor * value
                                             for value in values]))
    return rows


def environment(*packages: str) -> Environment:
    """Return the environment of templates that lie in packages, those of the first preferred."""
    loader = ChoiceLoader([PackageLoader(package, '.') for package in packages])
    environment = Environment(
        loader=loader, autoescape=True, undefined=StrictUndefined, trim_blocks=True,
        lstrip_blocks=True, keep_trailing_newline=True)
    environment.globals.update(words=wording)
    environment.filters.update(as_image=as_data_uri, plain=plain, with_std=with_std)
    return environment


def with_std(value: float, std: float) -> Markup:
    """
    Format a value with its standard deviation, the latter to two digits.

    Such as '3.868 &plusmn; 0.053' or '(-7.202 &plusmn; 0.016) &times; 10<sup>6</sup>'. A standard
    deviation that is 0 or not finite is left out.
    """
    if not (isfinite(value) and isfinite(std) and std > 0.0):
        return plain(value)
    power = _power(max(abs(value), std))
    value, std = value / 10.0**power, std / 10.0**power
    digits = max(0, 1 - floor(log10(std)))
    text = f'{value:.{digits}f} &plusmn; {std:.{digits}f}'
    return Markup(f'({text}){_times(power)}' if power else text)


def plain(value: float | None, digits: int = 5) -> Markup:
    """Format a value to significant digits; a dash for None and what is not finite."""
    if value is None or not isfinite(value):
        return DASH
    power = _power(abs(value))
    return Markup(f'{value / 10.0**power:.{digits}g}{_times(power)}')


def _power(size: float) -> int:
    """Return the power of ten to split off; 0 for a number that is readable without."""
    if size == 0.0 or 1e-3 <= size < 1e5:
        return 0
    return floor(log10(size))


def _times(power: int) -> str:
    return f' &times; 10<sup>{power}</sup>' if power else ''
