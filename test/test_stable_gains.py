# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Gains that are stable on a wall, computed and watched."""

from dataclasses import replace
from math import isnan, nan, sqrt
from typing import Any, NamedTuple

import contact_estimation as ce
from contact_estimation.parameters import build
from contact_estimation.plant.world import World
from contact_estimation.reference.stable_gains import StabilityParameters, StabilityWatch
import numpy as np
import pytest
from scipy.linalg import expm

START = 1e-3


class Robot(NamedTuple):
    """Gains and timing of a robot, and the damping of its wall."""

    kind: str
    M_t: float
    B_t: float
    K_t: float
    B_e: float
    sample_time: float
    delay: float


CASES = [
    Robot('admittance', 5.0, 300.0, 0.0, 50.0, 0.002, 0.004),
    Robot('admittance', 20.0, 800.0, 500.0, 100.0, 0.004, 0.004),
    Robot('admittance', 2.0, 100.0, 0.0, 10.0, 0.001, 0.0105),
    Robot('admittance', 50.0, 2000.0, 1000.0, 200.0, 0.002, 0.03),
    Robot('admittance', 10.0, 500.0, 0.0, 0.0, 0.008, 0.008),
    Robot('admittance', 1.0, 80.0, 200.0, 20.0, 0.001, 0.002),
    Robot('impedance', 5.0, 300.0, 1000.0, 0.0, 0.002, 0.004),
    Robot('impedance', 2.0, 200.0, 2000.0, 0.0, 0.001, 0.003),
    Robot('impedance', 10.0, 300.0, 8000.0, 5.0, 0.004, 0.002),
    Robot('impedance', 50.0, 3000.0, 5000.0, 20.0, 0.002, 0.01),
    Robot('impedance', 5.0, 500.0, 100.0, 2.0, 0.004, 0.004),
    Robot('impedance', 1.0, 50.0, 3000.0, 1.0, 0.001, 0.0035),
]


def on_wall(robot: Robot, K_e: float, **options: Any) -> ce.StableGains:
    return ce.stable_gains(K_e, **robot._asdict(), **options)


class Truth(NamedTuple):
    """What a simulator says of the loop."""

    position: float
    velocity: float
    force: float


class MujocoWorld:
    """A mass on a slide between a spring-damper, the wall, and a servo or a force, in MuJoCo."""

    def __init__(self, mass: float, servo: float, wall: tuple[float, float], step: float) -> None:
        self._mujoco = pytest.importorskip('mujoco')
        self._model = self._mujoco.MjModel.from_xml_string(
            f'<mujoco><option timestep="{step}" gravity="0 0 0" integrator="implicit"/>'
            '<worldbody><body><joint type="slide" axis="1 0 0"/>'
            f'<geom size="0.01" mass="{mass}"/></body></worldbody></mujoco>')
        self._state, self._mass, self._servo = self._mujoco.MjData(self._model), mass, servo
        self._wall = wall
        self._model.jnt_stiffness[0], self._model.dof_damping[0] = wall
        self._state.qpos[0] = START

    def truth(self, follow: Any) -> Truth:
        x, v = self._state.qpos[0], self._state.qvel[0]
        return Truth(x, v, -self._wall[0] * x - self._wall[1] * v)

    def advance(self, T: float, follow: Any) -> None:
        end = self._state.time + T
        while self._state.time < end - 0.5 * self._model.opt.timestep:
            x_r, v_r, a_r, force = follow(self._state.time)
            x, v, _ = self.truth(follow)
            self._state.qfrc_applied[0] = force + self._servo * (x_r - x) + (
                2.0 * sqrt(self._servo) * (v_r - v) + self._mass * a_r) * (self._servo > 0.0)
            self._mujoco.mj_step(self._model, self._state)


def grows(robot: Robot, K_e: float, mujoco: bool = False, cycles: int = 240) -> bool:
    """Close the sampled loop over the plant's wall; return whether its motion grows."""
    T, bare = robot.sample_time, robot.kind == 'impedance'
    inner = 300.0 * max(K_e, 1e4)  # of a robot of 1 kg that follows its reference closely
    own = ({'mass': robot.M_t, 'damping': 0.0, 'control': 'force'} if bare else
           {'mass': 1.0, 'damping': 2.0 * sqrt(inner), 'stiffness': inner})
    world: Any = MujocoWorld(
        robot.M_t if bare else 1.0, 0.0 if bare else inner, (K_e, robot.B_e),
        T / (100.0 if bare else max(20.0, np.ceil(10.0 * T * sqrt(inner))))) if mujoco else World(
            build(ce.PlantParameters, {
                'environment.stiffness': K_e, 'environment.damping': robot.B_e,
                'environment.unilateral': False, **{f'robot.{name}': own[name] for name in own},
                'integration_rate': 10.0 / T if bare else max(10.0 / T, 3.0 * sqrt(inner)),
            }), START)
    sent: list[tuple[float, float, float, float]] = []
    state, system = np.array([START, 0.0]), np.zeros((3, 3))
    system[0, 1], system[1] = 1.0, np.array([-robot.K_t, -robot.B_t, 1.0]) / robot.M_t
    step = expm(system * T)

    def follow(t: float) -> tuple[float, float, float, float]:
        """Follow the command sent a delay ago, along its parabola."""
        k = int((t - robot.delay) / T + 1e-9)
        if t < robot.delay - 1e-12 or not sent:
            return (0.0 if bare else START), 0.0, 0.0, 0.0
        x, v, a, force = sent[min(k, len(sent) - 1)]
        since = t - robot.delay - min(k, len(sent) - 1) * T
        return x + since * (v + 0.5 * since * a), v + since * a, a, force

    moved = []
    for _ in range(cycles):
        now = world.truth(follow)
        if bare:
            sent.append((0.0, 0.0, 0.0, -robot.K_t * now.position - robot.B_t * now.velocity))
        else:
            a = (now.force - robot.B_t * state[1] - robot.K_t * state[0]) / robot.M_t
            sent.append((state[0], state[1], a, 0.0))
            state = step[:2, :2] @ state + step[:2, 2] * now.force
        world.advance(T, follow)
        moved.append(abs(now.position))
        if moved[-1] > 1e3 * START:
            return True
    return max(moved[-cycles // 4:]) > max(moved[cycles // 4:cycles // 2])


@pytest.mark.slow
@pytest.mark.parametrize('mujoco', [False, True])
def test_loop_becomes_unstable_within_ten_percent_of_the_predicted_wall(mujoco: bool) -> None:
    for robot in CASES:
        K_e = on_wall(robot, 5000.0).stiffest_wall
        found = [grows(robot, share * K_e, mujoco) for share in (0.9, 1.1)]
        assert found == [False, True], robot


@pytest.mark.parametrize('kind', ['admittance', 'impedance'])
def test_without_delay_the_damping_is_that_of_love_and_book(kind: str) -> None:
    found = ce.stable_gains(2000.0, 20.0, M_t=5.0, B_t=60.0, K_t=100.0, sample_time=1e-5,
                            kind=kind)
    assert found.damping_ratio == pytest.approx(80.0 / (2.0 * sqrt(5.0 * 2100.0)), rel=1e-3)


ROBOT = StabilityParameters('admittance', 5.0, 300.0, 0.0, 0.002, 0.01)
WALL = 20_000.0, 500.0, 50.0, 5.0


def test_margin_is_that_of_stable_gains_within_the_band() -> None:
    watch = StabilityWatch()
    expected = ce.stable_gains(20_000.0, 50.0, M_t=5.0, B_t=300.0, K_t=0.0, sample_time=0.002,
                               delay=0.01, K_e_std=500.0, B_e_std=5.0)
    assert watch.take(ROBOT, *WALL) == expected.least_phase_margin < expected.phase_margin
    assert watch.values['least_damping'] == expected.least_damping
    assert f'raise stability.damping (B_t) to {expected.least_damping:.3g}' in watch.text(ROBOT)


def test_wall_is_judged_again_only_where_it_has_changed() -> None:
    watch = StabilityWatch()
    watch.take(ROBOT, *WALL)
    before = watch.gains
    watch.take(ROBOT, 20_100.0, *WALL[1:])
    assert watch.gains is before
    assert watch.take(ROBOT, 40_000.0, *WALL[1:]) < 0.0
    assert 'may be unstable' in watch.text(ROBOT)
    assert watch.take(replace(ROBOT, damping=2000.0), 40_000.0, *WALL[1:]) > 0.0


@pytest.mark.parametrize('robot, K_e', [(replace(ROBOT, kind='off'), 5e3), (ROBOT, nan)])
def test_nothing_is_judged_without_gains_or_wall(robot: StabilityParameters, K_e: float) -> None:
    watch = StabilityWatch()
    assert isnan(watch.take(robot, K_e, *WALL[1:]))
    assert watch.values == {} and watch.text(robot) == ''
