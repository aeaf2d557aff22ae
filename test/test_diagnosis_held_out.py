# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Held-out parts: their choice, and the errors of models on them."""

from __future__ import annotations

from dataclasses import replace

from concealed_worlds import (
    ATTACHED,
    attached,
    diagnosed,
    FORCE_NOISE,
    FREE,
    nominal,
    physics,
    prepared_from,
    recorded,
    Swing,
    Touch,
    touches,
)
from contact_estimation.diagnosis.conclude.held_out import (
    by_part,
    errors_of,
    improvement_interval,
    measure_part,
    Part,
)
from contact_estimation.diagnosis.conclude.result import Errors
from contact_estimation.diagnosis.fit.free_run import free_run, steps_a_sample
from contact_estimation.diagnosis.observe import episodes as episodes_module
from contact_estimation.diagnosis.observe.episodes import episodes, hold_out, require_contact
from contact_estimation.diagnosis.observe.model import Model
from contact_estimation.diagnosis.observe.observed import Observed
from contact_estimation.diagnosis.observe.residuals import force_residual
from contact_estimation.diagnosis.observe.signals import Signals
from contact_estimation.exceptions import RecordingError
from contact_estimation.reference.experiment import Experiment, Segment
import numpy as np
from numpy.typing import NDArray
import pytest
from scipy.ndimage import uniform_filter1d

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

MODEL = Model.of(nominal())
DEPTHS = [(0.02, 0.03, 0.01), (0.01, 0.03, 0.02), (0.03, 0.02, 0.01), (0.02, 0.01, 0.03, 0.015),
          (0.01, 0.015, 0.03, 0.02), (0.02, 0.02, 0.02)]


def moved(depths: tuple[float, ...]) -> Observed:
    """Observe a motion that dips to given depths, each for half a second."""
    parts = []
    for depth in depths:
        parts += [np.full(50, -0.01), np.full(50, depth)]
    return at(np.concatenate([*parts, np.full(50, -0.01)]))


def at(x: Array) -> Observed:
    """Observe positions, one every 10 ms."""
    h, nothing = 0.01, np.zeros(len(x))
    force, t = np.where(x > 0.0, -5000.0 * x, 0.0), np.linspace(0.0, h * (len(x) - 1), len(x))
    return Observed(t, h, force, np.ones(len(x), bool), x, x, nothing,
                    nothing, None, 1e-6, 20.0)


def test_episodes_are_the_touches() -> None:
    recording, model = prepared_from(recorded())
    o = recording.observed
    found = episodes(model, o)
    assert len(found) == 3
    for first, stop in found:
        assert o.x[first] > 0.0 >= o.x[first - 1]
        assert o.x[stop - 1] > 0.0 >= o.x[stop]


def test_short_touches_are_no_episodes() -> None:
    short = moved((0.02, 0.03))
    x = short.x.copy()
    x[50:85] = -0.01
    found = episodes(MODEL, Observed(short.t, short.h, short.force, short.measured, x, x, short.v,
                                     short.a, None, 1e-6, 20.0))
    assert found == [(150, 200)]


@pytest.mark.parametrize('samples, found', [(20, []), (35, [(1000, 1035)])])
def test_short_touches_are_episodes_if_all_are_short(
    samples: int, found: list[tuple[int, int]]
) -> None:
    x = np.full(8000, -0.01)
    x[1000:1000 + samples] = 0.02
    o = at(x)
    brief = replace(o, t=0.1 * o.t, h=0.1 * o.h)  # 35 ms at 1 kHz, of 8 s
    assert episodes(MODEL, brief) == found


@pytest.mark.parametrize('depths', DEPTHS)
def test_deepest_episode_is_never_held_out(depths: tuple[float, ...]) -> None:
    o = moved(depths)
    part = hold_out(MODEL, o)
    held = [k for k, (first, stop) in enumerate(episodes(MODEL, o))
            if part.samples[first:stop].any()]
    assert len(held) == 1
    assert part.name == f'episode {held[0] + 1}'
    assert held[0] != int(np.argmax(depths))


@pytest.mark.parametrize('depths', DEPTHS)
def test_held_out_episode_is_whole_and_cut_in_free_flight(depths: tuple[float, ...]) -> None:
    o = moved(depths)
    samples = hold_out(MODEL, o).samples
    edges = np.flatnonzero(np.diff(samples.astype(int)))
    assert np.all(o.x[edges] < 0.0)
    assert 0 < np.count_nonzero(samples) < len(o.t)


def spans(samples: Flags) -> list[tuple[int, int]]:
    """Return first and last sample of each stretch."""
    edges = np.flatnonzero(np.diff(samples.astype(int), prepend=0, append=0))
    return [(int(first), int(stop) - 1) for first, stop in zip(edges[::2], edges[1::2])]


def in_late_thirds(samples: Flags, first: int, stop: int) -> bool:
    """Return whether each third of an interval holds one stretch, in its last three fifths."""
    third = (stop - first) / 3.0
    begins = [first + (k + 0.4) * third for k in range(3)]
    return len(spans(samples)) == 3 and all(
        begin <= there[0] and there[1] <= begin + 0.6 * third
        for begin, there in zip(begins, spans(samples)))


def test_of_one_episode_of_fewer_samples_than_blocks_the_whole_recording_counts(
    monkeypatch: pytest.MonkeyPatch
) -> None:
    o = moved((0.02,))
    monkeypatch.setattr(episodes_module, 'episodes', lambda model, observed: [(138, 150)])
    assert in_late_thirds(hold_out(MODEL, o).samples, 0, 150)


def test_of_one_episode_a_late_block_of_each_third_is_held_out() -> None:
    part = hold_out(MODEL, moved((0.02,)))
    assert in_late_thirds(part.samples, 50, 100)
    assert part.name.endswith(' s') and part.name.count(' to ') == 3


def test_of_two_episodes_blocks_of_the_second_are_held_out() -> None:
    assert in_late_thirds(hold_out(MODEL, moved((0.02, 0.03))).samples, 150, 200)


def test_held_out_blocks_lie_where_the_rest_has_been_too() -> None:
    t = 0.01 * np.arange(450)
    x = np.where((t > 3.9) & (t < 4.2), 0.03, 0.0102 + 0.01 * np.sin(4.0 * t))
    *_, last = spans(hold_out(MODEL, at(x)).samples)  # elsewhere than usual: x is new there
    assert last[0] >= 420 or last[1] < 390


def test_where_the_motion_comes_late_blocks_have_equal_paths() -> None:
    t = np.linspace(0.0, 50.0, 5001)
    x = 0.01 * np.sin(12.0 * t) * np.maximum(t - 42.0, 0.0) / 8.0  # a growing cyclic test
    o = replace(at(x), force=-5000.0 * x)
    samples = hold_out(Model.of(nominal(**ATTACHED)), o).samples
    felt = np.abs(o.force) > 0.005 * o.force_range
    path = felt * np.abs(np.diff(x, append=x[-1]))
    assert path[samples].sum() == pytest.approx(0.2 * path.sum(), rel=0.02)
    assert np.max(np.abs(x[samples])) < 0.97 * np.max(np.abs(x))


def test_path_without_a_force_is_none() -> None:
    t = np.linspace(0.0, 50.0, 5001)
    x = 0.01 * t / 50.0
    x[4950:] = -0.03  # a specimen that is loaded slowly, then let go
    assert in_late_thirds(hold_out(Model.of(nominal(**ATTACHED)), at(x)).samples, 0, len(x))


def test_of_an_attached_wall_a_late_block_of_each_third_is_held_out() -> None:
    recording, model = prepared_from(attached(), nominal(**ATTACHED))
    samples = hold_out(model, recording.observed).samples
    assert np.mean(samples) == pytest.approx(0.2, abs=0.01)
    assert in_late_thirds(samples, 0, len(samples))


def test_recording_without_contact_is_refused() -> None:
    with pytest.raises(RecordingError, match='free.mcap has no contact of 30 samples.*location'):
        require_contact(MODEL, moved((-0.001, -0.002)), 'free.mcap')


def part_of(recalibrated: Array, corrected: Array) -> Part:
    """Make a part with given squared errors, ten samples a block."""
    force = np.array([recalibrated, recalibrated, corrected])
    return Part('part', force, np.full(len(recalibrated), 10.0), None, np.zeros(0))


def test_errors_are_root_mean_squares_over_all_parts() -> None:
    parts = [part_of(np.full(4, 90.0), np.full(4, 10.0)), part_of(np.zeros(2), np.zeros(2))]
    force, motion = errors_of(parts)
    assert force.recalibrated == pytest.approx(np.sqrt(4 * 90.0 / 60.0))
    assert force.corrected == pytest.approx(np.sqrt(4 * 10.0 / 60.0))
    assert motion == Errors(None, None, None)
    assert [part.force.corrected for part in by_part(parts)] == pytest.approx([1.0, 0.0])


def test_improvement_of_equal_blocks_is_certain() -> None:
    interval = improvement_interval([part_of(np.full(6, 90.0), np.full(6, 10.0))],
                                    np.random.default_rng(0))
    assert interval == pytest.approx((1.0 - 1.0 / 3.0,) * 2)


def test_interval_of_an_improvement_holds_it() -> None:
    generator = np.random.default_rng(1)
    recalibrated, corrected = (s * generator.chisquare(10, 40) for s in (90.0, 10.0))
    interval = improvement_interval([part_of(recalibrated, corrected)], np.random.default_rng(0))
    assert interval is not None
    low, high = interval
    assert low < 1.0 - 1.0 / 3.0 < high
    assert high - low < 0.2


def test_no_improvement_gives_an_interval_around_nothing() -> None:
    generator = np.random.default_rng(2)
    one, other = (generator.chisquare(10, 40) for _ in range(2))
    interval = improvement_interval([part_of(one, other)], np.random.default_rng(0))
    assert interval is not None and interval[0] < 0.0 < interval[1]


def test_one_block_has_no_interval() -> None:
    single = part_of(np.array([90.0]), np.array([10.0]))
    assert improvement_interval([single], np.random.default_rng(0)) is None


def test_same_generator_gives_the_same_interval() -> None:
    part = part_of(np.arange(1.0, 20.0), np.arange(2.0, 21.0))
    first, second = (improvement_interval([part], np.random.default_rng(5)) for _ in range(2))
    assert first == second


def test_part_measures_the_force_in_contact_and_the_motion_after_its_start() -> None:
    recording, model = prepared_from(recorded())
    o = recording.observed
    samples = o.t < 2.0
    part = measure_part('first', recording, samples, [model] * 3, [o.raw_position + 1e-3] * 3)
    touching = samples & recording.use & (o.x > 0.0)
    assert part.samples.sum() == np.count_nonzero(touching)
    assert part.force[0].sum() == pytest.approx(
        float(np.sum(force_residual(recording, model)[touching] ** 2)))
    assert errors_of([part])[1].nominal == pytest.approx(1e-3)
    assert part.motion_samples.sum() == np.count_nonzero(samples & (o.t >= 0.5))


def test_true_model_predicts_a_part_to_its_noise() -> None:
    recording, model = prepared_from(recorded())
    everything = np.ones(len(recording.observed.t), bool)
    part = measure_part('all', recording, everything, [model] * 3, None)
    assert errors_of([part])[0].nominal == pytest.approx(FORCE_NOISE, rel=0.06)
    assert part.motion is None


@pytest.mark.slow
@pytest.mark.parametrize('touch', [(0.03, 1.2), (0.02, 1.5)])
def test_one_real_touch_holds_out_part_of_itself(touch: Touch) -> None:
    recording, model = prepared_from(recorded(touches(touch, swing=0.006)))
    part = hold_out(model, recording.observed)
    assert np.all(recording.observed.x[part.samples] > 0.0)


def hasty() -> Experiment:
    """Touch thrice, the second time in a hurry and not deep."""
    segments = [Segment(0.7, FREE)]
    for rise, depth in ((0.5, 0.03), (0.1, 0.015), (0.5, 0.036)):
        begin = sum(segment.duration for segment in segments) + rise
        segments += [Segment(rise, depth),
                     Segment(0.8, depth, position_excitation=Swing(0.003, begin, 0.8)),
                     Segment(0.2, depth), Segment(0.5, FREE), Segment(0.3, FREE)]
    return Experiment('hasty', FREE, tuple(segments))


def test_a_model_that_a_held_out_part_contradicts_is_not_consistent() -> None:
    signals = recorded(hasty(), **physics('actuator_saturation', 85.0))
    recording, model = prepared_from(signals)
    assert hold_out(model, recording.observed).name == 'episode 2'
    found = diagnosed(signals)
    assert found.motion.recalibrated is not None and found.motion.recalibrated > 1e-3
    assert found.verdict != 'consistent'


def test_free_run_of_a_hysteresis_that_bends_within_micrometres_is_stable() -> None:
    recording, model = prepared_from(recorded())
    bends = model.with_effect('bouc_wen_hysteresis', (6e4, 4e4, 8e3))
    assert steps_a_sample(bends, recording.observed) > steps_a_sample(model, recording.observed)
    x = free_run(bends, recording.observed).position
    assert np.max(np.abs(x - recording.observed.x)) < 1e-3


def test_friction_is_named_though_it_looks_like_a_damper_where_data_are_held_out() -> None:
    t, seed = np.asarray(0.02 * np.arange(1000), np.float64), 1
    # Late blocks are held out, of one speed.
    first = [(4.0, 5.7), (10.6, 12.3), (17.2, 18.9)]
    steady = np.any([(t > begin) & (t < end) for begin, end in first], axis=0)
    speed = np.where(steady, 0.87, np.where((1.1 * t) % 1.0 < 0.5, 0.2, 1.0))
    v = uniform_filter1d(speed * np.where((t // 3.3) % 2 == 0, -1.0, 1.0), 7)
    x = 0.02 * np.cumsum(v)
    friction = 0.4 * (1.0 + 0.25 * np.sin(9.0 * x)) * np.tanh(v / 0.01)
    noise = 0.01 * np.random.default_rng(seed).standard_normal(len(t))
    signals = Signals(t, -friction - 0.05 * v + noise, t, x, np.empty(0), np.empty((4, 0)))
    found = diagnosed(signals, nominal(
        environment__unilateral=False, environment__stiffness=0.0, environment__damping=0.4))
    assert [effect.family for effect in found.effects] == ['friction']
