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

"""Test the probabilities of names."""

from contact_estimation.diagnosis.conclude.probability import (
    DOUBTFUL,
    MOST,
    probabilities,
    probability_of,
)
from contact_estimation.diagnosis.fit.share import Share

import numpy as np
import pytest


def share_of(share: float, half_width: float) -> Share:
    """Return a share that is the same on each of two parts."""
    interval = (share - half_width, share + half_width)
    return Share(share, interval, np.full(2, share), 0.0)


def test_a_law_that_leaves_only_noise_is_as_sure_as_any() -> None:
    whole = share_of(0.95, 0.02)
    assert probabilities([whole], [whole], 0.0, True) == [MOST]


def test_a_share_that_may_be_nought_is_doubtful() -> None:
    vague = share_of(0.1, 0.2)
    assert probabilities([vague], [vague], 0.0, True) == [DOUBTFUL]


def test_a_law_down_to_the_noise_is_as_sure_as_its_share_where_that_is_vague() -> None:
    shares = [share_of(0.9, 0.9 - low) for low in (0.125, 0.375, 0.5)]
    given = [probabilities([one], [one], 0.0, True)[0] for one in shares]
    assert given == pytest.approx([probability_of(0.125), probability_of(0.375), MOST])


def test_a_trifle_beside_another_law_is_doubtful_though_it_leaves_only_noise() -> None:
    whole, trifle = share_of(0.95, 0.02), share_of(0.03, 0.001)
    assert probabilities([whole, trifle], [whole, trifle], 0.0, True) == [MOST, DOUBTFUL]


def test_an_early_trifle_that_the_others_need_is_as_sure_as_any() -> None:
    whole, trifle, beside = share_of(0.95, 0.02), share_of(0.03, 0.001), share_of(0.3, 0.05)
    assert probabilities([trifle, whole], [beside, whole], 0.0, True) == [MOST, MOST]


def test_a_law_that_leaves_more_is_less_sure_the_less_it_explains() -> None:
    half, most = share_of(0.5, 0.1), share_of(0.9, 0.1)
    unsure, = probabilities([half], [half], 0.5, False)
    sure, = probabilities([most], [most], 0.1, False)
    assert DOUBTFUL < unsure < sure < MOST
