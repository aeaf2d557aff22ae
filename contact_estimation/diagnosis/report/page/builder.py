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
The report as one self-contained HTML page.

Each section is a module of this package, which prepares its data, and the template of the same
name beside it.
"""

from __future__ import annotations

from typing import Any, Callable, Mapping

from jinja2 import Environment, PackageLoader, StrictUndefined

from . import (
    checks,
    comparison,
    effects,
    evidence,
    held_out,
    location,
    next_experiment,
    parameters,
    parts_left_out,
    summary,
)
from .inputs import Inputs
from ..number_format import plain, with_std
from ..wording import headline, meaning, place_of, PORTS, share_of
from ...conclude.result import Diagnosis
from ....figures import as_data_uri

SECTIONS: Mapping[str, Callable[[Inputs], Mapping[str, Any] | None]] = {
    'summary': summary.prepare,
    'checks': checks.prepare,
    'effects': effects.prepare,
    'parameters': parameters.prepare,
    'comparison': comparison.prepare,
    'parts_left_out': parts_left_out.prepare,
    'location': location.prepare,
    'held_out': held_out.prepare,
    'evidence': evidence.prepare,
    'next_experiment': next_experiment.prepare,
}
"""In the order of the page. A section whose data are None is left out."""

_WITHOUT_RECORDINGS = ('summary', 'checks')


def as_html(diagnosis: Diagnosis, title: str, experiment_file: str | None = None) -> str:
    """
    Build the page.

    Parameters
    ----------
    diagnosis : Diagnosis
        The result.
    title : str
        Names of the recordings.
    experiment_file : str, optional
        Path of the next experiment's file.

    Returns
    -------
    page : str
        HTML with style and figures embedded: no script, no external resource.

    Raises
    ------
    MissingPackageError
        If matplotlib is not installed.

    """
    inputs = Inputs(diagnosis, title, experiment_file)
    prepared = {name: prepare(inputs) for name, prepare in SECTIONS.items()
                if diagnosis.recordings or name in _WITHOUT_RECORDINGS}
    return _environment().get_template('page.html').render(
        verdict=diagnosis.verdict.replace('_', ' '), headline=headline(diagnosis), title=title,
        sections={name: data for name, data in prepared.items() if data is not None},
    )


def _environment() -> Environment:
    environment = Environment(
        loader=PackageLoader(__package__, '.'), autoescape=True, undefined=StrictUndefined,
        trim_blocks=True, lstrip_blocks=True, keep_trailing_newline=True,
    )
    environment.filters.update(
        as_image=as_data_uri, meaning=meaning, place=place_of, plain=plain,
        port=PORTS.__getitem__, share=share_of, with_std=with_std,
    )
    return environment
