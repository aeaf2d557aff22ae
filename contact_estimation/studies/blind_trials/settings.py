# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Where laws are concealed: own effects in the plant's ideal worlds, those of others on rigs."""

from abc import ABC, abstractmethod
from dataclasses import replace
import math
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.random import Generator

from .concealment import Search
from .draws import digits, draw_ideal, STAGES
from .foreign_law import ContactLaw, ForeignLaw, Magnitudes
from .foreign_laws import ALL_LAWS
from .rig import simulate_rig
from .world import Run, scales_of, World
from ...parameters import build, flatten
from ...physics import EFFECTS
from ...physics.contact_effect import ContactEffect
from ...physics.effect import Need
from ...physics.prior import Strength, Values
from ...plant.plant_parameters import PlantParameters, WallParameters
from ...plant.world import World as Plant

EFFECTS_OF_A_WALL = [name for name, cls in EFFECTS.items() if Need.ATTACHMENT not in cls.needs]
"""Effects that the worlds of the plant, in all of which a robot touches a wall, can show."""


class Law(NamedTuple):
    """What is known of a law before its parameters are drawn."""

    port: str = ''
    families: tuple[str, ...] = ()  # right ones; empty where none is
    in_motion: bool = False  # whether the motion of the robot tells it
    # replaces_spring, replaces_damper: whether it stands in place of K_e d, and of B_e v
    replaces_spring: bool = False
    replaces_damper: bool = False


class Setting(ABC):
    """How worlds are drawn and simulated, and how well laws are concealed in them."""

    by_name: ClassVar[bool]  # whether the name of a law is the right answer, not its family
    degrees: ClassVar[tuple[float, float]]  # of concealment, log-uniform
    worlds: ClassVar[int]  # tried at most
    # worlds in which some strength exceeds the degree, after which any is accepted
    exceeding_worlds: ClassVar[float] = math.inf
    search: ClassVar[Search]
    mass_error: ClassVar[float] = 0.0  # of the nominal model

    @abstractmethod
    def law(self, name: str) -> Law:
        """Return what is known of a law; '' is none."""

    @abstractmethod
    def draw(self, law: str, rng: Generator) -> World:
        """Draw a world in which a law may show."""

    @abstractmethod
    def strength(self, law: str, world: World, without: Run, rng: Generator) -> Strength:
        """Draw everything of a law but its magnitude."""

    @abstractmethod
    def simulate(
        self, world: World, law: str, values: Values, rng: Generator | None = None
    ) -> Run:
        """Simulate a world with a law; without a generator as roughly as a search may."""

    @abstractmethod
    def most_force(self, world: World) -> float:
        """Return the force that only an impact exceeds [N]."""

    @abstractmethod
    def is_accepted(self, degree: float, requested: float) -> bool:
        """Return whether a degree is near enough to the requested one."""

    def modelled(self, law: str, values: Values, world: World) -> WallParameters:
        """Return the spring-damper by which a modeller unaware of the law replaces the wall."""
        return world.wall


class IdealWorlds(Setting):
    """
    Effects of the library in worlds without nuisances, which the plant simulates.

    It alone has them all, with their order at the sensor and exact unilateral contact.
    """

    by_name = True
    degrees, worlds, exceeding_worlds = (1.3, 4.0), 25, 2
    search = Search(simulations=9, converged=0.02, first=0.03)

    def law(self, name: str) -> Law:
        effect = EFFECTS.get(name)
        return Law() if effect is None else Law(
            effect.port, (effect.family,), Need.ROBOT in effect.needs,
            'spring' in effect.changes, 'damper' in effect.changes)

    def draw(self, law: str, rng: Generator) -> World:
        return draw_ideal(rng)

    def strength(self, law: str, world: World, without: Run, rng: Generator) -> Strength:
        return EFFECTS[law].draw(scales_of(world, without), rng)

    def simulate(
        self, world: World, law: str, values: Values, rng: Generator | None = None
    ) -> Run:
        assert world.robot is not None, 'a robot presses in all ideal worlds'
        rate, integration_rate = (world.sensors.rate, 2e3) if rng is None else (5e3, 1e4)
        parameters = build(PlantParameters, {
            **flatten(world.wall, 'environment.'), **flatten(world.robot, 'robot.'),
            **{f'physics.{law}.{name}': value for name, value in values.items()},
            'sample_rate': rate, 'integration_rate': integration_rate,
        })
        experiment = world.experiment

        def reference(t: float) -> tuple[float, float, float, float]:
            desired = experiment.desired(t)
            return desired.position, desired.velocity, desired.acceleration, 0.0

        plant, rows = Plant(parameters, experiment.start), []
        for k in range(round(experiment.duration * rate) + 1):
            _, x, v, _, force, sensed = plant.truth(reference)
            rows.append((k / rate, x, v, force, sensed, *reference(k / rate)[:3]))
            plant.advance((k + 1) / rate - plant.t, reference)
        return Run(*np.array(rows).T)

    def most_force(self, world: World) -> float:
        return 320.0

    def is_accepted(self, degree: float, requested: float) -> bool:
        return abs(degree / requested - 1.0) < 0.1

    def modelled(self, law: str, values: Values, world: World) -> WallParameters:
        made = EFFECTS[law](**values) if law else None
        if isinstance(made, ContactEffect) and 'damper' in made.changes:
            return replace(world.wall, damping=digits(
                made.damper(0.5 * world.depth, 1.0, 1.0, math)))  # at half the depth
        return world.wall


class Rigs(Setting):
    """Laws of the literature in worlds with nuisances, in a simulator that shares no code."""

    by_name = False
    degrees, worlds = (2.0, 10.0), 12
    search = Search(simulations=5, converged=0.25, first=0.2)
    mass_error = 0.2

    def law(self, name: str) -> Law:
        cls = ALL_LAWS.get(name, ForeignLaw)
        kept = cls if issubclass(cls, ContactLaw) else ContactLaw
        return Law(cls.port, cls.families, cls.port == 'robot', not kept.keeps_spring,
                   not kept.keeps_damper)

    def draw(self, law: str, rng: Generator) -> World:
        stages = ALL_LAWS[law].stages if law else tuple(STAGES)
        return STAGES[str(rng.choice(list(stages)))](rng)

    def strength(self, law: str, world: World, without: Run, rng: Generator) -> Strength:
        scales = scales_of(world, without, percentile=99.5)
        drawn = ALL_LAWS[law].draw(
            Magnitudes(*(getattr(scales, name) for name in Magnitudes._fields)), rng)
        return lambda s: {name: digits(value) for name, value in drawn(s).items()}

    def simulate(
        self, world: World, law: str, values: Values, rng: Generator | None = None
    ) -> Run:
        made = ALL_LAWS[law](values) if law else ForeignLaw({})
        rate = world.sensors.rate
        steps = round((1e3 if rng is None else 2e3) / rate)
        if world.stage == 'slow':
            steps = max(4, round(20.0 / rate))
        return simulate_rig(world, made, rate * max(1, steps), rng or np.random.default_rng(0))

    def most_force(self, world: World) -> float:
        return 4.0 * world.wall.stiffness * world.depth

    def is_accepted(self, degree: float, requested: float) -> bool:
        return 0.7 * self.degrees[0] < degree < 1.3 * self.degrees[1]


IDEAL, RIGS = IdealWorlds(), Rigs()
