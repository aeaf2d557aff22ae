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

"""The effects by name. To add one: a file here and a line in the dictionary."""

from __future__ import annotations

from dataclasses import make_dataclass

from .coulomb_friction import CoulombFriction
from .environment_inertia import EnvironmentInertia
from .physics import Effect
from ..parameters import group, ParameterGroup

EFFECTS: dict[str, type[Effect]] = {
    'coulomb_friction': CoulombFriction,
    'environment_inertia': EnvironmentInertia,
}

PhysicsParameters: type[ParameterGroup] = make_dataclass(
    'PhysicsParameters',
    [(name, effect.Parameters, group(effect.Parameters)) for name, effect in EFFECTS.items()],
    bases=(ParameterGroup,),
    frozen=True,
)
PhysicsParameters.__doc__ = 'Extra physics by name; all off by default.'


def effects_that_are_on(physics: ParameterGroup) -> list[Effect]:
    """
    Make the effects whose parameters are given.

    Parameters
    ----------
    physics : PhysicsParameters
        Values; NaN means off.

    Returns
    -------
    effects : list of Effect
        In the order of EFFECTS.

    Raises
    ------
    ParameterRangeError
        If only some of an effect's parameters are given.

    """
    made = (cls.when_on(getattr(physics, name)) for name, cls in EFFECTS.items())
    return [effect for effect in made if effect is not None]
