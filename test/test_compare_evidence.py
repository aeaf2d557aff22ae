# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The evidence for models, against the integrals that it stands for, and what follows from it."""

from __future__ import annotations

from dataclasses import replace
from math import exp, log
from typing import Sequence

from contact_estimation.diagnosis.compare.beam import Compared, refit, search
from contact_estimation.diagnosis.compare.constants import CONSTANTS, Constants
from contact_estimation.diagnosis.compare.evidence import Evidence, of_families, Scored
from contact_estimation.diagnosis.compare.names import name
from contact_estimation.diagnosis.compare.shares import explained
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


def test_likelihood_without_a_discrepancy_is_that_of_white_noise() -> None:
    draw = np.random.default_rng(1).normal(size=(2, int(COUNT)))
    squares = np.mean((1.5 * draw) ** 2, axis=1)
    model = scored(float(squares[0]), motion=float(squares[1]))
    exact, _ = evidence(scored(1.0)).log_likelihoods(model)
    by_sample = -0.5 * np.sum((1.5 * draw) ** 2) + 0.5 * draw.size  # up to a common constant
    np.testing.assert_allclose(exact, by_sample, rtol=1e-9)


def test_likelihood_is_that_of_both_errors_as_left_out_and_as_fitted() -> None:
    model = replace(scored(4.0), left_out=scored(9.0).left_out)
    share = CONSTANTS.left_out
    expected = scored(share * 9.0 + (1.0 - share) * 4.0)
    found = evidence(scored(1.0))
    assert found.score(model) == pytest.approx(found.score(expected))


def test_score_adds_the_likelihoods_and_the_prior() -> None:
    found, model = evidence(scored(30.0)), replace(scored(1.1, 'a', 'b'), curves=1)
    exact, inexact = found.log_likelihoods(model)
    c = CONSTANTS
    likelihood = np.logaddexp(exact.sum(), inexact.sum())
    assert found.score(model) == pytest.approx(
        likelihood - 2.0 * c.parameter - 2.0 * c.law - c.curve)


def test_no_part_outweighs_the_others() -> None:
    base = scored((2e3, 20.0, 20.0, 20.0, 20.0))
    one_part, the_others = scored((20, 20, 20, 20, 20), 'a'), scored((2e3, 2, 2, 2, 2), 'b')
    assert evidence(base, CHEAP._replace(ideal=0.0)).ranked([one_part, the_others]) == [
        the_others, one_part]


def test_a_model_that_leaves_noise_beats_one_that_leaves_a_misfit() -> None:
    base, exact, rough = scored(200.0), scored(1.0, 'a', 'b', 'c'), scored(20.0, 'd')
    found = evidence(base)
    assert found.ranked([base, rough, exact]) == [exact, rough, base]
    assert found.is_exact(exact) and not found.is_exact(rough)


@pytest.mark.parametrize('taken, worth', [(0.8, True), (0.02, False)])
def test_what_is_less_than_any_law_idealises_does_not_pay_a_law(taken: float, worth: bool) -> None:
    base, first = scored(1000.0), scored(1.0 + 999.0 * (taken + 0.008), 'a')
    more = scored(1.0 + 999.0 * 0.008, 'a', 'b')
    found = evidence(base)
    assert (found.score(more) > found.score(first)) is worth


@pytest.mark.parametrize('gain, worth', [(0.9, False), (1.1, True)])
def test_a_law_is_taken_if_its_likelihood_pays_its_prior(gain: float, worth: bool) -> None:
    price = CONSTANTS.parameter + CONSTANTS.law
    left = 1000.0 * exp(-2.0 * gain * price / (PARTS * CONSTANTS.independent))
    base, law = scored(1000.0, motion=50.0), scored(left, 'a', motion=50.0)
    found = evidence(base, CONSTANTS._replace(ideal=0.0))
    assert (found.score(law) > found.score(base)) is worth


@pytest.mark.parametrize('rounding', [-1e-12, 0.0, 1e-12])
def test_exact_ties_follow_the_rank(rounding: float) -> None:
    first, second = scored(5.0 * (1.0 + rounding), 'a'), scored(5.0, 'b')
    found = evidence(scored(90.0))
    assert found.ranked([second, first]) == found.ranked([first, second]) == [first, second]


def test_weights_are_probabilities_that_rounding_does_not_change() -> None:
    models = [scored(90.0), scored(5.0, 'a'), scored((5, 6, 4, 5, 6), 'b'), scored(30.0, 'c')]
    rounded = [replace(one, left_out=one.left_out * (1.0 + 1e-12)) for one in models]
    found = evidence(models[0])
    weights = found.weights(models, 0)
    assert weights.sum() == pytest.approx(1.0)
    assert weights[1] > weights[3] > 0.0
    np.testing.assert_allclose(found.weights(rounded, 0), weights, atol=1e-9)


def test_models_that_predict_alike_have_the_same_weight() -> None:
    models = [scored(5.0, 'a'), scored(5.0, 'b')]
    np.testing.assert_allclose(evidence(scored(90.0)).weights(models, 0), 0.5)


def test_few_parts_prove_little() -> None:
    one_part = [scored((90, 90, 90, 90, 1e4)), scored((90, 90, 90, 90, 1.0), 'a')]
    every_part = [scored(300.0), scored(30.0, 'a')]
    weights = [evidence(pair[0], CHEAP).weights(pair, 0)[1] for pair in (one_part, every_part)]
    assert weights[0] < weights[1]


def test_probability_of_a_family_is_the_weight_of_its_models() -> None:
    models = [scored(1.0), scored(1.0, 'a'), scored(1.0, 'a', 'b')]
    assert of_families(models, np.array([0.2, 0.5, 0.3])) == pytest.approx(
        {'family of a': 0.8, 'family of b': 0.3})


def test_noise_is_as_large_as_the_best_models_leave_to_about_a_fifth() -> None:
    base = scored(300.0, motion=5.0)
    found = evidence(base).informed_by([base, scored(1.3, 'a', motion=1.9)])
    assert found.noise is not None
    np.testing.assert_allclose(found.noise, np.tile((1.3, 1.44), (PARTS, 1)))


def test_laws_are_to_explain_what_zeros_leave() -> None:
    base, zero = scored(1e6), scored(100.0, 'bias', laws=0)
    found = evidence(base).informed_by([base, zero])
    assert found.misfit == pytest.approx([99.0, 0.0])


def test_share_is_that_of_the_squared_misfit_beyond_noise() -> None:
    share = explained(evidence(scored(101.0)), scored(26.0, 'a'))
    assert share.share == pytest.approx(0.75)
    assert share.interval == pytest.approx((0.75, 0.75))
    np.testing.assert_allclose(share.parts, 0.75)


def test_share_of_parts_that_disagree_has_an_interval_around_zero() -> None:
    share = explained(evidence(scored(101.0)), scored((11, 191, 21, 186, 101), 'a'))
    assert share.interval[0] < 0.0 < share.interval[1]


def test_in_a_share_a_part_counts_no_more_than_two_usual_ones() -> None:
    base = scored((101, 101, 101, 101, 4001))
    share = explained(evidence(base), scored((6, 6, 6, 6, 4001), 'a'))
    assert share.share == pytest.approx(4 * 95.0 / 600.0)


def named(*models: Scored) -> list[tuple[str, list[str]]]:
    """List the names, with those alike, of models of which the first is the base."""
    found = evidence(models[0])
    compared = Compared(found, found.ranked(models))

    def without(model: Scored, dropped: Sequence[str]) -> Scored | None:
        return None

    return [(one.effect, one.alike) for one in name(compared, 0, without).names]


def test_the_likely_family_is_named_with_laws_alike() -> None:
    base, law = scored(300.0), scored(3.0, 'a')
    alike = replace(scored(3.0, 'b'), families=('family of a',))
    assert named(base, law) == [('a', [])]
    assert named(base, law, alike, scored(30.0, 'c')) == [('a', ['b'])]


def test_nothing_is_named_where_no_family_is_likely() -> None:
    assert named(scored(1.0), scored(0.9, 'a')) == []
    assert named(scored(300.0), *(scored(3.0, one) for one in 'abc')) == []


def test_a_trifle_beside_a_law_is_not_named() -> None:
    base, law, trifle = scored(3000.0), scored(1.9, 'a'), scored(2000.0, 'b')
    assert [one for one, _ in named(base, law, trifle, scored(1.0, 'a', 'b'))] == ['a']


class Worlds:
    """Models whose effects take away shares of what the base leaves."""

    def __init__(self, **factors: float) -> None:
        self._factors = factors
        self.fitted, self.extended = list[frozenset[str]](), list[frozenset[str]]()

    def evidence(self) -> Evidence:
        """Compare with the base."""
        return evidence(scored(1e4))

    def _of(self, *effects: str) -> Scored:
        left = 1e4 * float(np.prod([self._factors[one] for one in effects]))
        return scored(max(left, 1.0), *effects)

    def extensions(self, one: Scored) -> list[Scored]:
        """Add each effect that is not there."""
        self.extended.append(one.key)
        return [self._of(*one.effects, more) for more in self._factors if more not in one.effects]

    def siblings(self, one: Scored) -> list[Scored]:
        """Return none: each effect has a family of its own."""
        return []

    def to_the_end(self, one: Scored) -> Scored | None:
        """Count the fits."""
        self.fitted.append(one.key)
        return one


def test_search_adds_laws_as_long_as_they_pay() -> None:
    space = Worlds(a=0.25, b=0.3, c=0.95, d=0.99)
    found = search(space, lambda text: None)
    assert found.models[0].key == {'a', 'b'}
    assert found.score == found.evidence.score(found.models[0])
    assert frozenset('d') not in space.fitted


def test_search_ends_where_nothing_is_left_to_gain() -> None:
    space = Worlds(a=1e-4, b=0.5)
    assert search(space, lambda text: None).models[0].effects == ('a',)
    assert frozenset() in space.extended and frozenset('a') not in space.extended


def test_known_models_are_fitted_again_and_the_best_is_extended() -> None:
    space = Worlds(a=0.01, b=0.02)
    known = refit(space, [scored(100.0, 'a')])
    assert [one.effects for one in known.models] == [('a',), ()] and not space.extended
    assert search(space, lambda text: None, known).models[0].key == {'a', 'b'}
    assert space.extended[0] == {'a'} and frozenset() not in space.extended
