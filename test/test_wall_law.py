# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""When the laws of a wall are told, and how."""

from __future__ import annotations

from contact_estimation.estimation.wall_law import laws_in_words, WallLawNews
from contact_estimation.estimators.multiple_model import LAWS
import pytest


def laws(**chosen: float) -> tuple[float, ...]:
    return tuple(chosen.get(name, 0.0) for name in LAWS)


def test_the_most_probable_law_comes_first_and_what_rounds_to_zero_is_left_out() -> None:
    assert laws_in_words(laws(kelvin_voigt=0.238, mass=0.004, friction=0.758)) == (
        'friction 0.76 kelvin_voigt 0.24')


@pytest.mark.parametrize('then, told', [
    (laws(kelvin_voigt=0.55, friction=0.45), False),
    (laws(kelvin_voigt=0.45, friction=0.55), True),  # another leads
    (laws(kelvin_voigt=0.71, friction=0.29), True),  # by more than 0.1
])
def test_laws_are_told_on_change(then: tuple[float, ...], told: bool) -> None:
    news = WallLawNews()
    assert news.take(laws(kelvin_voigt=0.6, friction=0.4)) == 'kelvin_voigt 0.60 friction 0.40'
    assert bool(news.take(then)) == told
    assert news.take(tuple(then)) == ''
