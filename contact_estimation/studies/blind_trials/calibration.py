# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Calibration of the constants of a decision, on trials with known truth."""

from dataclasses import dataclass, replace
import json
from pathlib import Path
from typing import Any, Mapping, NamedTuple, Sequence

import numpy as np

from .scoring import of_families
from ...diagnosis.fit.beam import Compared, of_dict
from ...diagnosis.fit.constants import CONSTANTS, Constants
from ...exceptions import ParameterRangeError

FITTED = ('parameter', 'law', 'curve', 'independent', 'ideal', 'instrument', 'temperature')
"""Constants of the evidence, which the log score determines."""

_FACTOR, _ROUNDS = 1.4, 3  # of the search: steps of a constant, times that all are tried
_GAIN = 1e-3  # nats a trial, below which a constant is as good as another
_LEAST = 0.02  # probability: one that is wrong for certain costs no more than 4 nats


class JudgedTrial(NamedTuple):
    """A trial with its truth."""

    compared: Compared  # the models of its diagnosis
    effects: frozenset[str]  # effects of the families that are right; empty where no name is


@dataclass(frozen=True)
class Calibration:
    """Fitted constants."""

    trials: int  # number of trials
    # before, after: loss with the constants as they are, and as fitted [nat a trial]
    before: float
    after: float
    constants: Constants  # as fitted
    sensitivity: dict[str, tuple[float, float]]  # loss at half and at twice each fitted constant

    def text(self) -> str:
        """Format the constants as a table."""
        lines = [f'constants of the decision, fitted to {self.trials} trials: '
                 f'{self.before:.4f} -> {self.after:.4f} nat a trial',
                 'constant          present    fitted   loss at half, at twice']
        for name in FITTED:
            half, twice = self.sensitivity[name]
            lines.append(f'  {name:<14}{getattr(CONSTANTS, name):>9.3g}'
                         f'{getattr(self.constants, name):>10.3g}{half:>12.4f}{twice:>10.4f}')
        return '\n'.join(lines)

    def write(self, path: Path) -> None:
        """Write the constants as `diagnosis/fit/constants.json` holds them."""
        path.write_text(json.dumps(self.constants._asdict(), indent=1) + '\n')


def judged(truth: Mapping[str, Any], answer: Mapping[str, Any]) -> JudgedTrial | None:
    """Read truth and comparison of a trial; None for one that an older version has diagnosed."""
    if answer.get('comparison') is None:
        return None
    try:
        compared = of_dict(answer['comparison'], CONSTANTS)
    except KeyError as missing:
        raise ParameterRangeError(
            f'a comparison of the study must have {missing}, got one of another version; '
            'delete the subfolder reports and diagnose again') from missing
    return JudgedTrial(compared, frozenset(of_families(truth['families'])))


def loss(trials: Sequence[JudgedTrial], constants: Constants) -> float:
    """Return the mean -log of the probability of models with a right family, or without [nat]."""
    scores = []
    for trial in trials:
        scale = (constants.instrument / CONSTANTS.instrument) ** 2
        evidence = replace(trial.compared.evidence, constants=constants,
                           instrument=scale * trial.compared.evidence.instrument)
        models = trial.compared.models
        weights = evidence.weights(models, 0)
        right = [bool(trial.effects & one.key) if trial.effects else one.laws == 0
                 for one in models]
        scores.append(-np.log(max(float(weights[right].sum()), _LEAST)))
    return float(np.mean(scores))


def calibrate(trials: Sequence[JudgedTrial]) -> Calibration:
    """Fit the constants of the evidence, one after the other."""
    if not trials:
        raise ParameterRangeError(
            '--calibrate needs trials with a comparison, got none; delete the subfolder reports '
            'of the study and diagnose again')
    best, before = CONSTANTS, loss(trials, CONSTANTS)
    least = before
    for _ in range(_ROUNDS):
        previous = least
        for name in FITTED:
            for factor in (1.0 / _FACTOR, _FACTOR):
                tried = best._replace(**{name: factor * getattr(best, name)})
                there = loss(trials, tried)
                if there < least - _GAIN:
                    best, least = tried, there
        if least > previous - _GAIN:
            break
    sensitivity = {
        name: (loss(trials, best._replace(**{name: 0.5 * getattr(best, name)})),
               loss(trials, best._replace(**{name: 2.0 * getattr(best, name)})))
        for name in FITTED}
    return Calibration(len(trials), before, least, best, sensitivity)
