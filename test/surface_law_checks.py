# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Laws of the surface, each against an independent form: elasticity, damping, motion."""

from __future__ import annotations

from math import exp, log, pi
from typing import Callable

from contact_estimation.studies.foreign_laws.jkr_adhesion import jkr_curve
from law_runs import DT, law_of, response
import numpy as np
import pytest


def elastic(name: str, **values: float) -> Callable[[float], float]:
    """Return the force of a law without memory at a depth."""
    law = law_of(name, **values)
    return lambda d: float(law.respond(0.0, d, 0.0, DT, None)[0])


def slope(force: Callable[[float], float], d: float, h: float = 1e-7) -> float:
    """Return the tangent stiffness."""
    return (force(d + h) - force(d - h)) / (2.0 * h)


def check_fung() -> None:
    force = elastic('fung_elasticity', K=1000.0, b=50.0)
    assert slope(force, 0.0) == pytest.approx(1000.0, rel=1e-4)
    for d in (0.005, 0.02):  # dF/dd = K + b F, Fung's differential equation
        assert slope(force, d) == pytest.approx(1000.0 + 50.0 * force(d), rel=1e-6)


def check_foam() -> None:
    force = elastic('foam_plateau', K=1000.0, share=1.0, crush=0.004, densified=0.01, n=6.0,
                    depth=0.02)
    slopes = [slope(force, d) for d in (1e-6, 0.008, 0.02)]
    assert slopes[0] == pytest.approx(1000.0, rel=1e-3)
    assert slopes[1] < 0.2 * slopes[0] < 0.2 * slopes[2]
    assert force(0.008) == pytest.approx(4.0, rel=0.05)  # the plateau is K times `crush`


def check_neo_hookean() -> None:
    K, L = 1000.0, 0.05
    force = elastic('neo_hookean', K=K, height=L)

    def energy(d: float) -> float:
        stretch = 1.0 - d / L
        return K * L**2 / 6.0 * (stretch**2 + 2.0 / stretch - 3.0)

    for d in (-0.01, 0.005, 0.02):  # the force is the derivative of mu / 2 (I_1 - 3)
        assert force(d) == pytest.approx((energy(d + 1e-6) - energy(d - 1e-6)) / 2e-6, rel=1e-6)


def check_rough_surface() -> None:
    force = elastic('rough_surface', K=1000.0, gap=0.005, roughness=0.001)
    assert force(0.0) == pytest.approx(0.0, abs=1e-12)
    assert slope(force, 0.03) == pytest.approx(1000.0, rel=1e-6)
    assert slope(force, 0.2) == pytest.approx(1000.0, rel=1e-6)  # far beyond the asperities
    growth = log(slope(force, 0.001) / slope(force, 0.0)) / 0.001
    assert growth == pytest.approx(1.0 / 0.001, rel=0.02)  # exponential onset


def check_jkr() -> None:
    radius = np.linspace(6.0 ** (-2.0 / 3.0), 3.0, 200_001)
    depth, force = jkr_curve(radius)
    assert force.min() == pytest.approx(-1.0)  # pull-off under a given force
    assert (depth[0], force[0]) == pytest.approx((-1.0, -5.0 / 9.0))  # under a given depth
    assert np.interp(0.0, force[radius > 0.7], radius[radius > 0.7]) == pytest.approx(1.0)
    law = law_of('jkr_adhesion', pull=9.0, reach=0.001)
    apart = law.start(DT, 1)
    assert law.release(0.0, -5e-4, 0.0, DT, apart)[0] == 0.0
    _, holding = law.respond(0.0, 1e-3, 0.0, DT, apart)
    assert law.release(0.0, -0.999e-3, 0.0, DT, holding)[0] == pytest.approx(5.0, rel=0.1)
    assert law.release(0.0, -1.001e-3, 0.0, DT, holding) == (0.0, False)


def power_of(name: str, of_depth: bool, **values: float) -> float:
    """Return the exponent of depth or rate in a damping force."""
    law = law_of(name, **values)
    near = law.respond(0.0, 0.004, 0.1, DT, None)[0]
    far = law.respond(0.0, *((0.008, 0.1) if of_depth else (0.004, 0.2)), DT, None)[0]
    return log(far / near) / log(2.0)


def check_tsuji() -> None:
    assert power_of('tsuji_damping', True, c=90.0) == pytest.approx(0.25)
    assert power_of('tsuji_damping', False, c=90.0) == pytest.approx(1.0)


def check_kuwabara_kono() -> None:
    assert power_of('kuwabara_kono', True, c=90.0) == pytest.approx(0.5)
    assert power_of('kuwabara_kono', False, c=90.0) == pytest.approx(1.0)


def check_jankowski() -> None:
    assert power_of('jankowski_pounding', True, c=50.0) == pytest.approx(0.5)
    law = law_of('jankowski_pounding', c=50.0)
    assert law.respond(0.0, 0.01, 0.5, DT, None)[0] == pytest.approx(50.0 * 0.1 * 0.5)
    assert law.respond(0.0, 0.01, -0.5, DT, None)[0] == 0.0


def check_power_law() -> None:
    assert power_of('power_law_damper', False, c=20.0, p=0.4, slow=1e-5) == pytest.approx(0.4)


def check_surface(name: str, **values: float) -> None:
    law = law_of(name, amplitude=1e-3, **values)
    t = np.arange(20_000) * DT
    shift, rate = np.array([law.surface(instant) for instant in t.tolist()]).T
    assert np.max(np.abs(np.gradient(shift, DT) - rate)[1:-1]) < 0.02 * np.max(np.abs(rate))
    assert np.max(np.abs(shift)) < 3.5e-3


def check_breathing() -> None:
    check_surface('breathing_surface', frequency=2.0, power=4.0, phase=0.4)
    law = law_of('breathing_surface', amplitude=1e-3, frequency=2.0, power=4.0, phase=0.0)
    shift = [law.surface(t)[0] for t in np.linspace(0.0, 0.5, 1001).tolist()]
    assert np.mean(shift) == pytest.approx(0.375e-3, rel=1e-2)  # of cos^4
    assert shift[0] == pytest.approx(shift[-1]) == pytest.approx(1e-3)


def check_base_vibration() -> None:
    check_surface('base_vibration', frequency=8.0, seed=3.0)
    law = law_of('base_vibration', amplitude=1e-3, frequency=8.0, seed=3.0)
    shift = [law.surface(k * DT)[0] for k in range(20_000)]
    assert np.std(shift) == pytest.approx(1e-3, rel=0.2)


def check_ringing_panel() -> None:
    law = law_of('ringing_panel', mass=0.5, share=0.4, frequency=10.0, ratio=2.0,
                 damping_ratio=0.05)
    t = np.arange(0.0, 20.0, DT)
    force = response(law, 1e-3 * np.sin(2.0 * pi * 6.0 * t))[-5000:]
    w, r = 2.0 * pi * 6.0, np.array([0.6, 0.3])
    transfer = (1.0 + 0.1j * r) / (1.0 - r**2 + 0.1j * r)  # of a vibration absorber
    expected = abs(np.array([0.3, 0.2]) @ transfer * w**2 * 1e-3)
    assert np.max(force) == pytest.approx(expected, rel=0.01)


def check_soft_spell() -> None:
    law = law_of('soft_spell', softer=500.0, first=1.0, last=2.0)
    assert [law.respond(t, 0.01, 0.0, DT, None)[0] for t in (0.5, 1.5, 2.5)] == [0.0, -5.0, 0.0]


def check_warming_wall() -> None:
    law, state = law_of('warming_wall', softening=100.0, tau=0.5), 0.0
    for _ in range(10_000):
        force, state = law.respond(0.0, 0.01, 0.1, DT, state)
    assert force == pytest.approx(-100.0 * 0.1 * 0.5 * 0.01)  # steady warmth is v tau
    for _ in range(500):
        _, state = law.release(0.0, -0.01, 0.1, DT, state)
    assert state == pytest.approx(0.05 / exp(1.0), rel=2e-3)


def check_force_ripple() -> None:
    force = elastic('force_ripple', amplitude=2.0, wavelength=0.004)
    assert [force(0.001 * k) for k in range(4)] == pytest.approx([0.0, 2.0, 0.0, -2.0])


def check_stiffness_ripple() -> None:
    force = elastic('stiffness_ripple', stiffness=500.0, wavelength=0.004)
    assert force(0.009) == pytest.approx(4.5)
    assert force(0.008) == pytest.approx(0.0, abs=1e-9)


CHECKS: dict[str, Callable[[], None]] = {
    'fung_elasticity': check_fung,
    'foam_plateau': check_foam,
    'neo_hookean': check_neo_hookean,
    'tsuji_damping': check_tsuji,
    'kuwabara_kono': check_kuwabara_kono,
    'jankowski_pounding': check_jankowski,
    'power_law_damper': check_power_law,
    'jkr_adhesion': check_jkr,
    'rough_surface': check_rough_surface,
    'breathing_surface': check_breathing,
    'ringing_panel': check_ringing_panel,
    'soft_spell': check_soft_spell,
    'warming_wall': check_warming_wall,
    'force_ripple': check_force_ripple,
    'stiffness_ripple': check_stiffness_ripple,
    'base_vibration': check_base_vibration,
}
