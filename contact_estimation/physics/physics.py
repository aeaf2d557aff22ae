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

"""
What extra physics is: the places of a contact experiment where an effect can act.

An effect's law is written once, as a function that takes numbers or arrays (`m` is the module to
calculate with: `math` for numbers, `numpy` for arrays). The plant integrates it, the estimation
pipeline subtracts it from the measured force, the diagnosis fits it.
"""

from __future__ import annotations

from abc import ABC
from dataclasses import fields
from math import isnan
from typing import Any, ClassVar, TypeVar

from ..exceptions import ParameterRangeError
from ..parameters import ParameterGroup

Number = TypeVar('Number', float, Any)

SIGN_VELOCITY = 4e-4
"""sgn(v) = tanh(v / SIGN_VELOCITY) [m/s], the contract's smooth sign."""


class Effect(ABC):
    """
    Base of all effects.

    Attributes
    ----------
    name : str
        As in the contract; the key of EFFECTS and of `physics` in a model file.
    port : str
        Where it acts: 'contact', 'force_sensor' or 'robot'.
    equation : str
        The law in the contract's symbols.
    Parameters : type of ParameterGroup
        All fields floats with NaN as default: off.

    Parameters
    ----------
    values : ParameterGroup
        An instance of `Parameters` without NaN.

    """

    name: ClassVar[str]
    port: ClassVar[str]
    equation: ClassVar[str]
    Parameters: ClassVar[type[ParameterGroup]]

    def __init__(self, values: ParameterGroup) -> None:
        self.values: Any = values

    @classmethod
    def when_on(cls, values: ParameterGroup) -> 'Effect | None':
        """
        Make the effect if its parameters are given.

        Parameters
        ----------
        values : ParameterGroup
            An instance of `Parameters`.

        Returns
        -------
        effect : Effect or None
            None where all parameters are NaN.

        Raises
        ------
        ParameterRangeError
            If only some of the parameters are given.

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


class ContactEffect(Effect):
    """
    Physics of the wall: F_e = -(spring + damper + sum of resistances + inertia a) in contact.

    Each hook's default is "no change"; a subclass overrides what its law touches.

    """

    port = 'contact'
    states: ClassVar[int] = 0
    """Number of internal states, integrated with the plant."""

    inertia: float = 0.0
    """Mass that moves with the contact point [kg]."""

    def surface(self, t: float) -> tuple[float, float]:
        """
        Tell where the surface has moved.

        Parameters
        ----------
        t : float
            Time since the first sample [s].

        Returns
        -------
        shift, rate : float
            Of x_e [m], [m/s].

        """
        return 0.0, 0.0

    def spring(self, t: Number, d: Number, force: Number, m: Any) -> Number:
        """
        Replace the elastic force.

        Parameters
        ----------
        t, d : float or ndarray, shape (N,)
            Time [s] and penetration [m].
        force : float or ndarray, shape (N,)
            The elastic force so far, K_e d [N].
        m : module
            `math` or `numpy`.

        Returns
        -------
        force : float or ndarray, shape (N,)
            The elastic force [N].

        """
        return force

    def damper(self, d: Number, v: Number, force: Number, m: Any) -> Number:
        """
        Replace the damping force; parameters as `spring`, with v the penetration rate [m/s].

        Returns
        -------
        force : float or ndarray, shape (N,)
            The damping force [N].

        """
        return force

    def resistance(self, t: Number, d: Number, v: Number, state: Any, m: Any) -> Number:
        """
        Give the additional force R that resists penetration.

        Parameters
        ----------
        t, d, v : float or ndarray, shape (N,)
            Time [s], penetration [m] and its rate [m/s].
        state : sequence
            The effect's internal states.
        m : module
            `math` or `numpy`.

        Returns
        -------
        R : float or ndarray, shape (N,)
            Force [N], positive where it resists.

        """
        return 0.0 * v

    def state_rates(
        self, t: float, d: float, v: float, contact: bool, state: tuple[float, ...]
    ) -> tuple[float, ...]:
        """
        Differentiate the internal states; parameters as `resistance`.

        Returns
        -------
        rates : tuple of float, length `states`
            Time derivatives.

        """
        return ()


class ForceSensorEffect(Effect):
    """Physics of the force sensor: what it makes of the true force."""

    port = 'force_sensor'

    def sense(self, t: float, dt: float, force: float, acceleration: float) -> float:
        """
        Pass one sample through the sensor.

        Parameters
        ----------
        t, dt : float
            Time and time since the last sample [s].
        force : float
            F_e as the chain so far gives it [N].
        acceleration : float
            Of the end-effector [m/s^2].

        Returns
        -------
        force : float
            As measured [N].

        """
        return force


class RobotEffect(Effect):
    """Physics of the robot: how it departs from the target impedance of eq. (1)."""

    port = 'robot'
    mass_scale: float = 1.0
    damping_scale: float = 1.0
    stiffness_scale: float = 1.0
    reflected_inertia: float = 0.0
    """Mass that the feed-forward does not know [kg]."""

    reference_delay: float = 0.0
    """Time by which the reference arrives late [s]."""

    def control(self, u: float) -> float:
        """
        Limit the control force.

        Parameters
        ----------
        u : float
            Force wanted by the impedance law [N].

        Returns
        -------
        u : float
            Force delivered [N].

        """
        return u

    def drag(self, velocity: float) -> float:
        """
        Give the force that resists the motion of the robot.

        Parameters
        ----------
        velocity : float
            Of the end-effector [m/s].

        Returns
        -------
        force : float
            Positive where it resists positive velocity [N].

        """
        return 0.0
