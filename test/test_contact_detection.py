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

"""Contact is decided by force: with hysteresis, debounced, noise and level learned outside."""

from __future__ import annotations

from typing import Any

from contact_estimation.signals.contact_detection import ContactDetector, ContactParameters
from core_runs import contact_samples, estimates_of, pipeline_with
from core_steps import decided
import numpy as np
import pytest

T, INSIDE, OUTSIDE = 0.002, True, False


def detector(**parameters: Any) -> ContactDetector:
    """Make a detector with 1 N of force noise: on above 4 N, off below 2 N, after 2 samples."""
    return ContactDetector(ContactParameters(**{'force_noise': 1.0, **parameters}))


def decisions(of: ContactDetector, forces: list[float], inside: bool = INSIDE) -> list[bool]:
    """Pass forces through a detector."""
    return [decided(of, T, force, inside) for force in forces]


def noise(count: int, level: float = 0.0, sigma: float = 1.0, seed: int = 11) -> list[float]:
    """Draw normal noise about a level [N]."""
    random = np.random.default_rng(seed)
    return [level + sigma * error for error in random.standard_normal(count).tolist()]


def test_contact_begins_after_consecutive_samples_above_the_threshold() -> None:
    assert decisions(detector(samples=3), [5.0] * 5) == [False, False, True, True, True]


def test_single_spikes_are_no_contact() -> None:
    assert not any(decisions(detector(), [5.0, 0.0] * 20))


def test_contact_ends_lower_than_it_begins() -> None:
    between = [5.0, 5.0, 3.0, 2.1, 1.9, 3.0, 3.0]
    assert decisions(detector(), between) == [False, True, True, True, False, False, False]


def test_force_between_the_thresholds_is_no_contact_from_outside() -> None:
    assert not any(decisions(detector(), [3.0] * 5))


def test_minimum_force_holds_whatever_the_noise() -> None:
    assert not any(decisions(detector(minimum_force=6.0), [5.9] * 5))


def test_force_outside_the_wall_is_no_contact() -> None:
    assert not any(decisions(detector(), [50.0] * 100, OUTSIDE))


def test_contact_ends_outside_the_wall_whatever_the_force() -> None:
    of = detector()
    decisions(of, [50.0] * 3)
    assert not decided(of, T, 50.0, OUTSIDE)


def test_noise_level_is_learned_in_free_flight() -> None:
    of = detector(force_noise=0.1)
    decisions(of, noise(5000, sigma=2.0), OUTSIDE)
    assert np.sqrt(of.noise_variance) == pytest.approx(2.0, rel=0.15)


def test_bias_is_learned_in_free_flight() -> None:
    of = detector()
    decisions(of, noise(5000, level=7.0), OUTSIDE)
    assert of.level == pytest.approx(7.0, abs=0.3)


def test_nothing_is_learned_in_contact() -> None:
    of = detector()
    decisions(of, noise(500), OUTSIDE)
    decisions(of, [50.0, 50.0])
    before = of.level, of.noise_variance
    decisions(of, noise(500, level=50.0, sigma=5.0))
    assert (of.level, of.noise_variance) == before


def test_learning_does_not_depend_on_one_outlier() -> None:
    of = detector()
    decisions(of, [*noise(2000), 1e6], OUTSIDE)
    assert abs(of.level) < 0.3 and of.noise_variance < 1.5


def test_wrench_that_never_meets_the_wall_stays_free_for_ever() -> None:
    of = detector()
    assert not any(decisions(of, noise(20_000)))


def test_new_thresholds_keep_what_was_learned() -> None:
    of = detector()
    decisions(of, noise(2000, level=3.0), OUTSIDE)
    before = of.level, of.noise_variance
    of.configure(ContactParameters(force_noise=1.0, on_ratio=6.0))
    assert (of.level, of.noise_variance) == before


def test_new_force_noise_replaces_what_was_learned() -> None:
    of = detector()
    decisions(of, noise(2000), OUTSIDE)
    of.configure(ContactParameters(force_noise=3.0))
    assert of.noise_variance == 9.0


def test_reset_forgets_contact_level_and_noise() -> None:
    of = detector()
    decisions(of, noise(500, level=5.0), OUTSIDE)
    decisions(of, [50.0] * 3)
    of.reset()
    assert (of.contact, of.level, of.noise_variance) == (False, 0.0, 1.0)


def test_contact_lasts_as_long_as_the_wall_presses() -> None:
    samples = contact_samples(1.0, force_noise=0.3)
    estimates = estimates_of(samples, pipeline_with(contact__force_noise=0.3))
    touching = [s.force < -3.0 for s in samples]
    in_contact = [e.status.value != 'free' for e in estimates]
    assert sum(a != b for a, b in zip(touching, in_contact)) <= 4
