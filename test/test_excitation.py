# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Excitation: sine, multisine and the register against a second implementation."""

from __future__ import annotations

from math import pi, sin

from contact_estimation.exceptions import ParameterRangeError
from contact_estimation.reference.excitation import Multisine, register_sequence
from contact_estimation.reference.experiments import FORCE_EXCITATION
import numpy as np
import pytest


def shift_register() -> list[int]:
    """Run ten bits of an integer, bit k - 1 is register k; feedback from 7 and 10."""
    state, bits = 0b1111111111, []
    for _ in range(2046):
        bits.append(state >> 9 & 1)
        state = (state << 1 | (state >> 6 ^ state >> 9) & 1) & 0b1111111111
    return bits


def test_register_is_that_of_integer_bit_operations() -> None:
    assert list(register_sequence()) == shift_register()[:1023]


def test_sine_is_that_of_the_paper() -> None:
    sine = FORCE_EXCITATION['sine']
    assert sine is not None
    assert all(sine.value(t) == pytest.approx(8.0 * sin(20.0 * t)) for t in (0.0, 0.1, 5.9))


def test_multisine_peak_is_its_amplitude() -> None:
    multisine = FORCE_EXCITATION['multisine']
    assert multisine is not None
    values = [abs(multisine.value(t)) for t in np.arange(0.0, 10.0, 1e-3).tolist()]
    assert max(values) == pytest.approx(8.0, rel=0.01)


def test_multisine_has_equal_lines_at_its_frequencies_alone() -> None:
    multisine = Multisine(8.0, [2.0 * pi * f for f in (0.8, 1.9, 3.2)])
    values = [multisine.value(0.01 * k) for k in range(1000)]  # 10 s hold whole periods
    lines = np.abs(np.fft.rfft(values))
    strong = np.flatnonzero(lines > 1e-6 * lines.max())
    assert strong.tolist() == [8, 19, 32]
    np.testing.assert_allclose(lines[strong], lines[8], rtol=1e-9)


def test_multisine_without_frequencies_is_refused() -> None:
    with pytest.raises(ParameterRangeError, match='at least one frequency'):
        Multisine(1.0, [])
