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

"""One report held against one truth."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Mapping, Sequence

from ..physics import EFFECTS

NOT_COUNTED = ('gamma', 'phase')
"""Parameters that may lie anywhere around 0."""

INNOCENT = ('consistent', 'recalibrate')


@dataclass(frozen=True)
class Score:
    """
    What a report is worth; None where a question does not arise.

    Attributes
    ----------
    trial : str
        Name.
    effect : str
        True effect; '' for none.
    outside : bool
        Whether the library has no name for it.
    concealed : float
        How well.
    verdict : str
        Of the report; '' where there is none.
    verdict_right : bool
        It is that of the truth.
    said : list of str
        Names of the effects, first to last.
    rivals : list of str
        `indistinguishable_from` of the first.
    named : bool or None
        The true name is the first effect or among its rivals.
    alone : bool or None
        The true name is the first and only effect, and has no rivals.
    surplus : bool or None
        More effects are named than are there.
    accused : bool or None
        Something is said to be missing where nothing is.
    parameter_errors : dict of str to float
        |estimate - true| in percent of the true departure from "no effect".
    force_ratio : float or None
        Held-out force error of the corrected model over the true noise floor.
    floor_error : float or None
        Of the noise floor [%], signed.
    stiffness_error, damping_error : float or None
        Of the corrected model [%], signed; None where the truth has none and none is given.
    base_right : bool or None
        Where the truth has no K_e (no B_e), the corrected model has none (0), and else it has.
    unnamed, port_right : bool or None
        Of what is outside the library: the verdict is `unexplained` and nothing is named; the
        port is that of the truth.
    overlap : float or None
        Likewise: time that true and reported intervals share, over that of either.
    features : dict of str to str
        What else may matter, such as the experiment.
    error : str
        Complaint of the command.
    seconds : float
        Time it took [s].

    """

    trial: str
    effect: str
    outside: bool
    concealed: float
    verdict: str
    verdict_right: bool
    said: list[str]
    rivals: list[str]
    named: bool | None
    alone: bool | None
    surplus: bool | None
    accused: bool | None
    parameter_errors: dict[str, float]
    force_ratio: float | None
    floor_error: float | None
    stiffness_error: float | None
    damping_error: float | None
    base_right: bool | None
    unnamed: bool | None
    port_right: bool | None
    overlap: float | None
    features: dict[str, str]
    error: str
    seconds: float


def score(trial: str, truth: Mapping[str, Any], answer: Mapping[str, Any]) -> Score:
    """
    Score a trial.

    Parameters
    ----------
    trial : str
        Name.
    truth : mapping
        As `truth_of` tells it.
    answer : mapping
        As `diagnose_blind` keeps it.

    Returns
    -------
    score : Score
        A command that failed has named nothing and accused nobody, but has no verdict either.

    """
    report: Mapping[str, Any] = answer['report'] or {}
    true = truth['effects'][0] if truth['effects'] else None
    effects = report.get('effects', [])
    said = [effect['name'] for effect in effects]
    rivals = list(effects[0]['indistinguishable_from']) if effects else []
    first = said[:1]
    unknown: Mapping[str, Any] = truth.get('unknown') or {}
    inside = not unknown
    name = true['name'] if true else unknown.get('name', '')
    verdict = str(report.get('verdict', ''))
    fit, corrected = report.get('fit', {}), report.get('corrected', {})
    located = report.get('location') or {}
    floor = float(truth['force_floor_n'])
    held_out = fit.get('force_rmse_n', {}).get('corrected')
    return Score(
        trial=trial, effect=name, outside=not inside, concealed=float(truth['concealed']),
        verdict=verdict, verdict_right=verdict == truth['verdict'], said=said, rivals=rivals,
        named=name in first + rivals if true else None,
        alone=(said == [name] and not rivals) if true else None,
        surplus=len(said) > 1 if true else None,
        accused=None if name else bool(said) or verdict not in INNOCENT,
        parameter_errors=_parameter_errors(true, effects[0]) if first == [name] and true else {},
        force_ratio=None if held_out is None or not inside else float(held_out) / floor,
        floor_error=_percent(fit.get('noise_floor_n'), floor),
        stiffness_error=(
            _percent(_value(corrected, 'stiffness'), truth['stiffness']) if inside else None),
        damping_error=(
            _percent(_value(corrected, 'damping'), truth['damping']) if inside else None),
        base_right=bool(report) and _base_right(corrected, truth) if inside else None,
        unnamed=None if inside else verdict == 'unexplained' and not said,
        port_right=None if inside else located.get('port') == unknown['port'],
        overlap=None if inside else _overlap(
            located.get('intervals_s', []), unknown['intervals_s']),
        features=_features(truth), error=str(answer['error']), seconds=float(answer['seconds']),
    )


def _value(corrected: Mapping[str, Any], name: str) -> float | None:
    value = corrected.get(name, {}).get('value')
    return None if value is None else float(value)


def _percent(estimate: float | None, true: float | None) -> float | None:
    if estimate is None or not true:
        return None
    return 100.0 * (float(estimate) / true - 1.0)


def _base_right(corrected: Mapping[str, Any], truth: Mapping[str, Any]) -> bool:
    stiffness, damping = (_value(corrected, name) for name in ('stiffness', 'damping'))
    return (stiffness is None) == (truth['stiffness'] is None) and (
        not damping) == (not truth['damping'])


def _parameter_errors(true: Mapping[str, Any], found: Mapping[str, Any]) -> dict[str, float]:
    neutral = EFFECTS[true['name']].neutral
    errors = {}
    for name, value in true['parameters'].items():
        departure = value - neutral.get(name, 0.0)
        estimate = found['parameters'].get(name, {}).get('value')
        if name in NOT_COUNTED or departure == 0.0 or estimate is None:
            continue
        errors[name] = 100.0 * abs((estimate - value) / departure)
    return errors


def _overlap(said: Sequence[Sequence[float]], true: Sequence[Sequence[float]]) -> float:
    """Divide the time in both by the time in either; the intervals of each lie apart."""
    both = sum(max(0.0, min(b, d) - max(a, c)) for a, b in said for c, d in true)
    each = sum(b - a for intervals in (said, true) for a, b in intervals)
    return both / max(each - both, 1e-12)


def _features(truth: Mapping[str, Any]) -> dict[str, str]:
    sensing = truth['sensing']
    return {
        'experiment': truth['experiment'],
        'rate': f'{sensing["rate"]:g} Hz',
        'velocity': 'not sent' if sensing['velocity_noise'] is None else 'sent',
        'dropped samples': 'some' if sensing['dropped'] else 'none',
        'force filter': 'low-pass' if sensing['low_pass'] else 'none',
        'stamps': 'jitter' if sensing['jitter'] else 'exact',
        'joint samples': 'between' if sensing['joint_phase'] else 'with the force',
        'force noise': sensing['distribution'],
    }
