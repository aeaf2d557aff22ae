# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Which effects promise most beside a model, and where their fits start."""

from __future__ import annotations

from typing import Any

from concealed_worlds import ATTACHED, attached, nominal, physics, prepared_from, recorded
from contact_estimation.diagnosis.fit.applicable import candidates_in
from contact_estimation.diagnosis.fit.fitting import Fit, fit, fit_at
from contact_estimation.diagnosis.fit.scales import measure_scales
from contact_estimation.diagnosis.fit.screening import Screening, Step
from contact_estimation.diagnosis.observe.prepared_recording import PreparedRecording
from contact_estimation.diagnosis.observe.residuals import residuals
import numpy as np
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
    ('force_bias', (2.0,)), ('coulomb_friction', (3.0,)), ('quadratic_damping', (600.0,))])
def test_one_step_finds_a_value_that_the_force_is_linear_in(
    name: str, values: tuple[float, ...]
) -> None:
    recording, base = recalibrated(**physics(name, *values))
    step = steps(recording, base, name)[name][0]
    assert step.model.values[-1] == pytest.approx(values[0], rel=0.1)
    assert fit_at([recording], step.model).cost < min(1.05 * step.foretold, 0.7 * base.cost)


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


def test_steps_beside_another_law_promise_what_that_leaves() -> None:
    two = {**physics('coulomb_friction', 3.0), **physics('force_bias', 2.0)}
    recording, base = recalibrated(**two)
    rubbing = fit([recording], base.model.with_effect('coulomb_friction', (1.0,)))
    names = ['force_bias', 'quadratic_damping', 'cubic_stiffness', 'robot_drag']
    screening = Screening([recording], base, names, measure_scales([recording], base))
    found = screening.steps(rubbing.model, names)
    assert next(iter(found)) == 'force_bias'
    model = found['force_bias'][0].model
    assert model.effects == ('coulomb_friction', 'force_bias')
    assert model.values[-2:] == pytest.approx((3.0, 2.0), rel=0.1)


def test_a_gain_far_from_one_is_found_by_a_wall_that_is_rescaled() -> None:
    recording, base = recalibrated(**physics('force_gain', 0.545))
    best = steps(recording, base, 'force_gain')['force_gain'][0]
    found = fit([recording], best.model)
    assert found.model.values[-1] == pytest.approx(0.545, rel=0.01)


def test_the_depth_of_a_second_spring_is_found() -> None:
    recording, base = recalibrated(**physics('bilinear_stiffness', 5000.0, 0.009))
    tried = [fit([recording], step.model)
             for step in steps(recording, base, 'bilinear_stiffness')['bilinear_stiffness'][:2]]
    found = min(tried, key=lambda one: one.cost)
    assert found.model.values[2:] == pytest.approx((5000.0, 0.009), rel=0.05)


@pytest.mark.slow
def test_scales_are_those_of_the_recording() -> None:
    recording, base = recalibrated(**physics('moving_environment', 0.0003, 1.7, 0.7))
    scales, o = measure_scales([recording], base), recording.observed
    assert scales.depth == pytest.approx(float(np.max(o.x)), rel=1e-6)
    assert scales.force == pytest.approx(float(np.max(np.abs(o.force))))
    assert scales.duration == pytest.approx(7.296)
    assert scales.mass == 12.0
    assert min(abs(frequency - 1.7) for frequency, _ in scales.peaks()) < 0.1


def test_attached_wall_has_scales_too() -> None:
    recording, model = prepared_from(attached(), nominal(**ATTACHED))
    scales = measure_scales([recording], fit([recording], model))
    assert scales.spectrum == ()
    assert scales.depth == pytest.approx(float(np.max(np.abs(recording.observed.x))), rel=1e-6)


def test_a_stop_that_no_force_shows_does_not_hold_the_prediction_at_the_measurement() -> None:
    recording, model = prepared_from(attached(), nominal(**ATTACHED))
    depth = 0.7 * float(np.max(recording.observed.x))
    costs = [float(np.sum(residuals(
        recording, model.with_effect('bilinear_stiffness', (K_2, depth))) ** 2))
        for K_2 in (1e8, 1e10)]
    assert costs[1] > 1e3 * costs[0]


def test_two_tones_within_one_peak_of_the_spectrum_are_told_apart() -> None:
    swing = physics('beating_environment', 3e-4, 1.7, 0.7, 2.5e-4, 1.8, -0.5)
    recording, base = recalibrated(**swing)
    scales = measure_scales([recording], base)
    assert sorted(tone for tone, _ in scales.beat) == pytest.approx([1.7, 1.8], abs=0.03)
    assert sum(1.6 < tone < 1.9 for tone, _ in scales.peaks()) == 1
