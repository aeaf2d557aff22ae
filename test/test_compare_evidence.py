# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The evidence for models, against the integrals that it stands for, and what follows from it."""

from dataclasses import replace
from math import exp, log
from typing import Sequence

from contact_estimation.diagnosis.fit.beam import Compared, refit, search
from contact_estimation.diagnosis.fit.constants import CONSTANTS, Constants
from contact_estimation.diagnosis.fit.evidence import Evidence, explained, of_families, Scored
from contact_estimation.diagnosis.fit.names import name, Named, parts
from contact_estimation.diagnosis.next_experiment import perhaps
import numpy as np
import pytest
from scipy.integrate import quad

PARTS, COUNT = 5, 40.0
NONE = np.zeros(2)
CHEAP = CONSTANTS._replace(parameter=0.0, law=0.0, curve=0.0)


def scored(
    force: float | Sequence[float], *effects: str, motion: float = 1.0, laws: int | None = None
) -> Scored:
    """Make a model that leaves so much of each part, in squares of noise, fitted or left out."""
    squares = np.array([np.broadcast_to(force, PARTS), np.full(PARTS, motion)], float).T
    count = len(effects) if laws is None else laws
    return Scored(effects, tuple(f'family of {one}' for one in effects), effects, squares, squares,
                  np.full((PARTS, 2), COUNT), len(effects), count, 0)


def evidence(base: Scored, constants: Constants = CONSTANTS) -> Evidence:
    """Compare with a base, with an ideal instrument."""
    return Evidence(base, NONE, np.ones(2), constants)


def marginal(mean_square: float, freedom: float) -> float:
    """Integrate over its size the likelihood of a discrepancy with that freedom, beside noise."""
    energy = freedom + COUNT * (mean_square - 1.0)  # of residuals in the directions that it has

    def integrand(logarithm: float) -> float:  # of noise and discrepancy there, prior 1 / s
        return exp(-0.5 * freedom * logarithm - 0.5 * energy * exp(-logarithm))

    middle = log(energy / freedom)
    return log(quad(integrand, middle - 8.0, middle + 40.0, points=[middle], epsabs=0.0)[0])


@pytest.mark.parametrize('freedom', [2.0, 6.0])
def test_likelihood_with_a_discrepancy_is_that_of_a_slow_error_of_unknown_size(
    freedom: float
) -> None:
    found = evidence(scored(1.0), CHEAP._replace(independent=freedom))
    for one, other in ((9.0, 4.0), (4000.0, 1.5)):
        told = [found.log_likelihoods(scored(m))[1] for m in (one, other)]
        expected = marginal(one, freedom) - marginal(other, freedom)
        np.testing.assert_allclose(told[0] - told[1], expected, rtol=1e-6)


def test_errors_of_which_noise_is_a_bound_count_whole() -> None:
    found = replace(evidence(scored(1.0), CHEAP), white=False)
    told = [found.log_likelihoods(scored(m))[1] for m in (9.0, 4.0)]
    np.testing.assert_allclose(told[0] - told[1], -0.5 * CHEAP.independent * log(9.0 / 4.0))
    far = replace(evidence(scored(1e4), CHEAP._replace(ideal=0.0)), white=False)
    gain = far.score(scored(1.1)) - far.score(scored(2.0))
    assert gain == pytest.approx(0.5 * PARTS * CHEAP.independent * log(2.0 / 1.1))


def test_score_adds_the_likelihoods_and_the_prior() -> None:
    found, model = evidence(scored(30.0)), replace(scored(1.1, 'a', 'b'), curves=1)
    exact, inexact = found.log_likelihoods(model)
    c = CONSTANTS
    likelihood = np.logaddexp(exact.sum(), inexact.sum())
    assert found.score(model) == pytest.approx(
        likelihood - 2.0 * c.parameter - 2.0 * c.law - c.curve)


@pytest.mark.parametrize('gain, worth', [(0.9, False), (1.1, True)])
def test_a_law_is_taken_if_its_likelihood_pays_its_prior(gain: float, worth: bool) -> None:
    price = CONSTANTS.parameter + CONSTANTS.law
    left = 1000.0 * exp(-2.0 * gain * price / (PARTS * CONSTANTS.independent))
    base, law = scored(1000.0, motion=50.0), scored(left, 'a', motion=50.0)
    found = evidence(base, CONSTANTS._replace(ideal=0.0))
    assert (found.score(law) > found.score(base)) is worth


@pytest.mark.parametrize('base, best, worse', [
    # No part outweighs the others.
    ((2e3, 20, 20, 20, 20), scored((2e3, 2, 2, 2, 2), 'a'), scored((20, 20, 20, 20, 20), 'b')),
    # A model that leaves noise alone beats one that leaves a misfit, by however many laws.
    ((200, 200, 200, 200, 200), scored(1.0, 'a', 'b', 'c'), scored(20.0, 'd')),
    # What is less than any law idealises does not pay a law, but what is more does.
    ((1e3, 1e3, 1e3, 1e3, 1e3), scored(29.0, 'a'), scored(9.0, 'a', 'b')),
    ((1e3, 1e3, 1e3, 1e3, 1e3), scored(9.0, 'a', 'b'), scored(810.0, 'a')),
    # The same error by rarer curves is less likely.
    ((90, 90, 90, 90, 90), scored(5.0, 'a'), replace(scored(5.0, 'b'), curves=1))])
def test_order_of_models(base: Sequence[float], best: Scored, worse: Scored) -> None:
    constants = CHEAP._replace(ideal=0.0) if base[0] > 1e3 else CONSTANTS
    assert evidence(scored(base), constants).ranked([worse, best]) == [best, worse]


@pytest.mark.parametrize('share, named', [(0.9, False), (1.5, True)])
def test_no_law_is_exact_to_less_than_a_force_sensor_is(share: float, named: bool) -> None:
    range_in_noise = 2000.0  # of block means, so that its 0.05 % are as large as the noise
    base, law = scored(1.0 + share**2), scored(1.0, 'a')
    instrument = np.array([(CONSTANTS.instrument * range_in_noise) ** 2, 0.0])
    found = replace(evidence(base), instrument=instrument)
    assert (found.score(law) > found.score(base)) is named


def test_a_law_that_leaves_slow_residuals_is_not_exact() -> None:
    found, law = evidence(scored(90.0)), scored(1.0, 'a')
    slow = replace(law, white=False)
    assert found.is_exact(law) and not found.is_exact(slow)
    assert found.score(slow) == pytest.approx(
        found.log_likelihoods(slow)[1].sum() + found.log_prior(slow))


@pytest.mark.parametrize('rounding', [-1e-12, 0.0, 1e-12])
def test_ties_follow_the_prior_order_and_share_their_weight(rounding: float) -> None:
    first, second = scored(5.0 * (1.0 + rounding), 'a'), scored(5.0, 'b')
    found = evidence(scored(90.0))
    assert found.ranked([second, first]) == found.ranked([first, second]) == [first, second]
    np.testing.assert_allclose(found.weights([first, second], 0), 0.5, atol=1e-9)


def test_few_parts_prove_little() -> None:
    one_part = [scored((90, 90, 90, 90, 1e4)), scored((90, 90, 90, 90, 1.0), 'a')]
    every_part = [scored(300.0), scored(30.0, 'a')]
    few, all_of_them = (evidence(pair[0], CHEAP).weights(pair, 0)[1]
                        for pair in (one_part, every_part))
    assert few < all_of_them


def test_models_tell_how_large_noise_is_and_what_zeros_leave() -> None:
    base, zero = scored(1e6, motion=5.0), scored(100.0, 'bias', motion=5.0, laws=0)
    found = evidence(base).informed_by([base, zero, scored(1.3, 'a', motion=1.9)])
    np.testing.assert_allclose(found.noise, np.tile((1.3, 1.44), (PARTS, 1)))  # type: ignore
    for misfit in found.misfit:  # of inexact laws and of exact ones
        assert misfit == pytest.approx([99.0, 4.0])


def test_probability_of_a_family_is_the_weight_of_its_models() -> None:
    models = [scored(1.0), scored(1.0, 'a'), scored(1.0, 'a', 'b')]
    assert of_families(models, np.array([0.2, 0.5, 0.3])) == pytest.approx(
        {'family of a': 0.8, 'family of b': 0.3})


def test_share_is_that_of_the_squared_misfit_beyond_noise() -> None:
    share = explained(evidence(scored(101.0)), scored(26.0, 'a'))
    assert share.share == pytest.approx(0.75)
    assert share.interval == pytest.approx((0.75, 0.75))
    np.testing.assert_allclose(share.parts, 0.75)


@pytest.mark.parametrize('base, left, low, share', [
    ((101, 101, 101, 101, 101), (11, 191, 21, 186, 101), -np.inf, -0.01),  # parts that disagree
    ((101, 101, 101, 101, 4001), (6, 6, 6, 6, 4001), 0.0, 4 * 95.0 / 600.0),  # counts as two
])
def test_a_share_is_as_sure_as_parts_agree_and_no_part_is_it_alone(
    base: Sequence[float], left: Sequence[float], low: float, share: float
) -> None:
    found = explained(evidence(scored(base)), scored(left, 'a'))
    assert found.share == pytest.approx(share)
    assert found.interval[0] > low and (found.interval[0] < 0.0) is (share < 0.1)


def without(model: Scored, dropped: Sequence[str]) -> Scored | None:
    """Know no other models."""
    return None


def found_in(*models: Scored, instrument: float = 0.0) -> Named:
    """Name what is missing, of models of which the first is the base."""
    found = replace(evidence(models[0]), instrument=np.full(2, instrument))
    return name(Compared(found, found.ranked(models)), 0, without)


def named(*models: Scored) -> list[tuple[str, list[str]]]:
    """List the names, with those alike."""
    return [(one.effect, one.alike) for one in found_in(*models).names]


def test_the_likely_family_is_named_with_laws_alike() -> None:
    base, law = scored(300.0), scored(3.0, 'a')
    alike = replace(scored(3.0, 'b'), families=('family of a',))
    assert named(base, law) == [('a', [])]
    assert named(base, law, alike, scored(30.0, 'c')) == [('a', ['b'])]


def test_where_several_families_share_a_place_one_is_named_and_the_others_are_listed() -> None:
    base = scored(300.0)
    assert named(base, *(scored(3.0, one) for one in 'abc')) == [('a', ['b', 'c'])]
    both = [scored(3.0, 'a', one) for one in 'bc']
    assert named(base, scored(30.0, 'a'), *both) == [('a', []), ('b', ['c'])]


@pytest.mark.parametrize('models, names', [
    ([scored(1.0), scored(0.9, 'a')], []),
    ([scored(3.5), *(scored(3.0, one) for one in 'abc')], []),  # nothing is likelier than any
    ([scored(3e3), scored(1.9, 'a'), scored(2e3, 'b'), scored(1.0, 'a', 'b')], ['a']),  # a trifle
    ([scored(300.0), scored([3.0, 3.0, 3.0, 3.0, 900.0], 'a')], []),  # worse on one part
])
def test_what_is_unlikely_or_little_is_not_named(models: list[Scored], names: list[str]) -> None:
    assert [one for one, _ in named(*models)] == names


def test_a_law_that_shows_in_some_parts_is_named_unless_it_harms_others() -> None:
    base, some = scored(300.0), [20.0, 300.5, 300.5, 20.0, 300.5]
    assert named(base, scored(some, 'a')) == [('a', [])]
    assert named(base, scored([20.0, 340.0, 340.0, 20.0, 340.0], 'a')) == []


def test_a_zero_that_is_little_stays_in_the_model_of_a_law_alone() -> None:
    base, zero = scored(300.0), scored(295.0, 'force_bias', laws=0)
    beside = found_in(base, zero, scored(40.0, 'a'), scored(12.0, 'a', 'force_bias', laws=1))
    assert [one.effect for one in beside.names] == ['a']
    assert beside.model.effects == ('a', 'force_bias')
    alone = found_in(base, scored(280.0, 'force_bias', laws=0))
    assert not alone.names and not alone.model.effects


def test_laws_that_help_only_together_share_alike() -> None:
    every = [scored(301.0), scored(281.0, 'a'), scored(301.0, 'b'), scored(1.0, 'a', 'b')]
    compared = Compared(evidence(every[0]), every)
    told = parts(compared, found_in(*every), without)
    shares = {one: part.share.share for one, part in told.items()}
    assert shares == pytest.approx({'a': (20.0 + 300.0) / 600.0, 'b': (0.0 + 280.0) / 600.0})


@pytest.mark.parametrize('left, names', [(80.0, []), (20.0, ['robot_friction'])])
def test_friction_that_every_robot_has_is_named_beyond_what_every_instrument_leaves(
    left: float, names: list[str]
) -> None:
    found = found_in(scored(150.0), scored(left, 'robot_friction'), instrument=100.0)
    assert [one.effect for one in found.names] == names
    assert [one.effect for one in found_in(
        scored(150.0), scored(80.0, 'another_law'), instrument=100.0).names] == ['another_law']


class Worlds:
    """Models whose effects, each of a family of its own, leave shares of a misfit."""

    def __init__(self, **factors: float) -> None:
        self._factors, self.together, self.composed = factors, 1.0, False
        self.fitted, self.extended = list[frozenset[str]](), list[frozenset[str]]()

    def evidence(self) -> Evidence:
        """Compare with the base."""
        return evidence(scored(1e4))

    def extensions(self, one: Scored) -> list[Scored]:
        """Add each effect that is not there."""
        self.extended.append(one.key)
        added = [(*one.effects, more) for more in self._factors if more not in one.effects]
        return [scored(max(1e4 * float(np.prod([self._factors[each] for each in effects])), 1.0),
                       *effects) for effects in added]

    def compositions(self, rival: Scored) -> list[Scored]:
        """Return the effects that are little alone and much together."""
        self.composed = True
        return [] if self.together == 1.0 else [scored(1e4 * self.together, 'a', 'b')]

    def siblings(self, one: Scored) -> list[Scored]:
        """Return none."""
        return []

    def to_the_end(self, one: Scored) -> Scored | None:
        """Keep which are fitted."""
        self.fitted.append(one.key)
        return one


@pytest.mark.parametrize('factors, found, never', [
    ({'a': 0.25, 'b': 0.3, 'c': 0.95, 'd': 0.99}, {'a', 'b'}, 'fitted'),  # least of all d
    ({'d': 1e-4, 'b': 0.5}, {'d'}, 'extended'),  # nothing is left to gain
])
def test_search_adds_laws_that_pay(factors: dict[str, float], found: set[str], never: str) -> None:
    space = Worlds(**factors)
    compared = search(space, lambda text: None)
    assert compared.models[0].key == found
    assert compared.score == compared.evidence.score(compared.models[0])
    assert frozenset('d') not in getattr(space, never)


def test_pairs_that_are_little_alone_are_tried_while_much_is_left() -> None:
    space = Worlds(a=0.95, b=0.95, c=0.5)
    space.together = 0.01
    assert search(space, lambda text: None).models[0].key == {'a', 'b'}
    done = Worlds(a=1e-4)
    search(done, lambda text: None)
    assert space.composed and not done.composed


def test_known_models_are_fitted_again_and_the_best_is_extended() -> None:
    space = Worlds(a=0.01, b=0.02)
    known = refit(space, [scored(100.0, 'a')])
    assert [one.effects for one in known.models] == [('a',), ()] and not space.extended
    assert search(space, lambda text: None, known).models[0].key == {'a', 'b'}
    assert space.extended[0] == {'a'} and frozenset() not in space.extended


def test_a_law_that_is_likely_but_not_named_is_told() -> None:
    base, one, both = scored(1e4), scored(1200.0, 'a'), scored(800.0, 'a', 'b')
    found = evidence(base)
    models = [base, one, both]
    chance = of_families(models, found.weights(models, 0))['family of b']
    assert CONSTANTS.listed < chance < CONSTANTS.named
    expected = f'b may be missing too (probability {chance:.2f}): beside it 92 instead of 88 %'
    assert perhaps(found, models, one, 0).startswith(expected)
    assert not perhaps(found, models, both, 0)
