# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Calibration of the constants of a decision, and the file of a comparison."""

from __future__ import annotations

from contact_estimation.diagnosis.fit.beam import Compared
from contact_estimation.diagnosis.fit.constants import CONSTANTS
from contact_estimation.diagnosis.fit.evidence import Evidence, Scored
from contact_estimation.studies.blind_trials import calibration as calibration_module
from contact_estimation.studies.blind_trials.calibration import calibrate, JudgedTrial, loss
import numpy as np
import pytest

PARTS = 6


def scored(left: float, *effects: str) -> Scored:
    """Make a model that leaves so much, in squares of noise, of every part."""
    squares = np.column_stack((np.full(PARTS, left), np.ones(PARTS)))
    return Scored(effects, tuple(f'family of {one}' for one in effects), (len(effects), effects),
                  squares, squares, np.full((PARTS, 2), 50.0), len(effects), len(effects), 0)


def trial(right: frozenset[str], before: float, **after: float) -> JudgedTrial:
    """Judge models that each leave so much, against the base."""
    base = scored(before)
    models = [base, *(scored(left, name) for name, left in after.items())]
    evidence = Evidence(base, np.zeros(2), np.ones(2)).informed_by(models)
    return JudgedTrial(Compared(evidence, evidence.ranked(models)), right)


FRICTION = frozenset({'coulomb_friction', 'stribeck_friction'})
TRIALS = [
    *(trial(frozenset(), before, cubic_stiffness=0.7 * before) for before in (20.0, 60.0, 90.0)),
    *(trial(FRICTION, before, coulomb_friction=0.05 * before, cubic_stiffness=0.3 * before)
      for before in (40.0, 100.0, 200.0)),
]


def test_loss_is_the_logarithmic_score_of_the_truth() -> None:
    for one in TRIALS:
        weights = one.compared.evidence.weights(one.compared.models, 0)
        of_right = sum(float(weight) for weight, model in zip(weights, one.compared.models)
                       if (model.key & FRICTION if one.effects else not model.effects))
        assert loss([one], CONSTANTS) == pytest.approx(-np.log(max(of_right, 0.02)))
    assert loss(TRIALS, CONSTANTS) == pytest.approx(
        np.mean([loss([one], CONSTANTS) for one in TRIALS]))


@pytest.mark.parametrize('wrong', [{'law': 0.3, 'parameter': 0.3}, {'temperature': 3.0}])
def test_wrong_constants_are_corrected(
    monkeypatch: pytest.MonkeyPatch, wrong: dict[str, float]
) -> None:
    start = CONSTANTS._replace(**wrong)
    monkeypatch.setattr(calibration_module, 'CONSTANTS', start)
    found = calibrate(TRIALS)
    assert found.trials == len(TRIALS)
    assert found.before == pytest.approx(loss(TRIALS, start))
    assert found.after == pytest.approx(loss(TRIALS, found.constants))
    assert found.after < 0.8 * found.before
    if 'law' in wrong:
        assert found.constants.law + found.constants.parameter > start.law + start.parameter
    else:
        assert found.constants.temperature < start.temperature
