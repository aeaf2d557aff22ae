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
pipeline takes it out of the measured force, the diagnosis fits it.
"""

from __future__ import annotations

from abc import ABC
from dataclasses import fields
import math
from math import isnan
from typing import Any, ClassVar, Iterator, Mapping, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from ..exceptions import ParameterRangeError
from ..parameters.specification import ParameterGroup

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Number = TypeVar('Number', float, Any)

SIGN_VELOCITY = 4e-4
"""sgn(v) = tanh(v / SIGN_VELOCITY) [m/s], the contract's smooth sign."""


class Scales(NamedTuple):
    """
    How large things are in a recording: where a search for an effect's parameters starts.

    Attributes
    ----------
    depth, speed, force, control : float
        Greatest penetration [m], rate of it [m/s], contact force [N] and control force [N].
    greatest_pull : float
        Greatest positive F_e [N].
    duration : float
        Of the recording [s].
    stiffness, damping, mass : float
        K_e [N/m] and B_e [N s/m] as fitted without effects, M_t [kg].
    spectrum : sequence of (float, complex)
        Frequencies [Hz] and complex amplitudes [N] of the largest peaks in the contact residual.

    """

    depth: float
    speed: float
    force: float
    control: float
    greatest_pull: float
    duration: float
    stiffness: float
    damping: float
    mass: float
    spectrum: tuple[tuple[float, complex], ...] = ()

    def peaks(self) -> tuple[tuple[float, complex], ...]:
        """Give the peaks of the contact residual's spectrum, or one guess where none is known."""
        return self.spectrum or ((1.0, complex(0.0, -0.02 * self.force)),)


def positive(x: Number, m: Any) -> Number:
    """
    Give max(x, 0).

    Parameters
    ----------
    x : float or ndarray
        Any quantity.
    m : module
        `math` or `numpy`.

    Returns
    -------
    y : float or ndarray
        As `x`.

    """
    return max(x, 0.0) if m is math else m.maximum(x, 0.0)


def stretches(flag: NDArray[np.bool_]) -> Iterator[tuple[int, int]]:
    """
    Cut a flag into stretches of one value.

    Parameters
    ----------
    flag : ndarray of bool, shape (N,)
        Such as contact.

    Yields
    ------
    first, stop : int
        Range of indices over which the flag does not change.

    """
    edges = [0, *(np.flatnonzero(np.diff(flag)) + 1).tolist(), len(flag)]
    yield from zip(edges[:-1], edges[1:])


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
    neutral : mapping
        Values of parameters at which the effect vanishes, where that is not 0.
    in_logarithm : tuple of str
        Parameters whose logarithm searches vary, since another's power weighs them.
    needs_touch : bool
        Whether it has no meaning of its own in a permanently attached environment.

    Parameters
    ----------
    values : ParameterGroup
        An instance of `Parameters` without NaN.

    """

    name: ClassVar[str]
    port: ClassVar[str]
    equation: ClassVar[str]
    Parameters: ClassVar[type[ParameterGroup]]
    neutral: ClassVar[Mapping[str, float]] = {}
    in_logarithm: ClassVar[tuple[str, ...]] = ()
    needs_touch: ClassVar[bool] = False

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

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """
        Say where a search for the parameters begins.

        Parameters
        ----------
        scales : Scales
            How large things are.

        Returns
        -------
        starts : list of tuple of float
            Values of all parameters; several where the misfit has several valleys.

        """
        raise NotImplementedError

    @classmethod
    def plausible(cls, values: Any) -> bool:
        """
        Tell whether values within their ranges are physics together.

        Parameters
        ----------
        values : ParameterGroup
            An instance of `Parameters`.

        Returns
        -------
        plausible : bool
            False such as for a Stribeck friction that rises.

        """
        return True


class ContactEffect(Effect):
    """
    Physics of the wall: F_e = -(spring + damper + sum of resistances + inertia a) in contact.

    Each hook's default is "no change"; a subclass overrides what its law touches. The order is
    surface, transmit, deflection, spring, damper, resistance, then the pull of `pull` and `tail`.

    """

    port = 'contact'
    states: ClassVar[int] = 0
    """Number of internal states, integrated with the plant."""

    replaces_stiffness: ClassVar[bool] = False
    """K_e has no meaning beside this effect."""

    replaces_damping: ClassVar[bool] = False
    """B_e has no meaning beside this effect."""

    lets_go: ClassVar[bool] = False
    """The force may vanish in the midst of a contact."""

    jumps: ClassVar[bool] = False
    """The resistance, a function of the rate alone, jumps where the motion turns."""

    inertia: float = 0.0
    """Mass that moves with the contact point [kg]."""

    exponent: float = 1.0
    """Power of the depth in the elastic force."""

    pull: float = 0.0
    """Greatest positive F_e in contact [N]."""

    def surface(self, t: Number, state: Any, m: Any) -> tuple[Any, Any]:
        """
        Tell where the surface has moved.

        Parameters
        ----------
        t : float or ndarray, shape (N,)
            Time since the first sample [s].
        state : sequence
            The effect's internal states.
        m : module
            `math` or `numpy`.

        Returns
        -------
        shift, rate : float or ndarray, shape (N,)
            Of x_e [m], [m/s].

        """
        return 0.0, 0.0

    def transmit(self, d: Number, v: Number, state: Any, m: Any) -> tuple[Any, Any, Any]:
        """
        Tell what of the tool's motion reaches the wall; parameters as `resistance`.

        Returns
        -------
        d, v : float or ndarray, shape (N,)
            Penetration [m] and rate [m/s] of what touches the wall.
        engaged : bool or ndarray of bool
            Whether a force can be passed on.

        """
        return d, v, True

    def deflection(self, d: Number, m: Any) -> Number:
        """
        Tell by how much the linear spring is compressed.

        Parameters
        ----------
        d : float or ndarray, shape (N,)
            Penetration [m].
        m : module
            `math` or `numpy`.

        Returns
        -------
        deflection : float or ndarray, shape (N,)
            Compression [m].

        """
        return d

    def spring(self, t: Number, d: Number, force: Number, m: Any) -> Number:
        """
        Replace the elastic force.

        Parameters
        ----------
        t, d : float or ndarray, shape (N,)
            Time [s] and penetration [m].
        force : float or ndarray, shape (N,)
            The elastic force so far, K_e times the deflection [N].
        m : module
            `math` or `numpy`.

        Returns
        -------
        force : float or ndarray, shape (N,)
            The elastic force [N].

        """
        return force

    def damper(self, d: Number, v: Number, force: Number, exponent: float, m: Any) -> Number:
        """
        Replace the damping force.

        Parameters
        ----------
        d, v : float or ndarray, shape (N,)
            Penetration [m] and its rate [m/s].
        force : float or ndarray, shape (N,)
            The damping force so far, B_e v [N].
        exponent : float
            Power of the depth in the elastic force.
        m : module
            `math` or `numpy`.

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

    def tail(self, d: Number, v: Number, state: Any, m: Any) -> Number:
        """
        Give F_e out of contact (d <= 0); parameters as `resistance`.

        Returns
        -------
        F_e : float or ndarray, shape (N,)
            Force [N].

        """
        return 0.0 * v

    def state_rates(
        self, t: float, d: float, v: float, contact: bool, state: tuple[float, ...]
    ) -> tuple[float, ...]:
        """
        Differentiate the internal states; parameters as `resistance`, contact as d > 0.

        Returns
        -------
        rates : tuple of float, length `states`
            Time derivatives.

        """
        return (0.0,) * self.states

    def settle(
        self, d: float, v: float, contact: bool, state: tuple[float, ...]
    ) -> tuple[float, ...]:
        """
        Keep the internal states where they may be, after a step of integration.

        Parameters
        ----------
        d, v, contact, state
            As for `state_rates`.

        Returns
        -------
        state : tuple of float, length `states`
            What holds from here on.

        """
        return state

    def states_along(self, t: Array, d: Array, v: Array, contact: NDArray[np.bool_]) -> Array:
        """
        Follow the internal states along a recorded motion, from 0 (midpoint rule).

        Parameters
        ----------
        t, d, v : ndarray, shape (N,)
            Time [s], evenly spaced, penetration [m] and its rate [m/s], less what this effect
            itself does to them.
        contact : ndarray of bool, shape (N,)
            d > 0.

        Returns
        -------
        states : ndarray, shape (states, N)
            At the samples.

        """
        state = self.settle(float(d[0]), float(v[0]), bool(contact[0]), (0.0,) * self.states)
        h, states = float(t[1] - t[0]), [state]
        samples = list(zip(t.tolist(), d.tolist(), v.tolist(), contact.tolist()))
        for (t_0, d_0, v_0, c_0), (_, d_1, v_1, c_1) in zip(samples[:-1], samples[1:]):
            touching = c_0 or c_1
            k = self.state_rates(t_0, d_0, v_0, touching, state)
            middle = tuple(s + 0.5 * h * rate for s, rate in zip(state, k))
            d_m, v_m = 0.5 * (d_0 + d_1), 0.5 * (v_0 + v_1)
            k = self.state_rates(t_0 + 0.5 * h, d_m, v_m, touching, middle)
            state = tuple(s + h * rate for s, rate in zip(state, k))
            state = self.settle(d_1, v_1, c_1, state)
            states.append(state)
        return np.array(states).T


class ForceSensorEffect(Effect):
    """Physics of the force sensor: what it makes of the true force."""

    port = 'force_sensor'
    memory: ClassVar[bool] = False
    """Whether a reading depends on earlier forces."""

    limit: float = math.inf
    """End of the sensor's range [N]."""

    added_mass: float = 0.0
    """Mass beyond the sensor [kg], which the sensor feels and the wall does not."""

    def sense(self, t: float, dt: float, force: float, acceleration: float) -> float:
        """
        Pass one instant through the sensor.

        Parameters
        ----------
        t, dt : float
            Time and time since the last call [s].
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

    def sense_along(self, t: Array, force: Array, acceleration: Array) -> Array:
        """
        Pass a recording through the sensor: `sense` for evenly spaced samples at once.

        Parameters
        ----------
        t, force, acceleration : ndarray, shape (N,)
            Time [s], F_e [N] and acceleration [m/s^2].

        Returns
        -------
        force : ndarray, shape (N,)
            As measured [N].

        """
        readings, last = [], float(t[0])
        for now, f, a in zip(t.tolist(), force.tolist(), acceleration.tolist()):
            readings.append(self.sense(now, now - last, f, a))
            last = now
        return np.array(readings)

    def undo(self, t: Number, reading: Number) -> Number:
        """
        Take out of a reading what does not depend on acceleration or on earlier forces.

        Parameters
        ----------
        t : float or ndarray, shape (N,)
            Time [s].
        reading : float or ndarray, shape (N,)
            As measured [N].

        Returns
        -------
        force : float or ndarray, shape (N,)
            As the chain before this effect has had it, where that can be told [N].

        """
        return reading

    def undo_along(self, t: Array, reading: Array) -> Array:
        """
        Take out of a recording what does not depend on acceleration.

        Parameters
        ----------
        t, reading : ndarray, shape (N,)
            Time [s] and reading [N].

        Returns
        -------
        force : ndarray, shape (N,)
            As the chain before this effect has had it, where that can be told [N].

        """
        return np.asarray(self.undo(t, reading))


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

    def control(self, u: Number, m: Any) -> Number:
        """
        Limit the control force.

        Parameters
        ----------
        u : float or ndarray, shape (N,)
            Force wanted by the impedance law [N].
        m : module
            `math` or `numpy`.

        Returns
        -------
        u : float or ndarray, shape (N,)
            Force delivered [N].

        """
        return u

    def drag(self, velocity: Number, m: Any) -> Number:
        """
        Give the force that resists the motion of the robot.

        Parameters
        ----------
        velocity : float or ndarray, shape (N,)
            Of the end-effector [m/s].
        m : module
            `math` or `numpy`.

        Returns
        -------
        force : float or ndarray, shape (N,)
            Positive where it resists positive velocity [N].

        """
        return 0.0 * velocity
