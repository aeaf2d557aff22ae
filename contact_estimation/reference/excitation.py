# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Excitation signals: sine, multisine and pseudo-random binary sequence."""

from __future__ import annotations

from abc import ABC, abstractmethod
from functools import lru_cache
from math import cos, pi, sin
from typing import Sequence

import numpy as np

from ..exceptions import ParameterRangeError


class Excitation(ABC):
    """An excitation signal, in the unit of its amplitude."""

    @abstractmethod
    def value(self, t: float) -> float:
        """
        Return the value of the signal.

        t: time of the experiment [s]
        """

    @abstractmethod
    def rates(self, t: float) -> tuple[float, float]:
        """
        Return the derivatives of the signal; steps count as 0.

        t: time of the experiment [s]
        Returns first, second: derivatives, per second and per second squared
        """


class Sine(Excitation):
    """
    Eqs. (40) and (41): amplitude sin(omega t).

    omega: angular frequency [rad/s]
    """

    def __init__(self, amplitude: float, omega: float) -> None:
        self.amplitude, self.omega = amplitude, omega

    def value(self, t: float) -> float:
        """Return the value; see `Excitation.value`."""
        return self.amplitude * sin(self.omega * t)

    def rates(self, t: float) -> tuple[float, float]:
        """Return the derivatives; see `Excitation.rates`."""
        w = self.omega
        return self.amplitude * w * cos(w * t), -w * w * self.value(t)


class Multisine(Excitation):
    """
    Sum of sines of equal amplitude with Schroeder phases, which keep the peak low.

    omegas: angular frequencies [rad/s]
    """

    def __init__(self, amplitude: float, omegas: Sequence[float]) -> None:
        if not omegas:
            raise ParameterRangeError('a multisine needs at least one frequency, got none')
        if min(omegas) <= 0.0:
            raise ParameterRangeError(f'frequencies must be > 0 rad/s, got {min(omegas):g}')
        self.amplitude, self.omegas = amplitude, list(omegas)
        count = len(omegas)
        phases = [-pi * k * (k - 1) / count for k in range(1, count + 1)]
        self._parts = list(zip(omegas, phases))
        t = np.linspace(0.0, 2.0 * pi / min(omegas), 2000)
        total = np.sum([np.sin(w * t + p) for w, p in self._parts], axis=0)
        self._scale = amplitude / float(np.max(np.abs(total)))

    def value(self, t: float) -> float:
        """Return the value; see `Excitation.value`."""
        return self._scale * sum(sin(w * t + p) for w, p in self._parts)

    def rates(self, t: float) -> tuple[float, float]:
        """Return the derivatives; see `Excitation.rates`."""
        return (
            self._scale * sum(w * cos(w * t + p) for w, p in self._parts),
            -self._scale * sum(w * w * sin(w * t + p) for w, p in self._parts),
        )


class PseudoRandomBinary(Excitation):
    """
    Pseudo-random binary sequence of the paper: 10 registers, feedback from 7 and 10, 20 Hz.

    shift_rate: shifts per second [Hz]
    """

    def __init__(self, amplitude: float, shift_rate: float = 20.0) -> None:
        if shift_rate <= 0.0:
            raise ParameterRangeError(f'shift_rate must be > 0 Hz, got {shift_rate:g}')
        self.amplitude, self.shift_rate = amplitude, shift_rate

    def value(self, t: float) -> float:
        """Return the value; see `Excitation.value`."""
        bits = register_sequence()
        # The epsilon places a stamp that is a rounding error before a shift after it.
        bit = bits[int(t * self.shift_rate + 1e-6) % len(bits)]
        return self.amplitude if bit else -self.amplitude

    def rates(self, t: float) -> tuple[float, float]:
        """Return the derivatives; see `Excitation.rates`."""
        return 0.0, 0.0


@lru_cache(maxsize=1)
def register_sequence() -> tuple[int, ...]:
    """
    Return one period, 2^10 - 1 shifts, of the shift register started with all ones.

    Returns bits: output of register 10
    """
    register = [1] * 10
    bits = []
    for _ in range(1023):
        bits.append(register[9])
        register = [register[6] ^ register[9], *register[:9]]
    return tuple(bits)
