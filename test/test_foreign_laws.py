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

"""Laws of the literature, each against an independent form."""

from __future__ import annotations

from math import erfc, exp, gamma, log, pi, sqrt
from typing import Any, Callable

from contact_estimation.foreign_laws import ALL_LAWS, FOREIGN_LAWS, UNKNOWN_LAWS
from contact_estimation.foreign_laws.fractional_relaxation import gruenwald_weights
from contact_estimation.foreign_laws.jkr_adhesion import jkr_curve
from contact_estimation.foreign_laws.law import (
    ContactLaw,
    ForeignLaw,
    Magnitudes,
    RobotLaw,
    SensorLaw,
    Signals,
)
from contact_estimation.physics import EFFECTS
import numpy as np
from numpy.typing import NDArray
import pytest

Array = NDArray[np.float64]

WORLD = Magnitudes(depth=0.02, speed=0.1, force=80.0, control=150.0, duration=15.0,
                   stiffness=4000.0, damping=100.0, mass=20.0)
DT = 1e-3


def law_of(name: str, **values: float) -> Any:
    """Make a law."""
    return ALL_LAWS[name](values)


def response(law: Any, d: Array, dt: float = DT) -> Array:
    """Return the force of a contact law along depths that all count as contact."""
    state, v = law.start(dt, len(d)), np.gradient(d, dt)
    forces = []
    for k, (depth, rate) in enumerate(zip(d.tolist(), v.tolist())):
        force, state = law.respond(k * dt, depth, rate, dt, state)
        forces.append(force)
    return np.array(forces)


def ramps(*depths: float, speed: float = 0.02) -> Array:
    """Return straight lines between depths at a speed."""
    parts = [np.linspace(a, b, max(2, round(abs(b - a) / speed / DT)), endpoint=False)
             for a, b in zip(depths[:-1], depths[1:])]
    return np.concatenate([*parts, depths[-1:]])


def signals(force: Array, a: Array | None = None) -> Signals:
    """Return signals with a force and an acceleration."""
    t: Array = DT * np.arange(len(force), dtype=float)
    still = np.zeros(len(force))
    return Signals(t, still, still, still if a is None else a, force)


STEP = np.concatenate((np.zeros(100), np.full(4000, 10.0)))


# -- friction and hysteresis ------------------------------------------------------------------


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
    assert up_and_down[-1] == pytest.approx(up_and_down.min())  # the major loop closes
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


# -- relaxation -------------------------------------------------------------------------------


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


# -- elasticity and clearance -----------------------------------------------------------------


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


# -- damping ----------------------------------------------------------------------------------


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


def check_lankarani() -> None:
    law = law_of('lankarani_nikravesh', gain=100.0, slowest=1e-3)
    _, state = law.respond(0.0, 1e-6, 0.25, DT, law.start(DT, 1))
    assert law.respond(0.0, 0.01, 0.5, DT, state)[0] == pytest.approx(100.0 * 0.01 * 0.5 / 0.25)
    _, state = law.release(0.0, -0.01, -0.1, DT, state)
    assert law.respond(0.0, 0.01, 0.5, DT, state)[0] == pytest.approx(100.0 * 0.01)


def check_power_law() -> None:
    assert power_of('power_law_damper', False, c=20.0, p=0.4, slow=1e-5) == pytest.approx(0.4)


# -- motion of the wall -----------------------------------------------------------------------


def check_surface(name: str, **values: float) -> None:
    law = law_of(name, amplitude=1e-3, **values)
    t = np.arange(20_000) * DT
    shift, rate = np.array([law.surface(instant) for instant in t.tolist()]).T
    assert np.max(np.abs(np.gradient(shift, DT) - rate)[1:-1]) < 0.02 * np.max(np.abs(rate))
    assert np.max(np.abs(shift)) < 3.5e-3


def check_swinging() -> None:
    check_surface('swinging_fixture', frequency=2.0, ratio=0.8, phase=0.4)


def check_base_vibration() -> None:
    check_surface('base_vibration', frequency=8.0, seed=3.0)
    law = law_of('base_vibration', amplitude=1e-3, frequency=8.0, seed=3.0)
    shift = [law.surface(k * DT)[0] for k in range(20_000)]
    assert np.std(shift) == pytest.approx(1e-3, rel=0.2)


# -- force sensor -----------------------------------------------------------------------------


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


def check_bent_gauge() -> None:
    y = law_of('bent_gauge', bend=0.01).sense(signals(np.array([-10.0, 10.0])))
    assert y == pytest.approx([-9.0, 11.0])


def check_resonant_mount() -> None:
    law = law_of('resonant_mount', mass=0.0, frequency=25.0, zeta=0.02)
    y = law.sense(signals(STEP))[100:] - 10.0
    rising = np.flatnonzero((y[:-1] < 0.0) & (y[1:] >= 0.0))
    assert np.mean(np.diff(rising)) * DT == pytest.approx(1.0 / 25.0, rel=0.01)
    decay = log(np.max(y[:60]) / np.max(y[400:460])) / 0.4
    assert decay == pytest.approx(0.02 * 2.0 * pi * 25.0, rel=0.1)


# -- robot ------------------------------------------------------------------------------------


def check_tip(name: str) -> None:
    tip = law_of(name, mass=0.5, stiffness=1e4, damping=3.0).compliance()
    assert tip == (0.5, 1e4, 3.0)


def check_joint_friction() -> None:
    law, state = law_of('joint_friction', F_c=4.0, wave=0.5, pitch=0.02, stiffness=1e6), 0.0
    delivered = []
    for k in range(2000):
        force, state = law.drive(0.0, 1e-4 * k, 0.1, DT, state)
        delivered.append(-force)
    assert np.max(delivered[200:]) == pytest.approx(6.0, rel=1e-3)
    assert np.min(delivered[200:]) == pytest.approx(2.0, rel=1e-3)


def check_stribeck_joint() -> None:
    law = law_of('stribeck_joint', F_c=3.0, F_s=2.0, v_s=0.02, F_v=1.0, v_t=0.1)
    for v in (0.05, -0.1):
        friction = 3.0 + 2.0 * exp(-abs(v) / 0.02) + abs(v / 0.1) ** 0.7
        assert 10.0 - law.drive(10.0, 0.0, v, DT, 0.0)[0] == pytest.approx(
            np.sign(v) * friction, rel=1e-6)


def check_sampled_command() -> None:
    t = np.arange(5000) * DT
    sent = np.column_stack((t, t, t))
    late = t - law_of('sampled_command', period=0.04, delay=0.01).follow(t, sent)[:, 0]
    assert np.mean(late[100:]) == pytest.approx(0.03, abs=1e-3)  # delay and half a period
    assert late[100:].max() == pytest.approx(0.049, abs=1e-3)


def check_torque_loop() -> None:
    law, state = law_of('slow_torque_loop', tau=0.02), 0.0
    for _ in range(20):
        force, state = law.drive(5.0, 0.0, 0.0, DT, state)
    assert force == pytest.approx(5.0 * (1.0 - exp(-1.0)))


def check_torque_limit() -> None:
    law = law_of('soft_torque_limit', limit=50.0)
    delivered = [law.drive(u, 0.0, 0.0, DT, 0.0)[0] for u in (1.0, 50.0, -1e5)]
    assert delivered == pytest.approx([1.0, 50.0 / 2.0**0.25, -50.0], rel=1e-6)


def check_windage() -> None:
    law = law_of('windage', c=100.0)
    assert [law.drive(0.0, 0.0, v, DT, 0.0)[0] for v in (0.1, -0.2)] == pytest.approx([-1.0, 4.0])


# -- walls that no family describes -----------------------------------------------------------


def check_wall_resonance() -> None:
    law = law_of('wall_resonance', mass=0.5, frequency=10.0, damping_ratio=0.05)
    t = np.arange(0.0, 20.0, DT)
    force = response(law, 1e-3 * np.sin(2.0 * pi * 6.0 * t))[-5000:]
    w, r = 2.0 * pi * 6.0, 0.6
    transfer = (1.0 + 0.1j * r) / (1.0 - r**2 + 0.1j * r)  # of a vibration absorber
    assert np.max(force) == pytest.approx(abs(0.5 * w**2 * 1e-3 * transfer), rel=0.01)


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
    'lugre_friction': check_lugre, 'elastoplastic_friction': check_elastoplastic,
    'asymmetric_coulomb': check_asymmetric, 'maxwell_slip': check_maxwell_slip,
    'magnetorheological_damper': check_magnetorheological,
    'preisach_hysteresis': check_preisach, 'walton_braun': check_walton_braun,
    'prony_relaxation': check_prony, 'fractional_relaxation': check_fractional,
    'quasi_linear_viscoelasticity': check_quasi_linear, 'fung_elasticity': check_fung,
    'foam_plateau': check_foam, 'neo_hookean': check_neo_hookean,
    'tsuji_damping': check_tsuji, 'kuwabara_kono': check_kuwabara_kono,
    'lankarani_nikravesh': check_lankarani, 'power_law_damper': check_power_law,
    'jkr_adhesion': check_jkr, 'rough_surface': check_rough_surface,
    'swinging_fixture': check_swinging, 'second_order_filter': check_second_order,
    'settling_bias': check_settling_bias, 'load_cell_creep': check_load_cell,
    'soft_clipping': check_soft_clipping, 'soft_tool': check_soft_tool,
    'flexible_mount': lambda: check_tip('flexible_mount'),
    'flexible_joint': lambda: check_tip('flexible_joint'),
    'joint_friction': check_joint_friction, 'stribeck_joint': check_stribeck_joint,
    'sampled_command': check_sampled_command, 'slow_torque_loop': check_torque_loop,
    'soft_torque_limit': check_torque_limit, 'wall_resonance': check_wall_resonance,
    'soft_spell': check_soft_spell, 'warming_wall': check_warming_wall,
    'force_ripple': check_force_ripple, 'stiffness_ripple': check_stiffness_ripple,
    'base_vibration': check_base_vibration, 'mains_hum': check_mains_hum,
    'cross_talk': check_cross_talk, 'warming_sensor': check_warming_sensor,
    'bent_gauge': check_bent_gauge, 'resonant_mount': check_resonant_mount,
    'windage': check_windage,
}


@pytest.mark.parametrize('name', ALL_LAWS)
def test_a_law_agrees_with_an_independent_form(name: str) -> None:
    CHECKS[name]()


def test_gruenwald_weights_are_binomial_coefficients() -> None:
    weights = gruenwald_weights(0.5, 5)
    assert weights == pytest.approx([1.0, -1.0 / 2.0, -1.0 / 8.0, -1.0 / 16.0, -5.0 / 128.0])


def test_the_spring_pot_of_order_one_half_solves_the_heat_equation() -> None:
    law = law_of('fractional_relaxation', C=1.0, alpha=0.5)
    t = np.arange(1, 3001) * DT
    force = response(law, np.concatenate(([0.0], 1.0 - np.array(
        [exp(s) * erfc(sqrt(s)) for s in t.tolist()]))))
    # d = 1 - exp(t) erfc(sqrt(t)) solves D^(1/2) d = 1 - d.
    assert force[500:] == pytest.approx([exp(s) * erfc(sqrt(s)) for s in t[499:]], rel=2e-3)


@pytest.mark.parametrize('name', ALL_LAWS)
def test_a_law_grows_with_its_strength_from_nothing(name: str) -> None:
    strength = ALL_LAWS[name].draw(WORLD, np.random.default_rng(1))
    weak, strong = strength(0.1), strength(0.8)
    assert set(weak) == set(strong)
    assert any(weak[key] != strong[key] for key in weak)
    assert all(np.isfinite(value) for value in strength(1e-4).values())


@pytest.mark.parametrize('name', ALL_LAWS)
def test_a_law_states_its_port_and_known_families(name: str) -> None:
    cls: type[ForeignLaw] = ALL_LAWS[name]
    bases = {'contact': ContactLaw, 'force_sensor': SensorLaw, 'robot': RobotLaw}
    assert issubclass(cls, bases[cls.port])
    assert set(cls.families) <= {effect.family for effect in EFFECTS.values()}
    assert bool(cls.families) == (name in FOREIGN_LAWS) != (name in UNKNOWN_LAWS)
    assert cls.__doc__ and any(f'{year}' in cls.__doc__ for year in range(1890, 2027))
