"""The effects by name. To add one: a file here and a line in the dictionary."""

from __future__ import annotations

from dataclasses import make_dataclass

from ..parameters import ParameterGroup, group
from .coulomb_friction import CoulombFriction
from .environment_inertia import EnvironmentInertia
from .physics import Effect

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
