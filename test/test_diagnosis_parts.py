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

"""Parts of recordings with few contacts, and what is decided from them."""

from __future__ import annotations

from functools import lru_cache

from concealed_worlds import diagnosed, named, nominal, prepared_from, recorded, touches
from contact_estimation.diagnosis.conclude.shares import Shares
from contact_estimation.diagnosis.fit.fitting import Fit, fit
from contact_estimation.diagnosis.fit.parts import parts_of
from contact_estimation.diagnosis.observe.prepared_recording import PreparedRecording
from contact_estimation.diagnosis.observe.signals import Signals
import numpy as np
import pytest

SPRING = nominal(environment__stiffness=1000.0, environment__damping=5.0,
                 environment__unilateral=False)


@lru_cache(maxsize=None)
def prepared() -> tuple[PreparedRecording, Fit]:
    """Record two touches and fit the right model."""
    recording, model = prepared_from(recorded(touches((0.03, 1.0), (0.024, 0.8))))
    return recording, fit([recording], model)


def test_parts_of_few_contacts_hold_every_sample_once_with_the_free_flight() -> None:
    recording, base = prepared()
    parts = parts_of([recording], base)
    assert len(parts) == 4
    counted = np.sum([part.there for part in parts], axis=0)
    filled = np.concatenate([one.filled for one in recording.channels(base.model)])
    fitted = np.tile(recording.blocks(recording.use.astype(float)) > 0.0, 2)
    assert (counted[filled & fitted] == 1).all() and counted.max() == 1


def test_parts_of_a_single_event_are_pieces_of_all_contacts() -> None:
    recording, base = prepared()
    first = parts_of([recording], base)[0]
    event = np.zeros_like(base.residuals)
    event[np.flatnonzero(first.there)[::2]] = 10.0  # in the first half of the first touch alone
    parts = parts_of([recording], base._replace(residuals=base.residuals + event))
    assert len(parts) == 4 and all(part.name.endswith('1 piece in 2') for part in parts)
    of_event = [float(np.sum(event[part.there] ** 2)) for part in parts]
    assert min(of_event[:2]) > 0.3 * sum(of_event) and sum(of_event[2:]) == 0.0


def spring(cubic: float, stray: float, noise_std: float = 1e-3) -> Signals:
    """Record an attached spring with a curvature; its force also strays by so much [N]."""
    t = np.arange(2000) / 100.0
    x = 0.01 * np.sin(2.0 * t) + 0.005 * np.sin(5.3 * t)
    v = 0.02 * np.cos(2.0 * t) + 0.0265 * np.cos(5.3 * t)
    force = 1000.0 * x + 5.0 * v + cubic * x**3 + stray * np.sin(0.7 * t) * np.sin(3.1 * t)
    noise = np.random.default_rng(4).normal(0.0, noise_std, len(t))
    return Signals(t, noise - force, t, x, np.empty(0), np.empty((4, 0)))


@pytest.mark.parametrize('constant, names', [(True, ['cubic_stiffness']), (False, [])])
def test_an_effect_smaller_than_the_noise_is_named_if_it_is_the_same_on_all_parts(
    constant: bool, names: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    if not constant:
        monkeypatch.setattr(Shares, 'is_constant', lambda self, name: False)
    assert named(diagnosed(spring(3e4, 0.0, 0.03), SPRING)) == names


@pytest.mark.parametrize('cubic, stray, verdict, names', [
    (6e5, 0.1, 'physics_missing', ['cubic_stiffness']),
    (1.5e4, 0.0, 'physics_missing', ['cubic_stiffness']),
    (1.5e4, 0.02, 'recalibrate', []),
])
def test_an_inexact_law_is_named_only_if_it_is_no_trifle_beside_the_force(
    cubic: float, stray: float, verdict: str, names: list[str]
) -> None:
    diagnosis = diagnosed(spring(cubic, stray), SPRING)
    assert (diagnosis.verdict, named(diagnosis)) == (verdict, names)


def test_a_law_whose_size_differs_between_parts_makes_room_for_the_next(
    monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Shares, 'agrees', lambda self, name: name != 'cubic_stiffness')
    effect, = diagnosed(spring(6e5, 0.1), SPRING).effects
    assert effect.family == 'elastic_law' and effect.name != 'cubic_stiffness'
