# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The filter bank against scipy's filter."""

from __future__ import annotations

from contact_estimation.exceptions import ParameterRangeError
from contact_estimation.signals.butterworth import ButterworthBank
from core_steps import filtered
import numpy as np
import pytest
from scipy.signal import butter, lfilter


@pytest.mark.parametrize('cutoff, rate', [(50.0, 500.0), (5.0, 1000.0), (240.0, 500.0)])
def test_bank_equals_lfilter_on_every_channel(cutoff: float, rate: float) -> None:
    rows = np.random.default_rng(2).normal(0.0, [1.0, 1e-3, 1e4], (400, 3))
    bank = ButterworthBank(3, cutoff, rate)
    got = np.array(filtered(bank, rows.tolist()))
    expected = lfilter(*butter(2, cutoff, fs=rate), rows, axis=0)
    assert np.max(np.abs(got - expected) / rows.std(axis=0)) < 1e-10


@pytest.mark.parametrize('cutoff', [250.0, 251.0, 1e4, 5e-324, 1e-6])
def test_cutoff_without_a_computable_filter_is_refused(cutoff: float) -> None:
    with pytest.raises(ParameterRangeError, match='cutoff_frequency must be .* < half of sample'):
        ButterworthBank(1, cutoff, 500.0)
