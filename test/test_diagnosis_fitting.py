# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Fits of models to recordings, and prediction of parts left out of them."""

from __future__ import annotations

from typing import Any

from concealed_worlds import MODEL, physics, prepared_from, recorded
from contact_estimation.diagnosis.fit.discrepancy import discounted, standard_deviations
from contact_estimation.diagnosis.fit.evidence import explained
from contact_estimation.diagnosis.fit.fitting import Fit, fit, residual_function
from contact_estimation.diagnosis.fit.left_out import Linearised, parts_of
from contact_estimation.diagnosis.fit.screening import measure_scales, Screening, Step
from contact_estimation.diagnosis.fit.space import candidates_in, ContactModels
from contact_estimation.diagnosis.observe.prepared_recording import PreparedRecording
import numpy as np
import pytest
from scipy.optimize import least_squares

K_e, B_e = MODEL['environment.stiffness'], MODEL['environment.damping']
STIFFER: dict[str, Any] = {'environment__stiffness': 5600.0, 'environment__damping': 90.0}


def test_fit_recovers_stiffness_and_damping() -> None:
    recording, model = prepared_from(recorded(**STIFFER))
    found = fit([recording], model)
    assert found.model.values == pytest.approx((5600.0, 90.0), rel=0.01)
    assert found.residual_count == recording.residual_count


def test_fit_stays_within_the_ranges_of_the_parameters() -> None:
    recording, model = prepared_from(recorded())
    found = fit([recording], model.with_effect('coulomb_friction', (1.0,)))
    low, high = found.model.bounds
    assert np.all(low <= found.model.values) and np.all(found.model.values <= high)
    assert found.model.values[-1] < 0.05


@pytest.mark.slow
def test_standard_deviations_cover_the_errors() -> None:
    errors = []
    for seed in (1, 2, 3):
        recording, model = prepared_from(recorded(seed=seed))
        recording = discounted(recording, model)
        found = fit([recording], model)
        errors += list((np.array(found.model.values) - (K_e, B_e))
                       / standard_deviations([recording], found))
    assert np.sqrt(np.mean(np.square(errors))) < 3.0


FRICTION = 6.0
LAWS = {'coulomb_friction': (FRICTION,), 'contact_offset': (4e-4,)}


def with_law(name: str) -> tuple[PreparedRecording, Fit, Fit]:
    """Fit a world with a law, without and with it."""
    recording, model = prepared_from(recorded(**physics(name, *LAWS[name])))
    base = fit([recording], model)
    start = tuple(0.3 * value for value in LAWS[name])
    return recording, base, fit([recording], base.model.with_effect(name, start))


@pytest.mark.parametrize('name', LAWS)
def test_left_out_error_is_that_of_a_full_refit(name: str) -> None:
    recording, base, found = with_law(name)
    parts = parts_of([recording], base)
    told = Linearised([recording], found, parts)
    function = residual_function([recording], found.model, robust=False)
    bent = residual_function([recording], found.model)
    for k, part in enumerate(parts):
        rest = ~part.there
        refitted = least_squares(
            lambda values, rest=rest: bent(values)[rest], found.model.coordinates,
            x_scale=found.model.steps, diff_step=1e-5)
        left = function(refitted.x)[part.there] ** 2 * told.in_noise[part.there]
        by_channel = [left[told.channel[part.there] == k] for k in (0, 1)]
        expected = [np.mean(np.minimum(one, 25.0 * max(1.0, np.median(one) / 0.455)))
                    for one in by_channel]  # an outlier counts as one at five deviations
        np.testing.assert_allclose(told.left_out[k], expected, rtol=0.1)
    assert told.left_out.sum() > told.fitted.sum()


def test_a_law_is_predicted_and_has_the_same_value_on_every_part() -> None:
    recording, base, found = with_law('coulomb_friction')
    models = ContactModels([recording], base)
    evidence = models.evidence()
    lawful = models.without(models._scored([recording], found), [])
    share = explained(evidence, lawful)
    assert share.share == pytest.approx(1.0, abs=0.05)
    assert share.interval[0] > 0.9 and (share.parts > 0.8).all()
    alone = [lawful.found.values_on(part).values[-1] for part in models.parts]
    assert alone == pytest.approx([FRICTION] * len(alone), rel=0.15)


def recalibrated(**changes: Any) -> tuple[PreparedRecording, Fit]:
    """Recalibrate the nominal model on a world's recording."""
    recording, model = prepared_from(recorded(**changes))
    return recording, fit([recording], model)


def steps(recording: PreparedRecording, base: Fit, *names: str) -> dict[str, list[Step]]:
    """Take the steps of effects beside the recalibrated model."""
    every = names or candidates_in([recording], base.model)
    screening = Screening([recording], base, every, measure_scales([recording], base))
    return screening.steps(base.model, every)


@pytest.mark.slow
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
