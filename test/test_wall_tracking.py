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

"""A new wall, a step and a surface elsewhere are followed by every estimator."""

from __future__ import annotations

from typing import Any

from contact_estimation.estimators import ESTIMATORS
from contact_estimation.signals.contact_sample import ContactSample
from core_runs import contact_samples, estimates_of, PERIOD_NS, pipeline_with
import numpy as np
import pytest

TRACKED = [name for name, cls in ESTIMATORS.items() if cls.may_restart]
LINEAR = [name for name in TRACKED if name != 'hunt_crossley']  # the exponent explains an offset
EACH = pytest.mark.parametrize('estimator', TRACKED)
EACH_LINEAR = pytest.mark.parametrize('estimator', LINEAR)
NOISE = 0.3


def touch(K_e: float, contact_s: float = 1.0, seed: int = 0, **motion: Any) -> list[ContactSample]:
    """Press with about 50 N and a tenth of it in motion."""
    depth = 50.0 / K_e
    return contact_samples(contact_s, K_e, 3.0 * K_e**0.5, **{
        'depth': depth, 'amplitude': 0.1 * depth, 'force_noise': NOISE, 'seed': seed, **motion})


def one_after_the_other(*parts: list[ContactSample]) -> list[ContactSample]:
    """Join recordings in time."""
    joined = [sample for part in parts for sample in part]
    return [s._replace(stamp_ns=k * PERIOD_NS) for k, s in enumerate(joined)]


def moved(samples: list[ContactSample], by: float) -> list[ContactSample]:
    """Let the surface be elsewhere than x_e = 0."""
    return [s._replace(position=s.position + by) for s in samples]


@EACH
@pytest.mark.parametrize('first, second', [(300.0, 30_000.0), (30_000.0, 300.0)])
def test_new_wall_is_followed(estimator: str, first: float, second: float) -> None:
    before, after = touch(first), touch(second, 2.5, 1)
    pipeline = pipeline_with(estimator=estimator)
    estimates = estimates_of(one_after_the_other(before, after), pipeline)[len(before):]
    begin = next(k for k, s in enumerate(after) if s.position > 0.0)
    deadline = begin + (250 if estimator in LINEAR else 1000)
    np.testing.assert_allclose([e.stiffness for e in estimates[deadline:]], second, rtol=0.1)


@EACH
@pytest.mark.parametrize('factor', [2.0, 0.5])
def test_step_in_contact_is_followed_in_a_quarter_of_a_second(
    estimator: str, factor: float
) -> None:
    samples = contact_samples(2.0, 4800.0, 100.0, force_noise=NOISE)
    step = 900
    after = contact_samples(2.0, 4800.0 * factor, 100.0, force_noise=NOISE)
    estimates = estimates_of(samples[:step] + after[step:], pipeline_with(estimator=estimator))
    followed = [e.stiffness for e in estimates[step + 125:]]
    np.testing.assert_allclose(followed, 4800.0 * factor, rtol=0.1)


@EACH_LINEAR
def test_estimate_of_the_last_contact_is_a_prior_of_the_next(estimator: str) -> None:
    first = touch(5000.0, 1.0)
    pipeline = pipeline_with(estimator=estimator)
    before = estimates_of(first, pipeline)[-1]
    second = one_after_the_other(first, touch(5000.0, 0.05, 1))[len(first):]
    after = estimates_of(second, pipeline)
    free = [e for e, s in zip(after, second) if s.position < 0.0]
    assert {e.stiffness for e in free} == {before.stiffness}
    touching = next(e for e, s in zip(after, second) if s.position > 0.0015)
    assert touching.stiffness == pytest.approx(5000.0, rel=0.2)
    assert touching.stiffness_std > 3.0 * before.stiffness_std


@EACH_LINEAR
@pytest.mark.parametrize('shift', [2e-3, -2e-3])
@pytest.mark.parametrize('K_e, excited', [(5000.0, True), (5000.0, False), (30_000.0, True)])
def test_surface_2_mm_elsewhere_costs_less_than_3_percent(
    estimator: str, K_e: float, excited: bool, shift: float
) -> None:
    amplitude = 0.3 * 50.0 / K_e if excited else 0.0
    samples = moved(touch(K_e, 2.0, amplitude=amplitude), shift)  # a touch-down of 0.1 s
    last = estimates_of(samples, pipeline_with(estimator=estimator))[-1]
    assert last.stiffness == pytest.approx(K_e, rel=0.03)
    assert last.location == pytest.approx(shift, abs=0.03 * 50.0 / K_e + 5e-5)


@EACH
def test_known_surface_stays_where_it_is(estimator: str) -> None:
    samples = touch(5000.0, 2.0)
    pipeline = pipeline_with(estimator=estimator)
    estimates_of(samples, pipeline)
    assert pipeline.location_shift == 0.0 and not pipeline.location_unchecked


def test_contact_without_a_touch_down_does_not_show_its_surface() -> None:
    rest = touch(5000.0)[-1]._replace(position=0.01, velocity=0.0, force=-50.0)
    noise = NOISE * np.random.default_rng(2).standard_normal(1000)
    samples = one_after_the_other([rest._replace(force=rest.force + e) for e in noise.tolist()])
    pipeline = pipeline_with(estimator='rls_adaptive')
    estimates_of(samples, pipeline)
    assert pipeline.location_unchecked


@pytest.mark.parametrize('amplitude', [0.0, 1e-3])
@pytest.mark.parametrize('place', [0.0, 0.05])
def test_start_in_contact_claims_only_what_the_motion_shows(
    place: float, amplitude: float
) -> None:
    samples = moved(touch(5000.0, 2.0, amplitude=amplitude), place)
    inside = [s for s in samples if s.position > place + 0.009][:500]
    estimates = estimates_of(inside, pipeline_with(estimator='rls_adaptive'))
    told = [e for e in estimates if e.stiffness_std == e.stiffness_std]
    assert len(told) > 400
    assert all(abs(e.stiffness - 5000.0) < 2.0 * e.stiffness_std for e in told)
    unknown = told[-1].stiffness_std > 2000.0
    assert unknown == (place > 0.0 or amplitude == 0.0)


@EACH
def test_without_restarts_the_estimator_follows_alone(estimator: str) -> None:
    before, after = touch(300.0), touch(30_000.0, 0.3, 1)
    pipeline = pipeline_with(estimator=estimator, tracking__restarts=False)
    restarted: list[float] = []
    pipeline.estimator.restart = lambda *values: restarted.append(0.0)  # type: ignore[assignment]
    estimates_of(one_after_the_other(before, after), pipeline)
    assert not restarted


def test_reset_forgets_where_the_surface_is() -> None:
    pipeline = pipeline_with(estimator='rls_adaptive')
    estimates_of(moved(touch(5000.0), 2e-3), pipeline)
    assert pipeline.location_shift != 0.0
    pipeline.reset()
    assert pipeline.location_shift == 0.0
