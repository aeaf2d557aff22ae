# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""An independent solution of robot against wall, by scipy with events, for the plant's tests."""

from typing import Any, Callable

from contact_estimation.parameters import build
from contact_estimation.plant.plant_parameters import PlantParameters
from contact_estimation.plant.world import Truth, World
from effect_examples import switched_on
import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

M_t, B_t, K_t = 50.0, 1000.0, 5000.0
K_e, B_e = 4800.0, 200.0
START = -0.004
SMOOTH = {'rtol': 1e-12, 'atol': 1e-14, 'method': 'DOP853'}
State = list[float]
Law = Callable[[float, float, float], float]


def reference_at(t: float) -> tuple[float, float, float, float]:
    """Press, let go and press again: the robot rests at t = 0."""
    w = 9.0
    return (
        START + 0.012 * (1.0 - np.cos(w * t)), 0.012 * w * np.sin(w * t),
        0.012 * w * w * np.cos(w * t), 0.0)


def control(t: float, x: float, v: float, M: float = M_t, B: float = B_t, K: float = K_t) -> float:
    """Compute the control force of eq. (1) on the reference above."""
    x_r, v_r, a_r, _ = reference_at(t)
    return M * a_r - B * (v - v_r) - K * (x - x_r)


def spring_damper(t: float, d: float, v: float) -> float:
    """Compute the pressing force of the nominal wall [N]."""
    return K_e * d + B_e * v


def solve_contact(
    t: NDArray[np.float64], law: Law = spring_damper, M_e: float = 0.0,
    surface: Callable[[float], tuple[float, float]] = lambda t: (0.0, 0.0),
    drive: Law = control, mass: float = M_t,
) -> NDArray[np.float64]:
    """Positions at t; each phase is integrated to the event that ends it."""
    def pressing_force(u: float, s: State) -> float:
        shift, rate = surface(u)
        resistance = law(u, s[0] - shift, s[1] - rate)
        acceleration = (drive(u, s[0], s[1]) - resistance) / (mass + M_e)
        return resistance + M_e * acceleration

    def free(u: float, s: State) -> State:
        return [s[1], drive(u, s[0], s[1]) / mass]

    def pressing(u: float, s: State) -> State:
        return [s[1], (drive(u, s[0], s[1]) - pressing_force(u, s)) / mass]

    def depth(u: float, s: State) -> float:
        return s[0] - surface(u)[0]

    positions = np.full(len(t), np.nan)
    now, state, mode = float(t[0]), [START, 0.0], 'free'
    leave = {  # mode: (equation, the events that end it with their direction and next mode)
        'free': (free, [(depth, 1, 'pressing')]),
        'pressing': (pressing, [(pressing_force, -1, 'slack')]),
        'slack': (free, [(depth, -1, 'free'), (pressing_force, 1, 'pressing')]),
    }
    while now < t[-1]:
        equation, ends = leave[mode]
        events: list[Any] = []
        for function, direction, _ in ends:
            def event(
                u: float, s: State, function: Any = function, since: float = now,
                before: int = -direction,
            ) -> float:
                # What has begun the phase is 0 at its beginning, and must not end it.
                return float(function(u, s)) if u > since + 1e-6 else before
            event.terminal, event.direction = True, direction  # type: ignore[attr-defined]
            events.append(event)
        phase = solve_ivp(equation, (now, t[-1]), state, dense_output=True, events=events,
                          max_step=0.005, **SMOOTH)
        inside = (t >= now) & (t <= phase.t[-1])
        if np.any(inside):
            positions[inside] = phase.sol(t[inside])[0]
        now, state = float(phase.t[-1]), phase.y[:, -1].tolist()
        fired = [end for end, times in zip(ends, phase.t_events) if len(times)]
        mode = fired[0][2] if fired else mode
    return positions


def simulate(
    count: int, parameters: PlantParameters, reference: Any = reference_at, start: float = START
) -> list[Truth]:
    """Run the world under a given reference."""
    world, period, truths = World(parameters, start), 1.0 / parameters.sample_rate, []
    for _ in range(count):
        truths.append(world.truth(reference))
        world.advance(period, reference)
    return truths


def plant_with(**values: Any) -> PlantParameters:
    """Make plant parameters; double underscores stand for the dots of parameter names."""
    return build(PlantParameters, {k.replace('__', '.'): v for k, v in values.items()})


def with_effect(name: str, **values: Any) -> PlantParameters:
    """Make plant parameters with one effect of a plausible size."""
    return plant_with(**switched_on(name), **values)
