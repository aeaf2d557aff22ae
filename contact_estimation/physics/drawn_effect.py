# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""How blind trials draw the parameters of an effect, from where a search for them starts."""

from __future__ import annotations

from abc import ABC
from dataclasses import fields
from typing import ClassVar, Mapping

from numpy.random import Generator

from .random_strength import random_sign, Strength, Values
from .scales import Scales
from ..parameters.specification import ParameterGroup

_LARGEST_OVER_START = 30.0  # of an effect that does not say what is plausible


class DrawnEffect(ABC):
    """Starts and draws of the parameters of an effect."""

    # all fields are floats; NaN, the default, switches the effect off
    Parameters: ClassVar[type[ParameterGroup]]
    # values of parameters at which the effect vanishes, where not 0
    neutral: ClassVar[Mapping[str, float]] = {}
    either_sign: ClassVar[bool] = False  # whether the first parameter is drawn with either sign

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """
        Return the points from which a search for the parameters starts.

        Returns starts: values of all parameters; several where the cost has several local minima
        """
        raise NotImplementedError

    @classmethod
    def largest(cls, scales: Scales) -> float:
        """
        Return the largest plausible magnitude of the first parameter.

        scales: orders of magnitude in the world that the effect acts in
        """
        neutral = cls.neutral.get(fields(cls.Parameters)[0].name, 0.0)
        return neutral + _LARGEST_OVER_START * (cls.starts(scales)[0][0] - neutral)

    @classmethod
    def draw(cls, scales: Scales, rng: Generator) -> Strength:
        """
        Draw everything but the magnitude at random.

        By default the first parameter is proportional to the magnitude and the others keep the
        values of the first start.

        scales: orders of magnitude in the world that the effect acts in
        Returns strength: from a magnitude, 0 (absent) to 1 (largest plausible), to parameters by
        name
        """
        names = [field.name for field in fields(cls.Parameters)]
        rest = dict(zip(names[1:], cls.starts(scales)[0][1:]))
        neutral = cls.neutral.get(names[0], 0.0)
        most = (cls.largest(scales) - neutral) * (random_sign(rng) if cls.either_sign else 1.0)
        return lambda s: {names[0]: neutral + s * most, **rest}

    @classmethod
    def equivalent_damping(cls, values: Values, damping: float, depth: float) -> float:
        """
        Return B_e of the spring-damper that a model without the effect would contain.

        damping: B_e of the wall beside the effect [N s/m]
        depth: largest penetration [m]
        Returns damping: B_e [N s/m]
        """
        return damping
