"""Mass of the wall that moves with the contact point."""

from __future__ import annotations

from dataclasses import dataclass
from math import nan

from ..parameters import ParameterGroup, parameter
from .physics import ContactEffect


@dataclass(frozen=True)
class EnvironmentInertiaParameters(ParameterGroup):
    """Parameters of `EnvironmentInertia`."""

    M_e: float = parameter(
        nan, 'Mass of the wall that moves with the tool', 'kg', minimum=0.0, nan_is_off=True
    )


class EnvironmentInertia(ContactEffect):
    """R = M_e a, without an impulse at touch-down."""

    name = 'environment_inertia'
    equation = 'F_e -= M_e a'
    Parameters = EnvironmentInertiaParameters

    def __init__(self, values: EnvironmentInertiaParameters) -> None:
        super().__init__(values)
        self.inertia = values.M_e
