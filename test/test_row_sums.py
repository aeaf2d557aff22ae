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

"""Sums over the window, the contact and the last rows, against sums over all their rows."""

from __future__ import annotations

from contact_estimation.estimators.row_sums import RowSums
from contact_estimation.signals.relations import COLUMNS, NoiseGain
import numpy as np
import pytest

WINDOW, BLOCK, FADING = 100, 10, 0.97
ROWS = np.random.default_rng(1).standard_normal((350, COLUMNS))


def summed(count: int) -> RowSums:
    """Return the sums after a number of rows, a multiple of the block."""
    sums = RowSums(WINDOW)
    for begin in range(0, count, BLOCK):
        sums.add(ROWS[begin:begin + BLOCK].tolist(), [NoiseGain(0.5, 2.0)] * BLOCK)
        sums.close_block()
    return sums


@pytest.mark.parametrize('count', [50, 80])
def test_a_short_contact_is_the_window(count: int) -> None:
    sums = summed(count)
    assert sums.contact() is sums.window()
    np.testing.assert_allclose(sums.contact().products, ROWS[:count].T @ ROWS[:count])


def test_rows_before_the_window_fade() -> None:
    sums = summed(350)
    inside = 9 * BLOCK  # the next block completes the window
    ages = np.repeat(np.arange((350 - inside) // BLOCK)[::-1], BLOCK)
    weights = np.concatenate([FADING**ages, np.ones(inside)])
    expected = (ROWS * weights[:, None]).T @ ROWS
    contact = sums.contact()
    np.testing.assert_allclose(contact.products, expected)
    assert contact.effective_samples == pytest.approx(0.5 * weights.sum())


def test_a_moved_surface_moves_all_rows_of_the_contact() -> None:
    sums, moved = summed(350), ROWS.copy()
    expected = sums.contact().shifted(0.3).products
    sums.shift(0.3)
    moved[:, 1] -= 0.3 * moved[:, 3]
    np.testing.assert_allclose(sums.contact().products, expected)
    np.testing.assert_allclose(sums.window().products, moved[-90:].T @ moved[-90:])


def test_a_new_wall_discards_the_contact_before_it() -> None:
    sums = summed(350)
    sums.keep_recent()
    np.testing.assert_allclose(sums.contact().products, ROWS[-20:].T @ ROWS[-20:])
