# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Base class of all effects: the interface that every effect implements."""

from __future__ import annotations

from dataclasses import fields
from math import isnan
from typing import Any, ClassVar

from .drawn_effect import DrawnEffect
from .numeric import SIGN_VELOCITY
from ..exceptions import ParameterRangeError
from ..parameters.specification import ParameterGroup


class Effect(DrawnEffect):
    """
    Base class of all effects.

    Attributes
    ----------
    name : str
        Key in EFFECTS and in `physics` of a model file.
    port : str
        Where the effect acts: 'contact', 'force_sensor' or 'robot'.
    family : str
        Kind of physics, such as 'friction'; effects of one family are easily confused.
    equation : str
        The law, as reports print it.
    description : str
        One sentence that explains the effect to a reader of a report.
    linear_in : tuple of str
        Parameters in which the law is linear; the first alone where empty.
    in_logarithm : tuple of str
        Parameters searched on a logarithmic scale, because their unit depends on another one.
    needs_touch : bool
        Whether the effect cannot be identified in a permanently attached environment.
    needs_attachment : bool
        Whether the effect is another one on a wall that only pushes.
    rescales_wall : bool
        Whether the measured force tells K_e and B_e times a value of the effect alone, see
        `wall_scale`.
    needs_penetration : bool
        Whether the law holds for x beyond x_e only, in a permanently attached environment too.
    needs_return : bool
        Whether a specimen that is loaded once, and not unloaded, may as well relax or follow an
        elastic law.
    needs_spring : bool
        Whether the effect is without one a constant force, another effect, or nothing at all.
    needs_robot : bool
        Whether the motion of a robot tells the effect: without one, the parameters of the wall
        make up for it.
    base_parameter : str
        Name of the parameter of the wall that describes the same physics; '' if there is none.
    resonates : bool
        Whether it is a mass on a spring of its own: of its frequency one step tells little.
    clips_force : bool
        Whether the measured force is level where the effect acts, by which it is told.
    lets_go : bool
        Whether the force may vanish during contact.
    reached_force : str
        Parameter that is a force which the measured one has to reach; '' if there is none.
    reached_length : str
        Parameter that is a length a fair part of which the motion has to cover; '' if there is
        none.
    covered_depth : str
        The same, of the motion in contact.
    resolved_length : str
        Parameter that is a length well above the noise of the positions; '' if there is none.
    resolved_speed : str
        Parameter that is a speed beyond that at which dry friction fades; '' if there is none.
    sampled_frequency : str
        Parameter that is a frequency which the samples have to resolve; '' if there is none.
    sampled_delay : str
        Parameter that is a delay or a lag, to be a fair share of a sample period; '' if there is
        none.
    sign_velocity : float
        Width of the smooth sign of a velocity [m/s], sgn(v) = tanh(v / sign_velocity).

    Parameters
    ----------
    values : ParameterGroup
        An instance of `Parameters` without NaN.

    """

    name: ClassVar[str]
    port: ClassVar[str]
    family: ClassVar[str]
    equation: ClassVar[str]
    description: ClassVar[str]
    linear_in: ClassVar[tuple[str, ...]] = ()
    in_logarithm: ClassVar[tuple[str, ...]] = ()
    needs_touch: ClassVar[bool] = False
    needs_attachment: ClassVar[bool] = False
    rescales_wall: ClassVar[bool] = False
    needs_penetration: ClassVar[bool] = False
    needs_return: ClassVar[bool] = False
    needs_spring: ClassVar[bool] = False
    needs_robot: ClassVar[bool] = False
    base_parameter: ClassVar[str] = ''
    resonates: ClassVar[bool] = False
    clips_force: ClassVar[bool] = False
    lets_go: ClassVar[bool] = False
    reached_force: ClassVar[str] = ''
    reached_length: ClassVar[str] = ''
    covered_depth: ClassVar[str] = ''
    resolved_length: ClassVar[str] = ''
    resolved_speed: ClassVar[str] = ''
    sampled_frequency: ClassVar[str] = ''
    sampled_delay: ClassVar[str] = ''
    sign_velocity: float = SIGN_VELOCITY

    def __init__(self, values: ParameterGroup) -> None:
        self.values: Any = values

    @classmethod
    def when_on(cls, values: ParameterGroup) -> 'Effect | None':
        """
        Make the effect if its parameters are given.

        Returns effect: None where all parameters are NaN
        """
        names = [field.name for field in fields(values)]
        missing = [name for name in names if isnan(getattr(values, name))]
        if len(missing) == len(names):
            return None
        if missing:
            raise ParameterRangeError(
                f'physics.{cls.name} needs all of {", ".join(names)}; missing: '
                f'{", ".join(missing)}; set them too, or all to NaN to switch the effect off'
            )
        return cls(values)

    @classmethod
    def plausible(cls, values: Any) -> bool:
        """
        Return whether values, each within its range, are physically possible together.

        Returns plausible: for example False for a Stribeck friction that rises with speed
        """
        return True

    @classmethod
    def drives(cls, values: Any, stiffness: float, damping: float) -> bool:
        """
        Return whether the effect drives the motion beside a spring and a damper.

        stiffness, damping: K_e [N/m] and B_e [N s/m] of the wall
        Returns drives: if so, the values are not plausible together
        """
        return False

    @classmethod
    def vanishes(cls, values: Any) -> bool:
        """
        Return whether the effect changes nothing.

        Returns vanishes: all parameters in which the law is linear have their neutral value
        """
        return all(getattr(values, name) == cls.neutral.get(name, 0.0) for name in cls.linear())

    @classmethod
    def linear(cls) -> tuple[str, ...]:
        """Return the parameters in which the law is linear, by default the first."""
        return cls.linear_in or (fields(cls.Parameters)[0].name,)

    @classmethod
    def wall_scale(cls, values: Any) -> float:
        """
        Return what the wall's values must be multiplied by for the measured force to stay.

        Returns scale: 1 unless `rescales_wall`
        """
        return 1.0

    @classmethod
    def is_flexible(cls, values: Any, duration: float) -> bool:
        """
        Return whether the effect is a curve that fits almost any misfit of its kind.

        duration: of the recording [s]
        Returns flexible: if so, more is asked of it than of a law
        """
        return False

    @classmethod
    def bends(cls, values: Any) -> tuple[float, ...]:
        """
        Return where the law bends sharply.

        Returns bends: penetrations that the motion has to pass for the effect to show [m]
        """
        return ()

    @classmethod
    def exceeds_calibration(cls, values: Any, force: float) -> bool:
        """
        Return whether the effect is more than a calibration usually leaves.

        force: largest measured [N]
        Returns exceeds: if not, the effect is not named with these values
        """
        return True

    @classmethod
    def tones(cls, values: Any) -> tuple[float, ...]:
        """Return the frequencies of a motion of its own [Hz]; parameters as `plausible`."""
        return ()

    @classmethod
    def is_resolved(cls, values: Any, duration: float) -> bool:
        """
        Return whether a recording is long enough to tell the parameters apart.

        duration: of the recording [s]
        Returns resolved: if not, the effect is not named with these values
        """
        return True
