# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Which effects promise most beside a model, and where their fits start."""

from __future__ import annotations

from typing import Any

from concealed_worlds import physics, prepared_from, recorded
from contact_estimation.diagnosis.fit.applicable import candidates_in
from contact_estimation.diagnosis.fit.fitting import Fit, fit
from contact_estimation.diagnosis.fit.scales import measure_scales
from contact_estimation.diagnosis.fit.screening import Screening, Step
from contact_estimation.diagnosis.observe.prepared_recording import PreparedRecording
import pytest


def recalibrated(**changes: Any) -> tuple[PreparedRecording, Fit]:
    """Recalibrate the nominal model on a world's recording."""
    recording, model = prepared_from(recorded(**changes))
    return recording, fit([recording], model)


def steps(recording: PreparedRecording, base: Fit, *names: str) -> dict[str, list[Step]]:
    """Take the steps of effects beside the recalibrated model."""
    every = names or candidates_in([recording], base.model)
    screening = Screening([recording], base, every, measure_scales([recording], base))
    return screening.steps(base.model, every)


@pytest.mark.parametrize('name, values', [
    ('quadratic_damping', (600.0,)), ('cubic_stiffness', (3e6,)), ('coulomb_friction', (2.0,)),
    ('robot_drag', (600.0,)), ('force_bias', (2.0,))])
def test_the_true_effect_is_among_the_first(name: str, values: tuple[float, ...]) -> None:
    recording, base = recalibrated(**physics(name, *values))
    found = steps(recording, base)
    assert set(found) == set(candidates_in([recording], base.model))
    foretold = [each[0].foretold for each in found.values()]
    assert foretold == pytest.approx(sorted(foretold), rel=2e-6)
    assert name in list(found)[:5]
