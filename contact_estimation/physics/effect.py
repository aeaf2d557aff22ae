# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Base class of all effects: the interface that every effect implements."""

from copy import copy
from dataclasses import dataclass
from enum import Enum
from math import isnan
import re
from typing import ClassVar, Protocol, TypeVar

from numpy.random import Generator

from .numeric import SIGN_VELOCITY
from .prior import between, Prior, random_sign, Scales, Strength
from ..exceptions import ParameterRangeError
from ..parameters import own_specifications, ParameterGroup

Own = TypeVar('Own', bound='Effect')

_OVER_START = 30.0  # times as large as at a start, where no largest is known


class Need(Enum):
    """What a rig, or its motion, needs for an effect to be identifiable."""

    ROBOT = 'the reference trajectory of a robot'
    TOUCH = 'a contact that begins and ends'
    ATTACHMENT = 'an attached specimen'
    PRESSING = 'a specimen that is pressed only'
    SPRING = 'a spring'
    NO_DRIVE = 'a wall that no force drives'
    NO_MASS = 'a nominal model without it'
    RETURN = 'a motion that returns'


class Seen(Protocol):
    """A recording, as a model with the effect describes it."""

    force: float  # largest measured [N]
    depth: float  # largest [m]
    stroke: float  # from the least to the largest x [m]
    stiffness: float  # K_e [N/m]
    duration: float  # [s]
    sample_period: float  # [s]

    @property
    def touch(self) -> float:
        """Return the duration of the longest contact [s]."""

    def clips(self, limit: float) -> bool:
        """Return whether the measured force is level where a sensor would clip it [N]."""


@dataclass(frozen=True)
class Effect(ParameterGroup):
    """
    Base class of all effects; an effect is the dataclass of its parameters.

    A parameter is declared by `optional_parameter`; the law is linear in the first. NaN in all of
    them, the default, switches the effect off. A class declares family, equation and, where they
    are not the usual ones, needs and resonates; the other attributes follow.

    Attributes
    ----------
    name : str
        Key in EFFECTS and in `physics` of a model file: that of the class in small letters.
    port : str
        Where the effect acts: 'contact', 'force_sensor' or 'robot'.
    family : str
        Kind of physics, such as 'friction'; effects of one family are easily confused.
    equation : str
        The law, as reports print it.
    description : str
        First sentence of the docstring, which explains the effect to a reader of a report.
    needs : frozenset of Need
        Without any of which the effect is another one, or nothing at all.
    resonates : bool
        Whether it is a mass on a spring of its own: one step of a search tells little of its
        frequency.
    starts_anew : bool
        Whether a search starts from the residual that the present model leaves, not the nominal.
    changes : frozenset of str
        Hooks of the port that the class overrides: the others are not called.
    sign_velocity : float
        Width of the smooth sign of a velocity [m/s], sgn(v) = tanh(v / sign_velocity).

    """

    name: ClassVar[str]
    port: ClassVar[str]
    family: ClassVar[str]
    equation: ClassVar[str]
    description: ClassVar[str]
    needs: ClassVar[frozenset[Need]] = frozenset()
    resonates: ClassVar[bool] = False
    starts_anew: ClassVar[bool] = False
    changes: ClassVar[frozenset[str]]
    sign_velocity: ClassVar[float] = SIGN_VELOCITY

    def __init_subclass__(cls) -> None:
        """Name the effect after its class, and look which hooks of its port it changes."""
        cls.name = re.sub(r'(?<!^)(?=[A-Z])', '_', cls.__name__).lower()
        cls.description = (cls.__doc__ or '').strip().partition('\n')[0]
        port = next((base for base in cls.__mro__[1:] if Effect in base.__bases__), cls)
        cls.changes = frozenset(
            hook for hook in vars(port) if getattr(cls, hook) is not getattr(port, hook))

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        """Return which parameters are plausible, from the orders of magnitude of a world."""
        raise NotImplementedError

    @classmethod
    def draw(cls, scales: Scales, rng: Generator) -> Strength:
        """
        Draw everything but the magnitude at random.

        By default what shapes the law lies between two neighbouring starts of the prior, and what
        it is linear in grows from its neutral value until the first parameter is the largest.
        """
        starts, largest, either_sign = cls.prior(scales)
        neutral, linear = cls.neutral(), cls.linear()
        place = rng.uniform(0.25, 0.75) * (len(starts) - 1)
        low, high = starts[int(place)], starts[min(int(place) + 1, len(starts) - 1)]
        values = dict(zip(neutral, (between(*ends, place % 1.0) for ends in zip(low, high))))
        first = next(iter(values))
        most = _OVER_START if isnan(largest) else (largest - neutral[first]) / (
            values[first] - neutral[first])
        most *= random_sign(rng) if either_sign else 1.0
        return lambda s: {name: neutral[name] + s * most * (value - neutral[name])
                          if name in linear else value for name, value in values.items()}

    def is_possible(self, stiffness: float, damping: float) -> bool:
        """Return whether parameters are possible together, beside K_e [N/m] and B_e [N s/m]."""
        return True

    def may_show(self, seen: Seen) -> bool:
        """Return whether a recording may show the effect, or only something that looks like it."""
        return True

    def is_flexible(self, seen: Seen) -> bool:
        """Return whether it fits almost any misfit of its kind in a recording, as no law."""
        return False

    def vanishes(self) -> bool:
        """Return whether all parameters in which the law is linear have their neutral value."""
        neutral = self.neutral()
        return all(getattr(self, name) == neutral[name] for name in self.linear())

    @classmethod
    def linear(cls) -> list[str]:
        """Return the parameters in which the law is linear."""
        return [own.name for k, own in enumerate(own_specifications(cls)) if own.linear or not k]

    @classmethod
    def neutral(cls) -> dict[str, float]:
        """Return the values of parameters at which the effect vanishes."""
        return {own.name: own.neutral for own in own_specifications(cls)}

    def values(self) -> dict[str, float]:
        """Return the parameters by name."""
        return {own.name: getattr(self, own.name) for own in own_specifications(type(self))}

    def is_on(self) -> bool:
        """Return whether the parameters are given: all or none."""
        missing = [name for name, value in self.values().items() if isnan(value)]
        if missing and len(missing) < len(self.values()):
            raise ParameterRangeError(
                f'physics.{self.name} needs all of {", ".join(self.values())}; missing: '
                f'{", ".join(missing)}; set them too, or all to NaN to switch the effect off')
        return not missing

    def with_sign(self: Own, sign_velocity: float) -> Own:
        """Return the effect with another width of sgn(v)."""
        other = copy(self)
        other.__dict__['sign_velocity'] = sign_velocity
        return other
