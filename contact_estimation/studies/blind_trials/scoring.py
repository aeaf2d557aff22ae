# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Score of a diagnosis report against the ground truth of its trial."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Mapping

from ...physics import EFFECTS

_NOT_SCORED = ('gamma', 'phase')  # parameters without a natural scale
_CLEAN_VERDICTS = ('consistent', 'recalibrate')


@dataclass(frozen=True)
class Score:
    """Score of one report; None where a criterion does not apply."""

    trial: str  # name of the trial
    effect: str  # True effect; '' in a clean world
    concealed: float  # degree of concealment
    verdict: str  # verdict of the report; '' without a report
    verdict_right: bool  # the verdict equals that of the truth
    names: list[str]  # names of the reported effects, in order
    alternatives: list[str]  # `indistinguishable_from` of the first reported effect
    # True positive: the true effect is the first name or among its alternatives
    found: bool | None
    found_alone: bool | None  # the true effect is the only name, without alternatives
    extra_names: bool | None  # more effects are reported than the world has
    false_alarm: bool | None  # an effect or missing physics is reported in a clean world
    # |estimate - true| relative to the true distance from "no effect" [%]
    parameter_errors: dict[str, float]
    # held-out force error of the corrected model over the true noise floor
    force_ratio: float | None
    floor_error: float | None  # error of the reported noise floor, signed [%]
    # stiffness_error, damping_error: errors of the corrected model, signed [%]; None where truth
    # or model has no value
    stiffness_error: float | None
    damping_error: float | None
    base_right: bool  # the corrected model has K_e and B_e exactly where the truth has them
    features: dict[str, str]  # properties of experiment and sensors, for grouping
    error: str  # error message of the command; '' on success
    seconds: float  # run time of the diagnosis [s]

    @property
    def answer(self) -> str:
        """First reported name, else 'failed', 'unexplained' or 'nothing'."""
        if not self.verdict:
            return 'failed'
        if self.names:
            return self.names[0]
        return 'unexplained' if self.verdict == 'unexplained' else 'nothing'

    @property
    def is_miss(self) -> bool:
        """Whether the report is wrong in any respect."""
        return (bool(self.error) or self.found is False or bool(self.extra_names)
                or bool(self.false_alarm) or bool(self.effect and not self.verdict_right))


def score(trial: str, truth: Mapping[str, Any], answer: Mapping[str, Any]) -> Score:
    """Score a trial."""
    report: Mapping[str, Any] = answer['report'] or {}
    true = truth['effects'][0] if truth['effects'] else None
    effects = report.get('effects', [])
    names = [effect['name'] for effect in effects]
    alternatives = list(effects[0]['indistinguishable_from']) if effects else []
    name = true['name'] if true else ''
    verdict = str(report.get('verdict', ''))
    fit, corrected = report.get('fit', {}), report.get('corrected', {})
    stiffness, damping = (_value(corrected, each) for each in ('stiffness', 'damping'))
    floor = float(truth['force_floor_n'])
    held_out = fit.get('force_rmse_n', {}).get('corrected')
    return Score(
        trial=trial, effect=name, concealed=float(truth['concealed']),
        verdict=verdict, verdict_right=verdict == truth['verdict'],
        names=names, alternatives=alternatives,
        found=name in names[:1] + alternatives if true else None,
        found_alone=names == [name] and not alternatives if true else None,
        extra_names=len(names) > 1 if true else None,
        false_alarm=None if name else bool(names) or verdict not in _CLEAN_VERDICTS,
        parameter_errors=(
            _parameter_errors(true, effects[0]) if true and names[:1] == [name] else {}),
        force_ratio=None if held_out is None else float(held_out) / floor,
        floor_error=_percent(fit.get('noise_floor_n'), floor),
        stiffness_error=_percent(stiffness, truth['stiffness']),
        damping_error=_percent(damping, truth['damping']),
        base_right=bool(report) and (
            (stiffness is None) == (truth['stiffness'] is None)
            and (not damping) == (not truth['damping'])),
        features=_features(truth), error=str(answer['error']), seconds=float(answer['seconds']),
    )


def _value(corrected: Mapping[str, Any], name: str) -> float | None:
    value = corrected.get(name, {}).get('value')
    return None if value is None else float(value)


def _percent(estimate: float | None, true: float | None) -> float | None:
    if estimate is None or not true:
        return None
    return 100.0 * (float(estimate) / true - 1.0)


def _parameter_errors(true: Mapping[str, Any], found: Mapping[str, Any]) -> dict[str, float]:
    neutral = EFFECTS[true['name']].neutral()
    errors = {}
    for name, value in true['parameters'].items():
        distance = value - neutral.get(name, 0.0)
        estimate = found['parameters'].get(name, {}).get('value')
        if name in _NOT_SCORED or distance == 0.0 or estimate is None:
            continue
        errors[name] = 100.0 * abs((estimate - value) / distance)
    return errors


def _features(truth: Mapping[str, Any]) -> dict[str, str]:
    sensors = truth['sensing']
    return {
        'experiment': truth['experiment'],
        'rate': f'{sensors["rate"]:g} Hz',
        'velocity': 'not sent' if sensors['velocity_noise'] is None else 'sent',
        'dropped samples': 'some' if sensors['dropped'] else 'none',
        'force filter': 'low-pass' if sensors['low_pass'] else 'none',
        'stamps': 'jitter' if sensors['jitter'] else 'exact',
        'joint samples': 'between' if sensors['joint_phase'] else 'with the force',
        'force noise': sensors['distribution'],
    }
