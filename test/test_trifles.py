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

"""Tests that curves through a small imperfection get no name, and laws of the same size do."""

from __future__ import annotations

from dataclasses import replace

from concealed_worlds import diagnosed, nominal, prepared_from
from contact_estimation.diagnosis.conclude.trifles import without_unconfirmed_trifles
from contact_estimation.diagnosis.fit.discrepancy import correlation_time, has_discrepancy, weighed
from contact_estimation.diagnosis.fit.fitting import fit
from contact_estimation.diagnosis.observe.model import Model
from contact_estimation.diagnosis.observe.prepared_recording import PreparedRecording
from contact_estimation.diagnosis.observe.residuals import residuals
from contact_estimation.diagnosis.observe.signals import Signals
from contact_estimation.diagnosis.report.text_report import as_text
import numpy as np
from numpy.typing import NDArray
import pytest

Array = NDArray[np.float64]

T = np.arange(0.0, 20.0, 0.01)
DEPTH = 5e-3 + 4e-3 * np.sin(2.0 * T) * np.cos(0.31 * T)
STIFFNESS, NOISE = 1000.0, 2e-3
SPRING = nominal(environment__stiffness=STIFFNESS, environment__damping=0.0,
                 environment__unilateral=False)


def specimen(depth: Array, cubic: float, stray: Array) -> tuple[PreparedRecording, Model]:
    force = -(STIFFNESS * depth + cubic * depth**3) + stray
    return prepared_from(Signals(T, force, T, depth, np.empty(0), np.empty((4, 0))), SPRING)


@pytest.mark.parametrize('cubic, wave, trifle', [
    (4e5, 0.0, False), (4e5, 5.0, True), (4e6, 5.0, False)])
def test_a_trifle_is_worth_its_name_only_if_it_leaves_white_noise(
    cubic: float, wave: float, trifle: bool
) -> None:
    noise = NOISE * np.random.default_rng(3).standard_normal(len(T))
    prepared, model = specimen(DEPTH, cubic, wave * NOISE * np.sin(1.1 * T) + noise)
    recordings = [replace(prepared, force_noise=5.0 * NOISE)]  # as of rounded positions
    base, best = fit(recordings, model), fit(
        recordings, model.with_effect('cubic_stiffness', (cubic,)))
    assert best.cost < best.residual_count < base.cost
    assert (correlation_time(residuals(recordings[0], best.model)) > 8.0) is (wave > 0.0)
    assert (without_unconfirmed_trifles(recordings, base, best) is base) is trifle


@pytest.mark.parametrize('cubic, turns, trifle', [
    (4e5, False, True), (4e5, True, False), (4e6, False, False)])
def test_a_single_stroke_confirms_no_trifle(cubic: float, turns: bool, trifle: bool) -> None:
    ramp = 9e-3 * T / T[-1]
    depth = np.where(ramp < 4.5e-3, 2.0 * ramp, 2.0 * (9e-3 - ramp)) if turns else ramp
    noise = NOISE * np.random.default_rng(3).standard_normal(len(T))
    prepared, model = specimen(depth, cubic, noise)
    base, best = fit([prepared], model), fit(
        [prepared], model.with_effect('cubic_stiffness', (cubic,)))
    assert best.cost < 1.1 * best.residual_count < base.cost
    assert (without_unconfirmed_trifles([prepared], base, best) is base) is trifle


@pytest.mark.parametrize('cubic, trifle', [(4e5, True), (4e6, False)])
def test_nor_does_one_in_which_something_else_is_missing(cubic: float, trifle: bool) -> None:
    noise = NOISE * np.random.default_rng(3).standard_normal(len(T))
    stray = 6.0 * NOISE * np.sin(1.1 * T) + noise
    prepared, model = specimen(9e-3 * T / T[-1], cubic, stray)
    lawful = model.with_effect('cubic_stiffness', (cubic,))
    recordings = weighed([prepared], fit([prepared], lawful).model)
    assert has_discrepancy(recordings)
    base, best = fit(recordings, model), fit(recordings, lawful)
    rest = without_unconfirmed_trifles(recordings, base, best)
    assert (rest is base) is trifle and (rest is None) is not trifle


def test_what_is_too_little_for_a_name_in_a_single_stroke_is_not_unexplained_either() -> None:
    ramp = 9e-3 * T / T[-1]
    noise = NOISE * np.random.default_rng(3).standard_normal(len(T))
    stray = 6.0 * NOISE * np.sin(1.1 * T) + noise
    for cubic, verdict in ((8e5, 'recalibrate'), (1e6, 'physics_missing')):
        force = -(STIFFNESS * ramp + cubic * ramp**3) + stray
        found = diagnosed(Signals(T, force, T, ramp, np.empty(0), np.empty((4, 0))), SPRING)
        assert found.verdict == verdict
        told = 'Held-out residual' in as_text(found)
        assert told is (verdict == 'recalibrate')
