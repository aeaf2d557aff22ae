# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""What is held out of a recording, and what it tells."""

from dataclasses import replace

from concealed_worlds import nominal, prepared_from, recorded
from contact_estimation.diagnosis.held_out import by_part, errors_of, HeldOutPart
from contact_estimation.diagnosis.observe.model import Model
from contact_estimation.diagnosis.observe.observed import Observed
from contact_estimation.diagnosis.observe.parts import episodes, hold_out
from contact_estimation.diagnosis.result import Errors
import numpy as np
from numpy.typing import NDArray
import pytest

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

ATTACHED = Model.of(nominal(environment__unilateral=False, environment__stiffness=60.0,
                            environment__damping=20.0))
HELD_OUT_MODEL = Model.of(nominal())
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
    return Observed(t, h, force, np.ones(len(x), bool), x, x, nothing, nothing, None, 1e-6, 20.0)


def test_episodes_are_the_touches() -> None:
    recording, model = prepared_from(recorded())
    o = recording.observed
    found = episodes(model, o)
    assert len(found) == 3
    for first, stop in found:
        assert o.x[first] > 0.0 >= o.x[first - 1]
        assert o.x[stop - 1] > 0.0 >= o.x[stop]


def test_contact_that_is_hardly_deep_beside_others_is_no_episode() -> None:
    assert len(episodes(HELD_OUT_MODEL, moved((0.01, 0.0001, 0.01)))) == 2


@pytest.mark.parametrize('depths', DEPTHS)
def test_held_out_episode_is_whole_and_cut_in_free_flight(depths: tuple[float, ...]) -> None:
    o = moved(depths)
    samples = hold_out(HELD_OUT_MODEL, o).samples
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


def test_of_one_episode_a_late_block_of_each_third_is_held_out() -> None:
    part = hold_out(HELD_OUT_MODEL, moved((0.02,)))
    assert in_late_thirds(part.samples, 50, 100)
    assert part.name.endswith(' s') and part.name.count(' to ') == 3


def test_blocks_are_held_out_where_a_force_acts() -> None:
    x = np.concatenate((np.linspace(0.001, 0.01, 500), np.linspace(0.01, 0.001, 500)))
    o, late = at(x), np.arange(1000) >= 300
    samples = hold_out(ATTACHED, replace(o, force=np.where(late, 0.0, o.force))).samples
    assert samples.any() and not samples[late].any()


def part_of(recalibrated: Array, corrected: Array) -> HeldOutPart:
    """Make a part with given squared errors, ten samples a block."""
    force = np.array([recalibrated, recalibrated, corrected])
    return HeldOutPart('part', force, np.full(len(recalibrated), 10.0), None, np.zeros(0))


def test_errors_are_root_mean_squares_over_all_parts() -> None:
    parts = [part_of(np.full(4, 90.0), np.full(4, 10.0)), part_of(np.zeros(2), np.zeros(2))]
    force, motion = errors_of(parts)
    assert force.recalibrated == pytest.approx(np.sqrt(4 * 90.0 / 60.0))
    assert force.corrected == pytest.approx(np.sqrt(4 * 10.0 / 60.0))
    assert motion == Errors(None, None, None)
    assert [part.force.corrected for part in by_part(parts)] == pytest.approx([1.0, 0.0])


@pytest.mark.parametrize('recalibrated, corrected, noise, share', [
    (1.0, 0.5, 0.0, 0.75), (1.0, 0.3, 0.3, 1.0), (1.0, 1.2, 0.3, -0.4835),
    (0.34, 0.31, 0.3, None), (None, None, 0.3, None)])
def test_held_out_data_tell_the_share_that_names_explain_beyond_noise(
    recalibrated: float | None, corrected: float | None, noise: float, share: float | None
) -> None:
    told = Errors(3.0, recalibrated, corrected).explained(noise, 0.2)
    assert told == (None if share is None else pytest.approx(share, abs=1e-3))
