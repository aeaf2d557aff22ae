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

"""A model that the diagnosis fits: base parameters, effects and their values in one vector."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...parameters.specification import specifications
from ...physics import EFFECTS
from ...physics.contact_effect import ContactEffect
from ...physics.contact_law import ContactLaw
from ...physics.effect import Effect
from ...physics.force_sensor_effect import ForceSensorEffect
from ...physics.robot_law import RobotLaw
from ...plant.plant_parameters import PlantParameters

Array = NDArray[np.float64]

_NO_WALL = 1e-3  # N/m or N s/m: as good as no spring, no damper


class Laws(NamedTuple):
    """
    The equations of a model.

    Attributes
    ----------
    contact : ContactLaw
        Wall.
    chain : list of ForceSensorEffect
        What the force sensor does, in order.
    robot : RobotLaw
        Robot.

    """

    contact: ContactLaw
    chain: list[ForceSensorEffect]
    robot: RobotLaw


@dataclass(frozen=True)
class Model:
    """
    Nominal parameters, effects by name, and the values that are fitted.

    Attributes
    ----------
    nominal : PlantParameters
        What is not fitted comes from here.
    effects : tuple of str
        Names.
    values : tuple of float
        K_e, B_e, (M_e), then the effects' parameters in order.
    with_inertia : bool
        Whether M_e is fitted.

    """

    nominal: PlantParameters
    effects: tuple[str, ...]
    values: tuple[float, ...]
    with_inertia: bool

    @classmethod
    def of(cls, nominal: PlantParameters) -> 'Model':
        """Take the nominal model without effects."""
        wall = nominal.environment
        with_inertia = wall.inertia > 0.0
        base = (wall.stiffness, wall.damping) + ((wall.inertia,) if with_inertia else ())
        return cls(nominal, (), base, with_inertia)

    @property
    def base_count(self) -> int:
        """Number of base parameters."""
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
        """Add an effect."""
        return replace(self, effects=(*self.effects, name), values=(*self.values, *values))

    def without(self, name: str) -> 'Model':
        """Leave an effect out."""
        place = self.place(name)
        values = self.values[:place.start] + self.values[place.stop:]
        names = tuple(effect for effect in self.effects if effect != name)
        return replace(self, effects=names, values=values)

    def place(self, name: str) -> slice:
        """Tell where an effect's parameters are in `values`."""
        first = self.base_count
        for effect in self.effects:
            count = len(names_of(effect))
            if effect == name:
                return slice(first, first + count)
            first += count
        raise KeyError(name)

    def with_free(self, coordinates: Array) -> 'Model':
        """Take other values of what is free, as of `coordinates`; the rest stays."""
        every = np.array(self.values)
        every[self.free] = coordinates
        every[self._logarithmic] = np.exp(every[self._logarithmic])
        return self.at(every)

    def _of_free(self, values: Array) -> Array:
        """Take the free ones, in the coordinates of searches."""
        with np.errstate(divide='ignore'):  # the logarithm's range has no lower end
            return np.where(self._logarithmic, np.log(np.abs(values)), values)[self.free]

    @property
    def coordinates(self) -> Array:
        """What searches vary: the free values, some in their logarithm."""
        return self._of_free(np.array(self.values))

    @property
    def ranges(self) -> tuple[Array, Array]:
        """Ranges of the coordinates."""
        low, high = self.bounds
        return self._of_free(low), self._of_free(high)

    @property
    def steps(self) -> Array:
        """How large a change of each coordinate is: that by which its value changes by `sizes`."""
        return np.where(self._logarithmic[self.free], 1.0, self.sizes[self.free])

    @property
    def sizes(self) -> Array:
        """How large a change of each of all values is: its own size, or a little where it is 0."""
        values = np.abs(np.array(self.values))
        sizes = np.where(values > 0.0, values, 1.0)
        sizes[:2] = np.maximum(values[:2], _NO_WALL)
        return sizes

    @cached_property
    def _logarithmic(self) -> NDArray[np.bool_]:
        names = [name in EFFECTS[effect].in_logarithm
                 for effect in self.effects for name in names_of(effect)]
        return np.array([False] * self.base_count + names)

    @property
    def at_end(self) -> NDArray[np.bool_]:
        """Which of all values stand at the end of their range, as does next to no wall."""
        values, (low, high) = np.array(self.values), self.bounds
        little = 1e-6 * np.abs(values)
        little[:2] = _NO_WALL
        return np.asarray((values - low <= little) | (high - values <= little))

    def at(self, values: Any) -> 'Model':
        """Take other values."""
        return replace(self, values=tuple(float(value) for value in values))

    @property
    def bounds(self) -> tuple[Array, Array]:
        """Ranges of all values: those of the parameters, none of the wall's below 0."""
        # A wall that moves under a force has to have some mass.
        low = [0.0, 0.0, 1e-3 * self.nominal.environment.inertia][:self.base_count]
        high = [np.inf] * self.base_count
        for effect in self.effects:
            for _, minimum, maximum in _ranges(effect):
                low.append(minimum)
                high.append(maximum)
        return np.array(low), np.array(high)

    def made_effects(self) -> list[Effect]:
        """Make the effects with their values, in the order of the registry."""
        found = {}
        for name in self.effects:
            cls = EFFECTS[name]
            found[name] = cls(cls.Parameters(*self.values[self.place(name)]))
        return [found[name] for name in EFFECTS if name in found]

    def plausible(self) -> bool:
        """Tell whether every effect's values are physics together."""
        return all(type(effect).plausible(effect.values) for effect in self.made_effects())

    def laws(self) -> Laws:
        """Build the equations."""
        effects, wall, robot = self.made_effects(), self.nominal.environment, self.nominal.robot
        inertia = self.values[2] if self.with_inertia else 0.0
        contact = ContactLaw(self.stiffness, self.damping, wall.location, inertia,
                             wall.unilateral, effects)
        chain = [effect for effect in effects if isinstance(effect, ForceSensorEffect)]
        return Laws(contact, chain, RobotLaw(robot.mass, robot.damping, robot.stiffness, effects))

    def _replaces(self, what: str) -> bool:
        contact = (EFFECTS[name] for name in self.effects)
        return any(issubclass(c, ContactEffect) and getattr(c, what) for c in contact)

    @cached_property
    def free(self) -> NDArray[np.bool_]:
        """Which values are fitted: not K_e or B_e where an effect takes their place."""
        free = np.ones(len(self.values), bool)
        free[0] = not self._replaces('replaces_stiffness')
        free[1] = not self._replaces('replaces_damping')
        return free


@lru_cache(maxsize=None)
def _ranges(effect: str) -> tuple[tuple[str, float, float], ...]:
    """List an effect's parameters with their ranges; searches ask a thousand times."""
    return tuple(
        (spec.name, -np.inf if spec.minimum is None else spec.minimum,
         np.inf if spec.maximum is None else spec.maximum)
        for spec in specifications(EFFECTS[effect].Parameters)
    )


def names_of(effect: str) -> list[str]:
    """
    List an effect's parameters.

    Parameters
    ----------
    effect : str
        Name.

    Returns
    -------
    names : list of str
        In the order of its dataclass.

    """
    return [name for name, _, _ in _ranges(effect)]
