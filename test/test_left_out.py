# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Prediction of parts left out: as of full refits, shares, and values on each part."""

from __future__ import annotations

from concealed_worlds import ATTACHED, attached, nominal, physics, prepared_from, recorded
from contact_estimation.diagnosis.compare.shares import explained
from contact_estimation.diagnosis.fit.fitting import Fit, fit, residual_function
from contact_estimation.diagnosis.fit.left_out import Linearised
from contact_estimation.diagnosis.fit.parts import Part, parts_of
from contact_estimation.diagnosis.fit.space import ContactModels
from contact_estimation.diagnosis.observe.prepared_recording import PreparedRecording
import numpy as np
import pytest
from scipy.optimize import least_squares

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


def test_errors_of_all_parts_are_those_of_the_fit() -> None:
    recording, base, found = with_law('contact_offset')
    parts = parts_of([recording], base)
    told = Linearised([recording], found, parts)
    here = residual_function([recording], found.model, robust=False)(found.model.coordinates)
    of_parts = np.any([part.there for part in parts], axis=0)
    assert (told.fitted * told.counts).sum() == pytest.approx(
        float(np.sum(here[of_parts] ** 2)), rel=0.01)
    assert told.counts.sum() == np.count_nonzero(of_parts)


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


def test_model_keeps_its_values_where_a_part_tells_nothing() -> None:
    recording, _, found = with_law('coulomb_friction')
    nothing = Part('nothing', np.zeros(len(found.residuals), bool))
    model = Linearised([recording], found, [nothing]).values_on(nothing)
    assert model.values == pytest.approx(found.model.values)


def test_what_the_rest_does_not_determine_stays_near_its_value() -> None:
    recording, _, found = with_law('coulomb_friction')
    whole = Part('all', np.ones(len(found.residuals), bool))
    told = Linearised([recording], found, [whole])
    np.testing.assert_allclose(told.left_out, told.fitted, rtol=0.05)


def test_parts_are_the_touches_and_do_not_overlap() -> None:
    recording, base, _ = with_law('coulomb_friction')
    parts = parts_of([recording], base)
    assert len(parts) >= 3
    assert np.sum([part.there for part in parts], axis=0).max() == 1


def test_parts_of_an_attached_wall_are_blocks_of_time() -> None:
    recording, model = prepared_from(attached(), nominal(**ATTACHED))
    parts = parts_of([recording], fit([recording], model))
    assert len(parts) == 4 and all(part.name.endswith(' s') for part in parts)
    sizes = [np.count_nonzero(part.there) for part in parts]
    assert max(sizes) - min(sizes) <= 2
