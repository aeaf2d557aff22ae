# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The evidence for models, against the integrals that it stands for, and what follows from it."""

from __future__ import annotations

from dataclasses import replace
from math import exp, log
from typing import Sequence

from contact_estimation.diagnosis.compare.beam import Compared
from contact_estimation.diagnosis.compare.constants import CONSTANTS, Constants
from contact_estimation.diagnosis.compare.evidence import Evidence, explained, of_families, Scored
from contact_estimation.diagnosis.compare.names import name
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


def test_probability_of_a_family_is_the_weight_of_its_models() -> None:
    models = [scored(1.0), scored(1.0, 'a'), scored(1.0, 'a', 'b')]
    assert of_families(models, np.array([0.2, 0.5, 0.3])) == pytest.approx(
        {'family of a': 0.8, 'family of b': 0.3})


def test_share_is_that_of_the_squared_misfit_beyond_noise() -> None:
    share = explained(evidence(scored(101.0)), scored(26.0, 'a'))
    assert share.share == pytest.approx(0.75)
    assert share.interval == pytest.approx((0.75, 0.75))
    np.testing.assert_allclose(share.parts, 0.75)


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
