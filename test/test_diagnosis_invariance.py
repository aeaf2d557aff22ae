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

"""Prediction of parts left out: shares, parameters on each part, and the discrepancy."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

from concealed_worlds import ATTACHED, attached, nominal, physics, prepared_from, recorded
from contact_estimation.diagnosis.fit.candidate import assess, Candidate
from contact_estimation.diagnosis.fit.criteria import predicts_enough
from contact_estimation.diagnosis.fit.discrepancy import (
    correlation_time,
    forces,
    has_discrepancy,
    material,
    with_discrepancy,
    without_discrepancy,
)
from contact_estimation.diagnosis.fit.fitting import Fit, fit, residual_function
from contact_estimation.diagnosis.fit.invariance import (
    channel_by_gain,
    channel_of,
    left_out_errors,
    values_on,
)
from contact_estimation.diagnosis.fit.jacobian import differentiate_by
from contact_estimation.diagnosis.fit.parts import above_noise, evened, noise_of, Part, parts_of
from contact_estimation.diagnosis.fit.ranking import first_that_predicts
from contact_estimation.diagnosis.fit.share import Share, share_of
from contact_estimation.diagnosis.observe.model import Model
from contact_estimation.diagnosis.observe.prepared_recording import PreparedRecording
import numpy as np
from numpy.typing import NDArray
import pytest
from scipy.optimize import least_squares

FRICTION = 6.0


def rubbing() -> tuple[PreparedRecording, Fit, Fit]:
    """Fit a world with friction, without and with that effect."""
    recording, model = prepared_from(recorded(**physics('coulomb_friction', FRICTION)))
    base = fit([recording], model)
    return recording, base, fit([recording], base.model.with_effect('coulomb_friction', (1.0,)))


def part_of(name: str, there: NDArray[np.bool_]) -> Part:
    """Make a part of one channel."""
    count = np.count_nonzero(there)
    return Part(name, there, np.zeros(count, int), np.ones(count), np.array([count, 0.0]))


def test_parts_are_the_touches_and_do_not_overlap() -> None:
    recording, base, _ = rubbing()
    parts = parts_of([recording], base)
    assert len(parts) >= 3
    assert np.sum([part.there for part in parts], axis=0).max() == 1
    assert all(part.noise.sum() == pytest.approx(np.count_nonzero(part.there)) for part in parts)


def test_parts_of_an_attached_wall_are_blocks_of_time() -> None:
    recording, model = prepared_from(attached(), nominal(**ATTACHED))
    parts = parts_of([recording], fit([recording], model))
    assert len(parts) == 4 and all(part.name.endswith(' s') for part in parts)
    sizes = [np.count_nonzero(part.there) for part in parts]
    assert max(sizes) - min(sizes) <= 2


def test_left_out_error_is_that_of_a_full_refit() -> None:
    recording, base, found = rubbing()
    parts = parts_of([recording], base)
    errors = left_out_errors([recording], found, parts)
    function = residual_function([recording], found.model)
    for part, error in zip(parts, errors):
        rest = ~part.there
        refitted = least_squares(
            lambda values, rest=rest: function(values)[rest], found.model.coordinates,
            x_scale=found.model.steps, diff_step=1e-5)
        left = function(refitted.x)[part.there]
        assert error.sum() == pytest.approx(float(left @ left), rel=0.02)


def test_a_part_that_the_rest_does_not_determine_is_not_predicted_but_widens_nothing() -> None:
    there = np.ones(100, bool)
    parts = [part_of(str(k), there)._replace(noise=np.zeros(2)) for k in range(4)]
    before = np.column_stack([np.full(4, 100.0), np.zeros(4)])
    after = np.column_stack([[100.0, 10.0, 12.0, 8.0], np.zeros(4)])
    share = share_of(before, after, parts, before)
    determined = share_of(before[1:], after[1:], parts[1:], before[1:])
    assert share.share == pytest.approx(0.675)
    assert share.parts[0] == 0.0 and share.harm == 0.0
    assert np.array(share.interval) == pytest.approx(0.75 * np.array(determined.interval))
    assert share_of(before, np.minimum(before, [[100.0, 0.0]] * 3 + [[5.0, 0.0]]), parts,
                    before).interval == (-np.inf, np.inf)


def test_law_takes_nearly_all_of_every_part_and_has_the_same_parameter_there() -> None:
    recording, base, found = rubbing()
    parts = parts_of([recording], base)
    before = left_out_errors([recording], base, parts)
    share = share_of(before, left_out_errors([recording], found, parts, before), parts, before)
    assert share.share == pytest.approx(1.0, abs=0.05)
    assert share.interval[0] > 0.9 and (share.parts > 0.8).all()
    alone = [values_on([recording], found, part).values[-1] for part in parts]
    assert alone == pytest.approx([FRICTION] * len(parts), rel=0.15)


def test_what_the_rest_does_not_determine_predicts_nothing() -> None:
    recording, _, found = rubbing()
    function, values = residual_function([recording], found.model), found.model.coordinates
    felt = differentiate_by(values, found.model.steps, function, function(values))[:, -1] != 0.0
    sliding = part_of('all that friction shows in', felt)
    assert not felt.all()
    unknown = left_out_errors([recording], found, [sliding])
    left = left_out_errors([recording], found, [sliding], 2.0 * unknown)
    assert left.tolist() == (2.0 * unknown).tolist()


def test_share_of_parts_that_disagree_has_an_interval_around_zero() -> None:
    parts = [part_of(str(k), np.zeros(1, bool)) for k in range(4)]
    before, after = np.full((4, 2), [100.0, 0.0]), np.zeros((4, 2))
    after[:, 0] = 10.0, 190.0, 20.0, 185.0
    share = share_of(before, after, parts, before)
    assert share.interval[0] < 0.0 < share.interval[1]
    assert not predicts_enough(share, share)


def test_noise_estimated_too_large_makes_no_share_above_one() -> None:
    parts = [part_of(str(k), np.zeros(1, bool))._replace(noise=np.array([90.0, 0.0]))
             for k in range(4)]
    before, after = np.full((4, 2), [100.0, 0.0]), np.full((4, 2), [20.0, 0.0])
    share = share_of(before, after, parts, before)
    assert share.share == pytest.approx(1.0)
    assert share.parts.tolist() == pytest.approx([1.0] * 4)


def test_effect_is_judged_by_the_misfit_of_its_channel() -> None:
    parts = [part_of(str(k), np.zeros(1, bool)) for k in range(4)]
    before, after = np.full((4, 2), [300.0, 100.0]), np.full((4, 2), [300.0, 10.0])
    assert share_of(before, after, parts, before).share == pytest.approx(0.225)
    assert share_of(before, after, parts, before, 1).share == pytest.approx(0.9)
    assert channel_of('robot_friction') == 1
    assert channel_of('coulomb_friction') == channel_of('force_lag') == 0
    assert channel_of('force_gain') is None


def test_effect_of_the_robot_that_shows_in_the_force_is_judged_by_both_channels() -> None:
    in_force, in_motion = np.array([3.0, 1.0]), np.array([1.0, 3.0])
    assert channel_by_gain('joint_flexibility', in_force) is None
    assert channel_by_gain('joint_flexibility', in_motion) == 1
    assert channel_by_gain('coulomb_friction', in_motion) == 0


def test_channels_of_a_part_add_up_to_its_residuals() -> None:
    recording, base, _ = rubbing()
    for part in parts_of([recording], base):
        force, motion = part.squares(base.residuals)
        assert min(force, motion) > 0.0
        assert force + motion == pytest.approx(float(np.sum(base.residuals[part.there] ** 2)))


def test_most_of_the_rest_is_not_enough_if_it_is_a_trifle_of_the_whole() -> None:
    trifle, most = (Share(value, (0.9 * value, 1.1 * value), np.ones(3)) for value in (0.05, 0.8))
    some = Share(0.4, (0.3, 0.5), np.ones(3))
    assert not predicts_enough(most, trifle)
    assert predicts_enough(most, trifle, zero=True)
    assert not predicts_enough(some, trifle, zero=True)
    assert predicts_enough(some, some)


def test_an_uncertain_share_is_enough_where_the_effect_harms_no_part() -> None:
    uncertain = Share(0.4, (0.05, 0.75), np.array([0.9, 0.0, 0.1]))
    assert predicts_enough(uncertain, uncertain)
    assert not predicts_enough(uncertain._replace(harm=0.1), uncertain)


@pytest.mark.parametrize('needs_bias', [True, False])
def test_a_law_that_predicts_too_little_alone_is_tried_beside_a_bias(needs_bias: bool) -> None:
    parts = [part_of(str(k), np.arange(4) == k)._replace(noise=np.zeros(2)) for k in range(4)]
    before = np.tile([100.0, 0.0], (4, 1))
    model = Model.of(nominal()).with_effect('coulomb_friction', (1.0,))

    def candidate(share: float, found: Model) -> Candidate:
        left = (1.0 - share) * before
        return Candidate(Fit(found, 0.0, np.zeros(4), 4), left, left, None, False)

    alone = candidate(0.25, model)
    beside = candidate(0.7, model.with_effect('force_bias', (1.0,)) if needs_bias else model)
    zeros: Any = SimpleNamespace(parts=parts, names=('force_bias',), beside=lambda one: beside)
    taken = first_that_predicts([], [alone], zeros, before, before)
    assert taken is (beside if needs_bias else None)


def test_a_law_that_is_refused_beside_the_zeros_makes_room_for_the_next() -> None:
    parts = [part_of(str(k), np.arange(4) == k)._replace(noise=np.zeros(2)) for k in range(4)]
    before = np.tile([100.0, 0.0], (4, 1))

    def candidate(share: float, name: str, *values: float) -> Candidate:
        found = Fit(Model.of(nominal()).with_effect(name, values), 0.0, np.zeros(4), 4)
        left = (1.0 - share) * before
        return Candidate(found, left, left, None, False)

    simple = candidate(0.84, 'cubic_stiffness', 1e7)
    best = candidate(0.87, 'fractional_relaxation', 30.0, 0.3)
    bias = candidate(0.6, 'force_bias', 1.0)
    zeros: Any = SimpleNamespace(parts=parts, names=('force_bias',),
                                 beside=lambda one: None if one is simple else one)
    taken = first_that_predicts([], [bias, best, simple], zeros, before, before)
    assert taken is best


@pytest.mark.parametrize('fitted, named', [
    (0.9, 'presliding_friction'), (0.5, 'bilinear_stiffness')])
def test_a_law_that_fits_far_better_goes_before_one_that_predicts_little_better(
    fitted: float, named: str
) -> None:
    parts = [part_of(str(k), np.arange(4) == k)._replace(noise=np.zeros(2)) for k in range(4)]
    before = np.tile([100.0, 0.0], (4, 1))

    def candidate(left_out: float, fitted: float, name: str, *values: float) -> Candidate:
        found = Fit(Model.of(nominal()).with_effect(name, values), 0.0, np.zeros(4), 4)
        return Candidate(found, (1.0 - left_out) * before, (1.0 - fitted) * before, None, False)

    laws = [candidate(0.53, 0.53, 'bilinear_stiffness', 500.0, 0.002),
            candidate(0.5, fitted, 'presliding_friction', 1.0, 1e4)]
    assert laws[0].expected == pytest.approx(0.47 * 400.0)
    assert laws[1].expected == pytest.approx(400.0 * (0.632 * 0.5 + 0.368 * (1.0 - fitted)), 1e-3)
    zeros: Any = SimpleNamespace(parts=parts, names=(), beside=lambda one: one)
    taken = first_that_predicts([], laws, zeros, before, before)
    assert taken is not None and taken.name == named


@pytest.mark.parametrize('attached, named', [(True, 'force_bias'), (False, 'contact_offset')])
def test_of_offsets_alike_that_of_the_sensor_is_taken(attached: bool, named: str) -> None:
    parts = [part_of(str(k), np.arange(4) == k)._replace(noise=np.zeros(2)) for k in range(4)]
    before = np.tile([100.0, 0.0], (4, 1))

    def candidate(share: float, name: str, *values: float) -> Candidate:
        model = Model.of(nominal(environment__unilateral=not attached)).with_effect(name, values)
        left = (1.0 - share) * before
        return Candidate(Fit(model, float(left.sum()), np.zeros(4), 4), left, left, None, False)

    # A play with a centre is an offset too, and fits a little better.
    laws = [candidate(0.905, 'free_play', 1e-5, 1e-3, 1.0), candidate(0.9, 'contact_offset', 1e-3),
            candidate(0.8999, 'force_bias', 1.0)]
    zeros: Any = SimpleNamespace(parts=parts, names=(), beside=lambda one: one)
    taken = first_that_predicts([], laws, zeros, before, before)
    assert taken is not None and taken.name == named


@pytest.mark.parametrize('of_time, named', [(0.45, True), (0.8, False)])
def test_no_law_is_taken_where_time_alone_predicts_far_better(of_time: float, named: bool) -> None:
    parts = [part_of(str(k), np.arange(4) == k)._replace(noise=np.zeros(2)) for k in range(4)]
    before = np.tile([100.0, 0.0], (4, 1))

    def candidate(share: float, name: str, *values: float, flexible: bool = False) -> Candidate:
        found = Fit(Model.of(nominal()).with_effect(name, values), 0.0, np.zeros(4), 4)
        left = (1.0 - share) * before
        return Candidate(found, left, left, None, flexible)

    law = candidate(0.4, 'bilinear_stiffness', 500.0, 0.002)
    drift = candidate(of_time, 'stiffness_drift', 0.01, flexible=True)
    zeros: Any = SimpleNamespace(parts=parts, names=(), beside=lambda one: one)
    taken = first_that_predicts([], [law, drift], zeros, before, before)
    assert taken is (law if named else None)


def test_discrepancy_brings_every_channel_to_variance_one() -> None:
    recording, base, _ = rubbing()
    weighed = with_discrepancy(recording, base.model)
    function = residual_function([weighed], base.model, robust=False)
    left = weighed.split(function(base.model.coordinates))
    powers = [float(np.mean(part[channel.filled] ** 2))
              for part, channel in zip(left, weighed.channels(base.model))]
    assert powers == pytest.approx([1.0, 1.0], abs=0.2)
    assert has_discrepancy([weighed]) and not has_discrepancy([without_discrepancy(weighed)])


def test_channels_are_compared_as_forces() -> None:
    recording, base, _ = rubbing()
    weighed = with_discrepancy(recording, base.model)
    force, motion = forces(weighed, base.model)
    assert motion == pytest.approx(force, rel=0.5)  # the wall's friction pushes the robot too


def test_exact_model_leaves_no_discrepancy_worth_a_name() -> None:
    recording, model = prepared_from(recorded())
    assert not material([with_discrepancy(recording, model)], model)


def test_correlation_time_is_that_of_an_autoregressive_process() -> None:
    rng, phi = np.random.default_rng(3), 0.8
    values = np.zeros(20_000)
    for k, push in enumerate(rng.normal(size=len(values) - 1)):
        values[k + 1] = phi * values[k] + push
    assert correlation_time(values) == pytest.approx((1.0 + phi) / (1.0 - phi), rel=0.15)
    assert correlation_time(rng.normal(size=5000)) == pytest.approx(1.0, abs=0.15)


def test_model_keeps_its_values_where_a_part_tells_nothing() -> None:
    recording, base, found = rubbing()
    nothing = part_of('nothing', np.zeros(len(found.residuals), bool))
    assert isinstance(values_on([recording], found, nothing), Model)
    assert values_on([recording], found, nothing).values == pytest.approx(found.model.values)


def test_no_part_outweighs_the_others() -> None:
    parts = [part_of(str(k), np.zeros(1, bool)) for k in range(5)]
    before, after = np.zeros((5, 2)), np.zeros((5, 2))
    before[:, 0], after[:, 0] = (100.0, 100.0, 100.0, 100.0, 4000.0), (5.0, 5.0, 5.0, 5.0, 3900.0)
    plain = share_of(before, after, parts, before)
    parts, before = evened(parts, before)
    assert before[:, 0].tolist() == [100.0, 100.0, 100.0, 100.0, 200.0]
    after[-1] *= 200.0 / 4000.0
    even = share_of(before, after, parts, before)
    assert plain.share < 0.15 and even.share == pytest.approx((4 * 95.0 + 5.0) / 600.0)
    assert even.interval[0] > 0.0 > plain.interval[0] - 0.15


@pytest.mark.parametrize('name, values, clips', [
    ('force_saturation', (25.0,), True), ('bilinear_stiffness', (-4500.0, 0.003), False)])
def test_a_saturating_sensor_leaves_the_force_level_and_a_soft_wall_does_not(
    name: str, values: tuple[float, ...], clips: bool
) -> None:
    recording, model = prepared_from(recorded(**physics(name, *values)))
    base = fit([recording], model)
    found = fit([recording], base.model.with_effect('force_saturation', (25.0,)))
    parts = parts_of([recording], base)
    before = left_out_errors([recording], base, parts)
    assert len(assess([recording], [found], parts, before, None)) == clips


def test_noise_estimated_too_large_in_one_channel_does_not_hide_a_misfit_in_the_other() -> None:
    parts = [Part(name, np.ones(4, bool), np.array([0, 0, 1, 1]), np.ones(4),
                  np.array([10.0, 10.0])) for name in 'ab']
    squares = np.array([[14.0, 5.0], [12.0, 3.0]])
    np.testing.assert_allclose(noise_of(squares, parts), [[10.0, 4.0], [10.0, 4.0]])
    np.testing.assert_allclose(above_noise(squares, parts), [5.0, 1.0])
    np.testing.assert_allclose(above_noise(squares, parts, slice(0, 1)), [4.0, 2.0])
