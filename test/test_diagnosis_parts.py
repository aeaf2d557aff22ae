# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Parts of recordings with few contacts, and what is decided from them."""

from __future__ import annotations

from functools import lru_cache
from types import SimpleNamespace
from typing import Any

from concealed_worlds import diagnosed, named, nominal, prepared_from, recorded, touches
from contact_estimation.diagnosis.conclude import conclusion
from contact_estimation.diagnosis.conclude.conclusion import _free_runs
from contact_estimation.diagnosis.conclude.result import Errors
from contact_estimation.diagnosis.fit.fitting import Fit, fit
from contact_estimation.diagnosis.fit.parts import parts_of
from contact_estimation.diagnosis.observe.model import Model
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


@pytest.mark.parametrize('attached', [True, False])
def test_parts_of_one_stroke_are_pieces_of_the_whole_stroke(attached: bool) -> None:
    # A spring that is stiffer from a depth on: no part before it tells of that.
    t = np.arange(2000) / 100.0
    noise = np.random.default_rng(4).normal(0.0, 1e-3, len(t))
    model = SPRING if attached else nominal(
        environment__stiffness=1000.0, environment__damping=0.0)
    for x, count in ((0.0005 * t, 5), (0.005 * (1.0 - np.cos(2.0 * t)), 1)):
        force = 1000.0 * x + 300.0 * np.maximum(x - 0.002, 0.0)
        signals = Signals(t, noise - force, t, x, np.empty(0), np.empty((4, 0)))
        recording, start = prepared_from(signals, model)
        parts = parts_of([recording], fit([recording], start))
        stretches = [np.count_nonzero(np.diff(part.there.astype(int)) == 1) for part in parts[1:]]
        assert len(parts) >= 4 and set(stretches) == {count}


def spring(cubic: float, stray: float, noise_std: float = 1e-3) -> Signals:
    """Record an attached spring with a curvature; its force also strays by so much [N]."""
    t = np.arange(2000) / 100.0
    x = 0.01 * np.sin(2.0 * t) + 0.005 * np.sin(5.3 * t)
    v = 0.02 * np.cos(2.0 * t) + 0.0265 * np.cos(5.3 * t)
    force = 1000.0 * x + 5.0 * v + cubic * x**3 + stray * np.sin(0.7 * t) * np.sin(3.1 * t)
    noise = np.random.default_rng(4).normal(0.0, noise_std, len(t))
    return Signals(t, noise - force, t, x, np.empty(0), np.empty((4, 0)))


@pytest.mark.parametrize('cubic, names', [(3e4, []), (1e5, ['cubic_stiffness'])])
def test_what_is_less_than_noise_is_known_to_gets_no_name(cubic: float, names: list[str]) -> None:
    found = diagnosed(spring(cubic, 0.0, 0.03), SPRING)
    assert named(found) == names
    assert (found.verdict == 'physics_missing') is bool(names)


@pytest.mark.parametrize('cubic, stray, verdict, names', [
    (6e5, 0.1, 'physics_missing', ['cubic_stiffness']),
    (1.5e4, 0.0, 'physics_missing', ['cubic_stiffness']),
    (1.5e4, 0.02, 'consistent', []),
])
def test_an_inexact_law_is_named_only_if_it_is_no_trifle_beside_the_force(
    cubic: float, stray: float, verdict: str, names: list[str]
) -> None:
    diagnosis = diagnosed(spring(cubic, stray), SPRING)
    assert (diagnosis.verdict, named(diagnosis)) == (verdict, names)


@pytest.mark.parametrize('friction, stray, names', [
    (0.12, 0.06, ['friction']), (0.12, 0.08, ['friction']), (0.05, 0.02, ['friction']),
    (0.02, 0.06, [])])
def test_little_is_named_if_one_law_explains_most_of_it(
    friction: float, stray: float, names: list[str]
) -> None:
    signals = spring(0.0, stray)
    rubbed = friction * np.sign(np.gradient(signals.position, signals.joint_t))
    assert friction < 0.01 * float(np.ptp(signals.force))
    diagnosis = diagnosed(signals._replace(force=signals.force - rubbed), SPRING)
    assert [effect.family for effect in diagnosis.effects] == names


def test_a_spring_that_bends_and_rubs_lacks_both_laws() -> None:
    signals = spring(2e6, 0.1)
    rubbed = 1.0 * np.tanh(np.gradient(signals.position, signals.joint_t) / 1e-3)
    found = diagnosed(signals._replace(force=signals.force - rubbed), SPRING)
    assert {effect.family for effect in found.effects} == {'elastic_law', 'friction'}
    assert found.verdict == 'physics_missing'


def test_a_single_event_does_not_hide_a_law_that_holds_everywhere_else() -> None:
    signals = spring(2e6, 0.0)
    hit = signals.force + np.where(abs(signals.wrench_t - 4.3) < 0.2, 3.0, 0.0)
    found = diagnosed(signals._replace(force=hit), SPRING)
    assert [effect.family for effect in found.effects] == ['elastic_law']


@pytest.mark.parametrize('driven, away, told', [
    (True, 2.0, False), (True, 0.5, True), (False, 2.0, True)])
def test_a_free_run_that_drifts_away_tells_nothing(
    monkeypatch: pytest.MonkeyPatch, driven: bool, away: float, told: bool
) -> None:
    x = 1e-3 * np.sin(np.arange(100.0))  # moved by 1 N
    recording: Any = SimpleNamespace(observed=SimpleNamespace(
        x=x, force=1e3 * x, has_dynamics=lambda nominal: True,
        driven_by_force=lambda nominal: driven))
    model = Model.of(SPRING)
    monkeypatch.setattr(conclusion, 'free_run', lambda model, observed: SimpleNamespace(
        position=x + away * 2e-3))
    assert (_free_runs(recording, [model, model, model]) is not None) is told


@pytest.mark.parametrize('recalibrated, corrected, noise, share', [
    (1.0, 0.5, 0.0, 0.75), (1.0, 0.3, 0.3, 1.0), (1.0, 1.2, 0.3, -0.4835),
    (0.34, 0.31, 0.3, None), (None, None, 0.3, None)])
def test_held_out_data_tell_the_share_that_names_explain_beyond_noise(
    recalibrated: float | None, corrected: float | None, noise: float, share: float | None
) -> None:
    told = Errors(3.0, recalibrated, corrected).explained(noise, 0.2)
    assert told == (None if share is None else pytest.approx(share, abs=1e-3))


def test_a_misfit_that_the_held_out_part_does_not_show_tells_nothing_of_names() -> None:
    assert Errors(3.0, 1.0, 0.9).explained(0.1, 1.1) is None
