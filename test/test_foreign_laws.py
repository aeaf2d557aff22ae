# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Laws of the literature: those with memory against independent forms, and what studies need."""

from math import gamma
from typing import Any, Callable

from contact_estimation.physics import EFFECTS
from contact_estimation.studies.blind_trials.foreign_law import (
    ContactLaw, ForeignLaw, Magnitudes, RobotLaw, SensorLaw, Signals)
from contact_estimation.studies.blind_trials.foreign_laws import ALL_LAWS
import numpy as np
from numpy.typing import NDArray
import pytest
from scipy.integrate import solve_ivp
from scipy.signal import lsim

Array = NDArray[np.float64]

WORLD = Magnitudes(depth=0.02, speed=0.1, force=80.0, control=150.0, duration=15.0,
                   stiffness=4000.0, damping=100.0, mass=20.0)
DT = 2e-4
T: Array = DT * np.arange(10_001, dtype=float)
_RATES, _SIZES = np.array([3.0, 11.0]), np.array([8e-3, 3e-3])


def motion(t: Array | float) -> tuple[Any, Any, Any]:
    """Return a penetration [m] from rest, and its derivatives: two tones, several reversals."""
    angle = np.multiply.outer(t, _RATES)
    return (np.cos(angle) @ -_SIZES + _SIZES.sum(), np.sin(angle) @ (_SIZES * _RATES),
            np.cos(angle) @ (_SIZES * _RATES**2))


D, V, A = motion(T)


def response(law: Any) -> Array:
    """Return what a law makes of the motion: R, the measured force of D, or the drive of D."""
    if isinstance(law, SensorLaw):
        return law.sense(Signals(T, D, V, A, D))
    step = law.respond if isinstance(law, ContactLaw) else law.drive
    state, forces = law.start(DT, len(T)) if isinstance(law, ContactLaw) else 0.0, []
    for row in zip(T.tolist(), D.tolist(), V.tolist()):
        force, state = step(*(row if isinstance(law, ContactLaw) else (row[1], *row[1:])), DT,
                            state)
        forces.append(force)
    return np.array(forces)


def integrated(rate: Callable[[float, Any, float, float], Any], start: Any) -> Array:
    """Integrate z' = rate(t, z, d, v) along the motion, shape (states, N)."""
    found = solve_ivp(lambda t, z: rate(t, z, *motion(t)[:2]), (0.0, T[-1]), start, t_eval=T,
                      rtol=1e-7, atol=1e-10, max_step=1e-3)
    return np.asarray(found.y)


def stops(widths: list[tuple[float, float]], stiffness: float) -> Array:
    """Return the sum of springs in series with sliders, branch by branch between reversals."""
    turns = [0, *(np.flatnonzero(np.diff(np.sign(np.diff(D)))) + 1).tolist(), len(D) - 1]
    total = np.zeros(len(D))
    for low, high in widths:
        last = 0.0
        for a, b in zip(turns, turns[1:]):
            branch = np.clip(last + stiffness * (D[a + 1:b + 1] - D[a]), low, high)
            total[a + 1:b + 1] += branch
            last = branch[-1]
    return total


def lugre(F_c: float, F_s: float, v_s: float, sigma_0: float, sigma_1: float) -> Array:
    def rate(t: float, z: Any, d: float, v: float) -> Any:
        return v - sigma_0 * abs(v) * z / (F_c + (F_s - F_c) * np.exp(-(v / v_s)**2))

    (z,) = integrated(rate, [0.0])
    return np.asarray(sigma_0 * z + sigma_1 * np.array([
        rate(t, x, 0.0, v) for t, x, v in zip(T, z, V)]))


def elastoplastic(F_c: float, z_ss: float, z_ba: float, sigma_1: float) -> Array:
    def rate(t: float, z: Any, d: float, v: float) -> Any:
        share = np.clip((abs(z) - z_ba) / (z_ss - z_ba), 0.0, 1.0) * (z * v > 0.0)
        return v * (1.0 - 0.5 * (1.0 - np.cos(np.pi * share)) * abs(z) / z_ss)

    (z,) = integrated(rate, [0.0])
    return np.asarray(F_c / z_ss * z + sigma_1 * np.array([
        rate(t, x, 0.0, v) for t, x, v in zip(T, z, V)]))


def preisach(amplitude: float, width: float) -> Array:
    """Return a spring less relays of +-1/2 on a grid, dense by E'' of the Everett function."""
    grid = np.linspace(-0.024, 0.024, 801)
    up, down = (side.ravel() for side in np.meshgrid(grid, grid))
    up, down = up[up >= down], down[up >= down]
    weight = amplitude / width**2 * np.exp(-(up - down) / width) * (grid[1] - grid[0])**2
    weight[up == down] *= 0.5  # half of each cell is below the diagonal
    state, force = np.where(up + down > 0.0, -0.5, 0.5), []
    for d in D[::20]:
        state[d >= up], state[d <= down] = 0.5, -0.5
        force.append(amplitude / width * d - weight @ state)
    return np.interp(T, T[::20], force)


def walton_braun(K: float, K_u: float) -> Array:
    most = np.maximum.accumulate(D)
    return np.minimum(K * D, np.maximum(0.0, K_u * (D - most * (1.0 - K / K_u))))


def prony(stiffness: float, tau: float, spread: float) -> Array:
    taus = tau * spread ** np.arange(3)
    return integrated(lambda t, s, d, v: stiffness / 3.0 * v - s / taus, 3 * [0.0]).sum(axis=0)


def quasi_linear(stiffness: float, b: float, tau: float) -> Array:
    taus = tau * np.array([1.0, 5.0])
    return integrated(lambda t, s, d, v: 0.5 * stiffness * np.exp(b * abs(d)) * v - s / taus,
                      2 * [0.0]).sum(axis=0)


def fractional(C: float, alpha: float) -> Array:
    """Return Caputo's convolution, the acceleration constant in a step."""
    lag = (DT * np.arange(len(T) + 1)) ** (2.0 - alpha) / gamma(3.0 - alpha)
    return np.asarray(C * np.convolve(A, np.diff(lag))[:len(T)])


def ringing(mass: float, share: float, frequency: float, ratio: float, damping_ratio: float
            ) -> Array:
    def mode(part: float, omega: float) -> Any:
        loss = 2.0 * damping_ratio * omega
        return part * mass * lsim(([loss, omega**2, 0.0], [1.0, loss, omega**2]), V, T)[1]

    omega = 2.0 * np.pi * frequency
    return np.asarray(mode(1.0 - share, omega) + mode(share, ratio * omega))


def warming(softening: float, tau: float) -> Array:
    (warmth,) = integrated(lambda t, w, d, v: abs(v) - w / tau, [0.0])
    return np.asarray(-softening * warmth * D)


def low_pass(u: Array, numerator: list[float], denominator: list[float]) -> Array:
    return np.asarray(lsim((numerator, denominator), u, T)[1])


def second_order(period: float, zeta: float) -> Array:
    omega = 2.0 * np.pi / period
    return low_pass(D, [omega**2], [1.0, 2.0 * zeta * omega, omega**2])


def mount(mass: float, frequency: float, zeta: float) -> Array:
    omega = 2.0 * np.pi * frequency
    load = D - mass * A
    ringing = low_pass(load - load[0], [omega**2], [1.0, 2.0 * zeta * omega, omega**2])
    return np.asarray(load[0] + ringing + mass * A)


def tool(mass: float, corner: float) -> Array:
    omega = 2.0 * np.pi * corner
    return D - mass * low_pass(A, [omega**2], [1.0, 1.4 * omega, omega**2])


FORMS: dict[str, tuple[Callable[..., Array], dict[str, float]]] = {
    'lugre_friction': (lugre, {
        'F_c': 3.0, 'F_s': 4.0, 'v_s': 0.02, 'sigma_0': 3e3, 'sigma_1': 2.0}),
    'elastoplastic_friction': (elastoplastic, {
        'F_c': 4.0, 'z_ss': 2e-3, 'z_ba': 1e-3, 'sigma_1': 2.0}),
    'asymmetric_coulomb': (lambda F_in, F_out, stiffness: stops([(-F_out, F_in)], stiffness), {
        'F_in': 3.0, 'F_out': 5.0, 'stiffness': 2e3}),
    'maxwell_slip': (
        lambda stiffness, width: stops(
            [(-limit, limit) for limit in stiffness / 6.0 * width * 0.6**np.arange(6)],
            stiffness / 6.0),
        {'stiffness': 6e3, 'width': 4e-3}),
    'preisach_hysteresis': (preisach, {'amplitude': 5.0, 'width': 4e-3}),
    'walton_braun': (walton_braun, {'K': 1e3, 'K_u': 3e3}),
    'prony_relaxation': (prony, {'stiffness': 900.0, 'tau': 0.05, 'spread': 4.0}),
    'quasi_linear_viscoelasticity': (quasi_linear, {'stiffness': 800.0, 'b': 80.0, 'tau': 0.1}),
    'fractional_relaxation': (fractional, {'C': 500.0, 'alpha': 0.4}),
    'ringing_panel': (ringing, {
        'mass': 2.0, 'share': 0.4, 'frequency': 9.0, 'ratio': 1.7, 'damping_ratio': 0.1}),
    'warming_wall': (warming, {'softening': 2e3, 'tau': 0.5}),
    'slow_torque_loop': (lambda tau, zeta: low_pass(
        D, [1.0], [tau**2, 2.0 * zeta * tau, 1.0]), {'tau': 0.02, 'zeta': 0.7}),
    'second_order_filter': (second_order, {'period': 0.1, 'zeta': 0.7}),
    'load_cell_creep': (lambda share, tau: D + share * low_pass(D, [1.0], [tau, 1.0]), {
        'share': 0.3, 'tau': 0.4}),
    'resonant_mount': (mount, {'mass': 2e-3, 'frequency': 30.0, 'zeta': 0.05}),
    'soft_tool': (tool, {'mass': 2e-3, 'corner': 20.0}),
}
"""Independent forms of the laws with memory: solved by scipy, by relays, or in closed form."""


@pytest.mark.parametrize('name', FORMS)
def test_a_law_with_memory_equals_an_independent_form(name: str) -> None:
    form, values = FORMS[name]
    expected = form(**values)
    error = response(ALL_LAWS[name](values)) - expected
    assert np.max(np.abs(error)) < 0.01 * np.ptp(expected)


def test_every_contact_law_with_a_state_has_an_independent_form() -> None:
    with_state = {name for name, cls in ALL_LAWS.items() if issubclass(cls, ContactLaw)
                  and cls.respond is not ContactLaw.respond}
    assert with_state - set(FORMS) == {'jkr_adhesion'}  # its state says only whether it holds


def test_adhesion_pulls_most_by_its_parameter_and_holds_until_it_snaps() -> None:
    law: Any = ALL_LAWS['jkr_adhesion']({'pull': 4.0, 'reach': 2e-3})
    state: Any = law.start(DT, 0)
    assert law.release(0.0, -1e-3, 0.0, DT, state)[0] == 0.0  # it has not touched yet
    _, state = law.respond(0.0, 1e-3, 0.0, DT, state)
    pulls = [law.release(0.0, d, 0.0, DT, state)[0] for d in np.linspace(0.0, -2e-3, 400)]
    assert max(pulls) == pytest.approx(4.0, rel=1e-3)
    assert pulls[-1] == pytest.approx(4.0 * 5.0 / 9.0, rel=0.02)
    assert law.release(0.0, -2.1e-3, 0.0, DT, state) == (0.0, False)


def test_a_law_grows_with_its_strength_from_nothing() -> None:
    for name in ALL_LAWS:
        strength = ALL_LAWS[name].draw(WORLD, np.random.default_rng(1))
        weak, strong = strength(0.1), strength(0.8)
        assert set(weak) == set(strong), name
        assert any(weak[key] != strong[key] for key in weak), name
        assert all(np.isfinite(value) for value in strength(1e-4).values()), name


def test_a_law_states_its_port_and_known_families() -> None:
    for name in ALL_LAWS:
        cls: type[ForeignLaw] = ALL_LAWS[name]
        bases = {'contact': ContactLaw, 'force_sensor': SensorLaw, 'robot': RobotLaw}
        assert issubclass(cls, bases[cls.port]), name
        assert set(cls.families) <= {effect.family for effect in EFFECTS.values()}, name
        assert cls.__doc__ and any(f'{year}' in cls.__doc__ for year in range(1890, 2027)), name
