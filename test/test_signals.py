# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Signals before estimation: filter bank, outliers, smoothing, samples and relations."""

from math import nan

from contact_estimation.estimators import ESTIMATORS
from contact_estimation.exceptions import ParameterRangeError, SignalShapeError
from contact_estimation.signals.conditioning import OutlierGate
from contact_estimation.signals.contact_sample import ContactRecording, ContactSample
from contact_estimation.signals.filters import ButterworthBank, smoothed_rate
from contact_estimation.signals.relations import Relation, TustinRelation, VelocityRelation
from core_runs import contact_samples, estimates_of, filtered, pipeline_with, row_of
import numpy as np
from numpy.typing import NDArray
import pytest
from scipy.integrate import solve_ivp
from scipy.signal import butter, lfilter, savgol_filter

EACH = pytest.mark.parametrize('estimator', ESTIMATORS)
NOISE, K = 0.3, 5000.0
DEPTHS = 0.01 + 0.002 * np.sin(0.04 * np.arange(500))


def forces(seed: int = 0) -> NDArray[np.float64]:
    """Press on a spring."""
    noise: NDArray[np.float64] = NOISE * np.random.default_rng(seed).standard_normal(500)
    return K * DEPTHS + noise


def replaced(given: NDArray[np.float64], gate: OutlierGate) -> NDArray[np.float64]:
    """Pass forces through a gate."""
    return np.array([gate.replace(d, y, NOISE) for d, y in zip(DEPTHS.tolist(), given.tolist())])


def hit(samples: list[ContactSample], at: list[int], force: float) -> list[ContactSample]:
    """Add a pressing force to single samples."""
    return [s._replace(force=s.force - force) if k in at else s for k, s in enumerate(samples)]


@pytest.mark.parametrize('spike', [500.0, 100.0, -40.0])
def test_spike_becomes_the_force_of_the_line(spike: float) -> None:
    gate, given = OutlierGate(6.0, 5), forces()
    given[200] += spike
    got = replaced(given, gate)
    assert gate.count == 1
    assert got[200] == pytest.approx(K * DEPTHS[200], abs=4.0 * NOISE)
    np.testing.assert_array_equal(np.delete(got, 200), np.delete(given, 200))


@EACH
def test_spikes_in_1_percent_of_the_samples_move_the_stiffness_by_less_than_2_percent(
    estimator: str
) -> None:
    samples = contact_samples(2.0, force_noise=NOISE)
    at = np.flatnonzero(np.random.default_rng(1).uniform(size=len(samples)) < 0.01)
    spoilt = hit(samples, [k for k in at.tolist() if k > 260], 100.0)
    last = estimates_of(spoilt, pipeline_with(estimator=estimator))[-1]
    assert last.stiffness == pytest.approx(4800.0, rel=0.02)


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


T = 2e-3


@pytest.mark.parametrize('count, window_s, window', [(400, 0.04, 21), (6, 0.04, 5), (50, 0.0, 5)])
def test_rate_is_that_of_scipy(count: int, window_s: float, window: int) -> None:
    values = np.random.default_rng(3).normal(size=count)
    expected = savgol_filter(values, window, 2, deriv=1, delta=T)
    np.testing.assert_allclose(smoothed_rate(values, T, window_s), expected, atol=1e-9)


SAMPLES = [ContactSample(10**18 + 2_000_000 * k, 0.1 * k, 0.2 * k, -k) for k in range(5)]


def test_samples_survive_the_arrays() -> None:
    assert list(ContactRecording.of(SAMPLES)) == SAMPLES


@pytest.mark.parametrize('shape', [(4,), (5, 1), ()])
def test_arrays_of_other_shapes_are_refused(shape: tuple[int, ...]) -> None:
    with pytest.raises(SignalShapeError, match='one-dimensional and of one length'):
        ContactRecording(np.arange(5), np.zeros(shape), np.zeros(5), np.zeros(5))


M, B, STIFFNESS, INSTANTS = 3.0, 200.0, 4800.0, 0.002
THETA_2, THETA_3 = np.array([STIFFNESS, B]), np.array([STIFFNESS, B, M])


def press(t: float) -> float:
    """Force of a smooth push on the environment [N]."""
    return float(40.0 + 20.0 * np.sin(11.0 * t) + 10.0 * np.sin(23.0 * t))


def motion_under(mass: float, period: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Solve M a + B v + STIFFNESS d = f(t) from the steady start, sampled over 1 s."""
    t = np.arange(0.0, 1.0, period)
    solution = solve_ivp(
        lambda t, s: [s[1], (press(t) - B * s[1] - STIFFNESS * s[0]) / mass], (0.0, 1.0),
        [40.0 / STIFFNESS, 0.0], 'DOP853', t_eval=t, rtol=1e-11, atol=1e-14)
    return t, solution.y


def tustin_residual(period: float) -> float:
    """Largest departure of the ODE's solution from the bilinear relation [N]."""
    t, (d, _) = motion_under(M, period)
    relation = TustinRelation(period)
    rows = [row_of(relation, period, x, nan, press(u), True)
            for u, x in zip(t.tolist(), d.tolist())]
    made = np.array(rows[2:])
    return float(np.max(np.abs(made[:, 0] - made[:, [1, 2, 4]] @ THETA_3)))


def test_bilinear_relation_holds_on_a_solution_of_the_equation() -> None:
    assert tustin_residual(INSTANTS) < 0.03  # of 70 N


def test_bilinear_row_is_a_quarter_of_the_paper_s_A_B_C_form() -> None:
    d, F = np.random.default_rng(4).normal(0.0, 1.0, (2, 3))
    relation = TustinRelation(INSTANTS)
    for k in range(3):
        row = row_of(relation, INSTANTS, d[k], nan, F[k], True)
    assert row is not None
    A = M * (2 / INSTANTS) ** 2 + B * (2 / INSTANTS) + STIFFNESS
    B_31 = 2 * STIFFNESS - 2 * M * (2 / INSTANTS) ** 2
    C = M * (2 / INSTANTS) ** 2 - B * (2 / INSTANTS) + STIFFNESS
    assert 4.0 * row[0] == pytest.approx(F[2] + 2.0 * F[1] + F[0])
    right = 4.0 * (STIFFNESS * row[1] + B * row[2] + M * row[4])
    assert right == pytest.approx(A * d[2] + B_31 * d[1] + C * d[0], rel=1e-12)


def test_trapezoid_without_velocity_is_exact_for_parabolic_motion() -> None:
    relation, rows = VelocityRelation(INSTANTS), []
    for t in (0.0, INSTANTS, 2.0 * INSTANTS, 3.0 * INSTANTS):
        d, v = 0.01 + 0.3 * t - 40.0 * t**2, 0.3 - 80.0 * t
        rows.append(row_of(relation, INSTANTS, d, nan, STIFFNESS * d + B * v, True))
    made = np.array(rows[1:])
    np.testing.assert_allclose(made[:, 1:3] @ THETA_2, made[:, 0], rtol=1e-12)


@pytest.mark.parametrize('cls, needed', [(VelocityRelation, 2), (TustinRelation, 3)])
def test_rows_do_not_reach_across_a_missing_sample(cls: type[Relation], needed: int) -> None:
    relation = cls(INSTANTS)
    spacing = [INSTANTS] * 5 + [2.0 * INSTANTS] + [INSTANTS] * 5
    rows = [row_of(relation, dt, 0.01 * k, nan, 1.0, True) for k, dt in enumerate(spacing)]
    assert [k for k, row in enumerate(rows) if k >= 5 and row is not None][0] == 5 + needed - 1
