# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Laws of force sensors, each against an independent form."""

from __future__ import annotations

from math import exp, log, pi, sqrt
from typing import Callable

from law_runs import DT, law_of, signals, STEP
import numpy as np
import pytest


def check_second_order() -> None:
    law = law_of('second_order_filter', period=0.1, zeta=0.5)
    y, t, w = law.sense(signals(STEP))[100:], DT * np.arange(4000), 2.0 * pi / 0.1
    wd = w * sqrt(0.75)
    step = 1.0 - np.exp(-0.5 * w * t) * (np.cos(wd * t) + 0.5 / sqrt(0.75) * np.sin(wd * t))
    assert np.max(np.abs(y - 10.0 * step)) < 0.5  # half a sample of the jump
    assert y.max() == pytest.approx(10.0 * (1.0 + exp(-0.5 * pi / sqrt(0.75))), rel=1e-3)


def check_settling_bias() -> None:
    extra = law_of('settling_bias', bias=1.0, warm=2.0, tau=0.5).sense(signals(STEP)) - STEP
    assert extra[0] == pytest.approx(3.0)
    assert np.diff(np.log(extra - 1.0)) / DT == pytest.approx(-2.0)


def check_load_cell() -> None:
    law = law_of('load_cell_creep', share=0.1, tau=0.4)
    y, t = law.sense(signals(STEP))[100:], DT * np.arange(4000)
    assert y == pytest.approx(10.0 + 1.0 - np.exp(-t / 0.4), abs=5e-3)


def check_soft_clipping() -> None:
    law = law_of('soft_clipping', limit=20.0)
    force = np.array([1e-3, 10.0, 1e4])
    assert law.sense(signals(force)) == pytest.approx(
        [1e-3, 20.0 * (exp(1.0) - 1.0) / (exp(1.0) + 1.0), 20.0])


def check_soft_tool() -> None:
    t, still = np.arange(6000) * DT, np.zeros(6000)
    slow = np.sin(2.0 * pi * 0.5 * t)
    felt = law_of('soft_tool', mass=2.0, corner=40.0).sense(signals(still, slow))
    assert np.max(np.abs(felt + 2.0 * slow)) < 0.1  # slowly, a rigid mass


def check_mains_hum() -> None:
    law = law_of('mains_hum', amplitude=2.0, mains=50.0, second=0.5, third=0.25, phase=0.3)
    spectrum = 2.0 * np.abs(np.fft.rfft(law.sense(signals(np.zeros(1000))))) / 1000.0
    assert spectrum[[50, 100, 150]] == pytest.approx([2.0, 1.0, 0.5])
    assert np.sum(spectrum > 1e-9) == 3


def check_cross_talk() -> None:
    law = law_of('cross_talk', gain=2.0, seed=5.0)
    extra = law.sense(signals(np.zeros(100_000)))
    assert np.std(extra) == pytest.approx(2.0, rel=0.1)
    assert np.array_equal(extra, law.sense(signals(np.zeros(100_000))))


def check_warming_sensor() -> None:
    y = law_of('warming_sensor', change=0.2, tau=0.5).sense(signals(np.full(20_000, 10.0)))
    expected = (10.0, 10.0 + 2.0 * (1.0 - 1.0 / exp(1.0)), 12.0)
    assert (y[0], y[500], y[-1]) == pytest.approx(expected)


def check_power_characteristic() -> None:
    law = law_of('power_characteristic', exponent=2.0, force=10.0)
    assert law.sense(signals(np.array([-20.0, 0.0, 5.0]))) == pytest.approx([-40.0, 0.0, 2.5])


def check_resonant_mount() -> None:
    law = law_of('resonant_mount', mass=0.0, frequency=25.0, zeta=0.02)
    y = law.sense(signals(STEP))[100:] - 10.0
    rising = np.flatnonzero((y[:-1] < 0.0) & (y[1:] >= 0.0))
    assert np.mean(np.diff(rising)) * DT == pytest.approx(1.0 / 25.0, rel=0.01)
    decay = log(np.max(y[:60]) / np.max(y[400:460])) / 0.4
    assert decay == pytest.approx(0.02 * 2.0 * pi * 25.0, rel=0.1)
    held = signals(np.zeros(2000))._replace(a=np.full(2000, 3.0))
    heavy = law_of('resonant_mount', mass=2.0, frequency=25.0, zeta=0.02)
    assert heavy.sense(held) == pytest.approx(0.0, abs=1e-9), 'a known mass is taken off'


CHECKS: dict[str, Callable[[], None]] = {
    'second_order_filter': check_second_order,
    'settling_bias': check_settling_bias,
    'load_cell_creep': check_load_cell,
    'soft_clipping': check_soft_clipping,
    'power_characteristic': check_power_characteristic,
    'soft_tool': check_soft_tool,
    'mains_hum': check_mains_hum,
    'cross_talk': check_cross_talk,
    'warming_sensor': check_warming_sensor,
    'resonant_mount': check_resonant_mount,
}
