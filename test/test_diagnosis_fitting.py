# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Models as vectors of values, and their fits to recordings."""

from __future__ import annotations

from typing import Any

from concealed_worlds import MODEL, nominal, prepared_from, recorded
from contact_estimation.diagnosis.fit.fitting import fit
from contact_estimation.diagnosis.fit.model_uncertainty import discounted
from contact_estimation.diagnosis.fit.uncertainty import standard_deviations
from contact_estimation.diagnosis.observe.model import Model
import numpy as np
import pytest

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


def test_inertia_is_fitted_where_the_wall_has_one() -> None:
    model = Model.of(nominal(environment__inertia=2.0, environment__unilateral=False))
    assert model.values == (K_e, B_e, 2.0)
    assert model.laws().contact.inertia == 2.0
    assert model.with_effect('force_bias', (1.0,)).place('force_bias') == slice(3, 4)
