# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Prediction of parts left out: as of full refits, shares, and values on each part."""

from __future__ import annotations

from concealed_worlds import physics, prepared_from, recorded
from contact_estimation.diagnosis.compare.shares import explained
from contact_estimation.diagnosis.fit.fitting import Fit, fit, residual_function
from contact_estimation.diagnosis.fit.left_out import Linearised
from contact_estimation.diagnosis.fit.parts import parts_of
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
