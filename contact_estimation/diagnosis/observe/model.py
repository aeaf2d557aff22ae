# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""A model that the diagnosis fits: base parameters, effects and their values in one vector."""

from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
import re
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .observed import Observed
from .observer import link_against_wall
from ...parameters import of_valid, own_specifications
from ...physics import EFFECTS, effects_that_are_on
from ...physics.contact_law import ContactLaw
from ...physics.effect import Effect
from ...physics.force_sensor_effect import ForceSensorEffect
from ...physics.numeric import Array
from ...physics.robot_law import RobotLaw
from ...plant.plant_parameters import PlantParameters

_NO_WALL = 1e-6  # K_e and B_e: practically no spring, no damper, in scales of the recordings
_LEAST_MAGNITUDE = 1e-150  # whose logarithm stands for that of a minimum of 0
_LARGEST_LOGARITHM = 345.0  # e^345 = 1e150: beyond, products of such a value overflow


class Unit(NamedTuple):
    """Scales of recordings, in which a value of 0 has a size; those of SI by default."""

    length: float = 1.0  # [m]
    force: float = 1.0  # [N]
    time: float = 1.0  # [s]

    def of(self, unit: str) -> float:
        """Return the size of a parameter of a unit such as 'N s/m^2'; other symbols count 1."""
        above, _, below = unit.partition('/')
        size = {'m': self.length, 'N': self.force, 's': self.time,
                'kg': self.force * self.time**2 / self.length}
        product = 1.0
        for sign, symbols in ((1, above), (-1, below)):
            for symbol, power in re.findall(r'(\w+)(?:\^(\d+))?', symbols):
                product *= size.get(symbol, 1.0) ** (sign * int(power or 1))
        return product


class Laws(NamedTuple):
    """The equations of a model."""

    contact: ContactLaw  # wall
    chain: list[ForceSensorEffect]  # force sensor, in order of action
    robot: RobotLaw  # robot

    def at_wall(self, observed: Observed) -> tuple[Array, Array, Array]:
        """Return the motion of what touches the wall."""
        o, joint = observed, self.robot.joint
        if joint is None:
            return o.x, o.v, o.a
        return link_against_wall(joint, self.contact, o.t, o.x, o.v, o.a, o.force)

    def touching(self, observed: Observed) -> NDArray[np.bool_]:
        """Return where the surface is reached, shape (N,); parameters as `at_wall`."""
        x, v, _ = self.at_wall(observed)
        return self.contact.contact(observed.t, x, v)


@dataclass(frozen=True)
class Model:
    """Nominal parameters, effects by name, and the values that are fitted."""

    nominal: PlantParameters  # the source of all values that are not fitted
    effects: tuple[str, ...]  # names
    values: tuple[float, ...]  # K_e, B_e, (M_e), then the effects' parameters in order
    with_inertia: bool  # whether M_e is fitted
    # effects that must not be added: wrong use would look like them
    excluded: frozenset[str] = frozenset()
    # effects of the nominal model, the first of `effects`: recalibrated as K_e is, not named
    given: tuple[str, ...] = ()
    unit: Unit = Unit()  # in which values of 0 have a size

    @classmethod
    def of(cls, nominal: PlantParameters, excluded: frozenset[str] = frozenset()) -> 'Model':
        """Return the nominal model, with the effects that it has."""
        wall = nominal.environment
        with_inertia = wall.inertia > 0.0
        base = (wall.stiffness, wall.damping) + ((wall.inertia,) if with_inertia else ())
        effects = effects_that_are_on(nominal.physics)
        values = [value for effect in effects for value in effect.values().values()]
        given = tuple(effect.name for effect in effects)
        return cls(nominal, given, (*base, *values), with_inertia, excluded, given)

    @property
    def base_count(self) -> int:
        """Return the number of base parameters."""
        return 3 if self.with_inertia else 2

    @property
    def stiffness(self) -> float:
        """K_e [N/m]."""
        return self.values[0]

    @property
    def damping(self) -> float:
        """B_e [N s/m]."""
        return self.values[1]

    def with_effect(self, name: str, values: tuple[float, ...]) -> 'Model':
        """Return the model with one more effect; values beyond their range are brought back."""
        within = (min(max(value, least), most)
                  for value, (least, most) in zip(values, _ranges(name)))
        return replace(self, effects=(*self.effects, name), values=(*self.values, *within))

    def without(self, *names: str) -> 'Model':
        """Return the model without some of its effects."""
        dropped = {k for name in names for k in range(*self.place(name).indices(len(self.values)))}
        values = tuple(value for k, value in enumerate(self.values) if k not in dropped)
        effects = tuple(effect for effect in self.effects if effect not in names)
        return replace(self, effects=effects, values=values)

    def in_order(self, effects: tuple[str, ...]) -> 'Model':
        """Return the model with its effects in another order."""
        values = [value for name in effects for value in self.values[self.place(name)]]
        return replace(self, effects=effects, values=(*self.base_values, *values))

    def place(self, name: str) -> slice:
        """Return the place of an effect's parameters in `values`."""
        return _places(self.effects, self.base_count)[name]

    def effect(self, name: str) -> Effect:
        """Return an effect with its values."""
        made = of_valid(EFFECTS[name], self.values[self.place(name)])
        return made.with_sign(self.nominal.sign_velocity)

    def with_free(self, coordinates: Array) -> 'Model':
        """Return the model at other `coordinates`; values that are not free stay."""
        every = np.array(self.values)
        every[self.free] = coordinates
        logarithms = np.minimum(every[self.logarithmic], _LARGEST_LOGARITHM)
        every[self.logarithmic] = np.exp(logarithms)
        return self.at(every)

    def _of_free(self, values: Array) -> Array:
        """Convert values to coordinates of the free ones."""
        logarithms = np.log(np.maximum(np.abs(values), _LEAST_MAGNITUDE))
        every = np.where(self.logarithmic, logarithms, values)
        return np.asarray(every[self.free])

    @property
    def coordinates(self) -> Array:
        """Return the unknowns of a search: the free values, some as logarithms."""
        return self._of_free(np.array(self.values))

    @property
    def ranges(self) -> tuple[Array, Array]:
        """Ranges of the coordinates."""
        low, high = self.bounds
        return self._of_free(low), self._of_free(high)

    @property
    def steps(self) -> Array:
        """Typical change of each coordinate: that which changes its value by `sizes`."""
        return np.where(self.logarithmic[self.free], 1.0, self.sizes[self.free])

    @property
    def sizes(self) -> Array:
        """Typical change of each of all values: its magnitude, or that of its unit if it is 0."""
        values = np.abs(np.array(self.values))
        sizes = np.where(values > 0.0, values, self._units)
        sizes[:2] = np.maximum(values[:2], self._no_wall)
        return sizes

    @cached_property
    def _units(self) -> Array:
        """Return the unit of each of all values in scales of the recordings."""
        own = [spec.unit for effect in self.effects
               for spec in own_specifications(EFFECTS[effect])]
        return np.array([self.unit.of(one)
                         for one in (*('N/m', 'N s/m', 'kg')[:self.base_count], *own)])

    @property
    def _no_wall(self) -> Array:
        """Largest K_e and B_e that practically are none."""
        return np.asarray(_NO_WALL * self._units[:2])

    @cached_property
    def logarithmic(self) -> NDArray[np.bool_]:
        """Which of all values are searched on a logarithmic scale."""
        own = [spec.logarithmic for effect in self.effects
               for spec in own_specifications(EFFECTS[effect])]
        return np.array([False] * self.base_count + own)

    @property
    def at_end(self) -> NDArray[np.bool_]:
        """Which of all values are at a bound of their range, or practically zero."""
        values, (low, high) = np.array(self.values), self.bounds
        little = 1e-6 * np.abs(values)
        little[:2] = self._no_wall
        return np.asarray((values - low <= little) | (high - values <= little))

    def at(self, values: Any) -> 'Model':
        """Return the model with other values."""
        return replace(self, values=tuple(map(float, values)))

    @property
    def bounds(self) -> tuple[Array, Array]:
        """Ranges of all values: those of the parameters, the wall's from 0."""
        wall = self.nominal.environment
        # Gravity or a cable repels what a drive moves as often as it attracts it.
        drives = not wall.unilateral and wall.stiffness <= 0.0
        # A wall driven by a force needs some mass.
        low = [-np.inf if drives else 0.0, 0.0, 1e-3 * wall.inertia][:self.base_count]
        high = [np.inf] * self.base_count
        for effect in self.effects:
            for minimum, maximum in _ranges(effect):
                low.append(minimum)
                high.append(maximum)
        return np.array(low), np.array(high)

    def made_effects(self) -> list[Effect]:
        """Construct the effects with their values, in the order of the registry."""
        return [self.effect(name) for name in EFFECTS if name in self.effects]

    def plausible(self) -> bool:
        """Return whether the values of each effect are physically possible together."""
        return all(self.effect(name).is_possible(self.stiffness, self.damping)
                   for name in self.effects)

    def laws(self) -> Laws:
        """Return the equations."""
        return self._laws

    @cached_property
    def _laws(self) -> Laws:
        """Build the equations, which every residual asks for."""
        effects, wall, robot = self.made_effects(), self.nominal.environment, self.nominal.robot
        inertia = self.values[2] if self.with_inertia else 0.0
        contact = ContactLaw(self.stiffness, self.damping, wall.location, inertia,
                             wall.unilateral, effects)
        chain = [effect for effect in effects if isinstance(effect, ForceSensorEffect)]
        return Laws(contact, chain, RobotLaw(robot.mass, robot.damping, robot.stiffness, effects))

    @property
    def base_values(self) -> tuple[float, ...]:
        """Return K_e, B_e and, if it is fitted, M_e."""
        return self.values[:self.base_count]

    def values_at(self, *ports: str) -> tuple[object, ...]:
        """Return all on which the laws at some ports depend, but for the base values."""
        values = [(name, self.values[self.place(name)])
                  for name in self.effects if EFFECTS[name].port in ports]
        return self.nominal, *values

    @cached_property
    def free(self) -> NDArray[np.bool_]:
        """Which values are fitted: not K_e or B_e if an effect replaces them."""
        free = np.ones(len(self.values), bool)
        changed = set[str]().union(*(EFFECTS[name].changes for name in self.effects))
        free[:2] = 'spring' not in changed, 'damper' not in changed
        return free


@lru_cache(maxsize=None)
def _places(effects: tuple[str, ...], first: int) -> dict[str, slice]:
    """Return where the parameters of effects are in `Model.values`."""
    places = {}
    for effect in effects:
        places[effect] = slice(first, first := first + len(names_of(effect)))
    return places


@lru_cache(maxsize=None)
def _ranges(effect: str) -> tuple[tuple[float, float], ...]:
    """List the ranges of an effect's parameters; cached, since every search step asks."""
    return tuple((-np.inf if spec.minimum is None else spec.minimum,
                  np.inf if spec.maximum is None else spec.maximum)
                 for spec in own_specifications(EFFECTS[effect]))


def names_of(effect: str) -> list[str]:
    """List an effect's parameters."""
    return [spec.name for spec in own_specifications(EFFECTS[effect])]
