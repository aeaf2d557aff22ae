# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Laws with memory, each against an independent form: friction, hysteresis, relaxation."""

from __future__ import annotations

from math import exp, gamma, pi
from typing import Callable

from law_runs import Array, DT, law_of, ramps, response
import numpy as np
import pytest


def check_lugre() -> None:
    law = law_of('lugre_friction', F_c=3.0, F_s=5.0, v_s=0.02, sigma_0=1e5, sigma_1=20.0)
    for v in (0.002, 0.02, 0.2):  # the steady state is Stribeck's curve
        slide: Array = v * DT * np.arange(2000, dtype=float)
        force = response(law, slide)[-1]
        assert force == pytest.approx(3.0 + 2.0 * exp(-(v / 0.02) ** 2), rel=1e-6)


def check_elastoplastic() -> None:
    law = law_of('elastoplastic_friction', F_c=4.0, z_ss=1e-3, z_ba=6e-4, sigma_1=0.0)
    there_and_back = np.concatenate([ramps(0.0, 5e-4, 0.0, speed=0.01)] * 20)
    assert abs(response(law, there_and_back)[-1]) < 0.02  # no creep below break-away
    assert response(law, ramps(0.0, 0.02))[-1] == pytest.approx(4.0, rel=1e-3)


def check_asymmetric() -> None:
    law = law_of('asymmetric_coulomb', F_in=3.0, F_out=5.0, stiffness=1e5)
    force = response(law, ramps(0.0, 0.01, 0.0))
    assert (force.max(), force.min()) == pytest.approx((3.0, -5.0))


def check_magnetorheological() -> None:
    law = law_of('magnetorheological_damper', force=6.0, v_0=0.01, lead=0.4, x_0=0.001)
    assert law.respond(0.0, 0.0, 1.0, DT, None)[0] == pytest.approx(6.0)
    t = np.arange(2000) * DT
    d, v = 0.01 * np.sin(2.0 * pi * t), 0.02 * pi * np.cos(2.0 * pi * t)
    force = np.array([law.respond(0.0, *row, DT, None)[0] for row in zip(d, v)])
    loss = float(np.sum(force * v) * DT)
    assert 0.0 < loss < 2.0 * 4.0 * 0.01 * 6.0  # at most that of dry friction, two cycles


def check_maxwell_slip() -> None:
    law = law_of('maxwell_slip', stiffness=6000.0, width=0.002)
    loop = response(law, ramps(0.0, 0.01, -0.01, 0.01))
    slipping = 1000.0 * sum(0.002 * 0.6**k for k in range(6))
    assert loop.max() == pytest.approx(slipping) == -loop.min()
    # Masing: the branch after a reversal is the first loading scaled by two.
    first = response(law, ramps(0.0, 0.001))[-1]
    after = response(law, ramps(0.0, 0.01, 0.01 - 0.002))[-1]
    assert slipping - after == pytest.approx(2.0 * first, rel=1e-3)


def check_preisach() -> None:
    law = law_of('preisach_hysteresis', amplitude=5.0, width=0.004)
    major, back = ramps(0.0, 0.02, 0.005), ramps(0.005, 0.012, 0.005)
    without = response(law, np.concatenate((major, ramps(0.005, -0.01))))
    with_loop = response(law, np.concatenate((major, back, ramps(0.005, -0.01))))
    assert with_loop[len(major) + len(back) - 1] == pytest.approx(without[len(major)])
    assert with_loop[-1] == pytest.approx(without[-1])  # the inner loop is forgotten
    path = ramps(0.0, 0.02, -0.02, 0.02)
    up_and_down = response(law, path)
    assert up_and_down[-1] == pytest.approx(up_and_down.max())  # the major loop closes
    assert up_and_down.max() == pytest.approx(-up_and_down.min(), rel=1e-6)
    loop = slice(len(path) // 5, None)
    work = up_and_down[loop][1:] @ np.diff(path[loop])
    assert work > 0.0  # the loop takes energy, it gives none


def check_walton_braun() -> None:
    law = law_of('walton_braun', K=1000.0, K_u=4000.0)
    force = response(law, ramps(0.0, 0.01, 0.008, 0.01, 0.011, 0.005))
    assert force.max() == pytest.approx(11.0)
    assert force[-1] == 0.0  # unloaded at d_0 = d_max (1 - K / K_u)
    assert np.interp(0.0095, [0.00825, 0.011], [0.0, 11.0]) == pytest.approx(
        law.respond(0.0, 0.0095, -0.1, DT, 0.011)[0])


def held(depth: float, seconds: float, dt: float = DT) -> Array:
    """Return a step of the depth, held."""
    return np.concatenate(([0.0], np.full(round(seconds / dt), depth)))


def check_prony() -> None:
    law = law_of('prony_relaxation', stiffness=900.0, tau=0.05, spread=4.0)
    d = ramps(0.0, 0.01, speed=5.0)
    force = response(law, np.concatenate((d, np.full(3000, 0.01))))[-2500:]
    t = DT * np.arange(len(force))
    arms = np.column_stack([np.exp(-t / tau) for tau in (0.05, 0.2, 0.8)])
    assert np.max(np.abs(force - arms @ np.linalg.lstsq(arms, force, rcond=None)[0])) < 1e-9


def check_fractional() -> None:
    law = law_of('fractional_relaxation', C=500.0, alpha=0.4)
    force = response(law, held(0.01, 4.0))
    for t in (1.0, 2.0, 4.0):  # D^alpha of a step is t^-alpha / Gamma(1 - alpha)
        assert force[round(t / DT)] == pytest.approx(
            5.0 * t**-0.4 / gamma(0.6), rel=2e-3)


def check_quasi_linear() -> None:
    law = law_of('quasi_linear_viscoelasticity', stiffness=800.0, b=80.0, tau=1e5)
    force = response(law, ramps(0.0, 0.02))[-1]  # without time to relax: the elastic force
    assert force == pytest.approx(800.0 * (exp(80.0 * 0.02) - 1.0) / 80.0, rel=2e-3)
    quick = law_of('quasi_linear_viscoelasticity', stiffness=800.0, b=80.0, tau=0.02)
    assert response(quick, held(0.01, 2.0))[-1] < 1e-6


CHECKS: dict[str, Callable[[], None]] = {
    'lugre_friction': check_lugre,
    'elastoplastic_friction': check_elastoplastic,
    'asymmetric_coulomb': check_asymmetric,
    'maxwell_slip': check_maxwell_slip,
    'magnetorheological_damper': check_magnetorheological,
    'preisach_hysteresis': check_preisach,
    'walton_braun': check_walton_braun,
    'prony_relaxation': check_prony,
    'fractional_relaxation': check_fractional,
    'quasi_linear_viscoelasticity': check_quasi_linear,
}
