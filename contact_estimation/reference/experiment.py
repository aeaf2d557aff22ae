# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Experiments: setpoints over time, with excitation."""

from abc import ABC, abstractmethod
import bisect
from dataclasses import dataclass
from functools import lru_cache
from math import cos, nan, pi, sin
from typing import Sequence

import numpy as np

from .reference_generator import quintic
from .setpoints import Desired
from ..exceptions import ParameterRangeError


class Excitation(ABC):
    """An excitation signal, in the unit of its amplitude."""

    @abstractmethod
    def value(self, t: float) -> float:
        """Return the value of the signal; t: time of the experiment [s]."""

    @abstractmethod
    def rates(self, t: float) -> tuple[float, float]:
        """Return the first and second derivative at a time [s]; steps count as 0."""


class Sine(Excitation):
    """Eqs. (40) and (41): amplitude sin(omega t); omega: angular frequency [rad/s]."""

    def __init__(self, amplitude: float, omega: float) -> None:
        self.amplitude, self.omega = amplitude, omega

    def value(self, t: float) -> float:
        return self.amplitude * sin(self.omega * t)

    def rates(self, t: float) -> tuple[float, float]:
        w = self.omega
        return self.amplitude * w * cos(w * t), -w * w * self.value(t)


class Multisine(Excitation):
    """Sum of sines of equal size at omegas [rad/s]; Schroeder phases keep the peak low."""

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
        return self._scale * sum(sin(w * t + p) for w, p in self._parts)

    def rates(self, t: float) -> tuple[float, float]:
        return (
            self._scale * sum(w * cos(w * t + p) for w, p in self._parts),
            -self._scale * sum(w * w * sin(w * t + p) for w, p in self._parts))


class PseudoRandomBinary(Excitation):
    """Pseudo-random binary sequence of the paper: 10 registers, feedback from 7 and 10, 20 Hz."""

    def __init__(self, amplitude: float, shift_rate: float = 20.0) -> None:
        if shift_rate <= 0.0:
            raise ParameterRangeError(f'shift_rate must be > 0 Hz, got {shift_rate:g}')
        self.amplitude, self.shift_rate = amplitude, shift_rate

    def value(self, t: float) -> float:
        bits = register_sequence()
        # The epsilon places a stamp that is a rounding error before a shift after it.
        bit = bits[int(t * self.shift_rate + 1e-6) % len(bits)]
        return self.amplitude if bit else -self.amplitude

    def rates(self, t: float) -> tuple[float, float]:
        return 0.0, 0.0


@lru_cache(maxsize=1)
def register_sequence() -> tuple[int, ...]:
    """Return one period, 2^10 - 1 outputs of register 10, of the register started with ones."""
    # Written out: scipy.signal takes a second to import, at the first sample of a running node.
    register = [1] * 10
    bits = []
    for _ in range(1023):
        bits.append(register[9])
        register = [register[6] ^ register[9], *register[:9]]
    return tuple(bits)


START = -0.10
"""Default position before an experiment [m]."""


@dataclass(frozen=True)
class Segment:
    """Quintic motion to a position, with superposed excitation."""

    duration: float  # duration [s], > 0
    position: float  # final position [m]; equal to the previous one for a hold
    force: float = nan  # F_d [N], positive while pressing; NaN: no force prescribed
    # force_excitation, position_excitation: added to F_d [N] and x_d [m]; functions of the time
    # since the start of the experiment
    force_excitation: Excitation | None = None
    position_excitation: Excitation | None = None


class Experiment:
    """
    A sequence of segments.

    start: position before the first segment [m]
    """

    def __init__(self, name: str, start: float, segments: tuple[Segment, ...]) -> None:
        self.name, self.start, self.segments = name, start, segments
        self._repeats = False
        self._begins = [0.0]
        for segment in segments:
            self._begins.append(self._begins[-1] + segment.duration)

    @property
    def duration(self) -> float:
        """Total duration [s]."""
        return self._begins[-1]

    def cyclic(self) -> 'Experiment':
        """Return the experiment as an endless cycle."""
        segments = self.segments
        if segments[-1].position != self.start:
            segments = (*segments, Segment(segments[0].duration, self.start))
        cycle = Experiment(self.name, self.start, segments)
        cycle._repeats = True
        return cycle

    def desired(self, t: float) -> Desired:
        """Return the setpoint at a time [s]; before and after it rests, unless it is a cycle."""
        if self._repeats and t >= 0.0:
            t %= self.duration
        index = bisect.bisect_right(self._begins, t) - 1
        if index < 0 or index >= len(self.segments):
            rest = self.start if index < 0 else self.segments[-1].position
            return Desired(rest, 0.0, 0.0, nan)
        segment = self.segments[index]
        before = self.segments[index - 1].position if index else self.start
        since = t - self._begins[index]
        x, v, a = quintic(before, segment.position, segment.duration, since)
        if segment.position_excitation is not None:
            first, second = segment.position_excitation.rates(t)
            x, v, a = x + segment.position_excitation.value(t), v + first, a + second
        force = segment.force
        if segment.force_excitation is not None:
            force += segment.force_excitation.value(t)
        return Desired(x, v, a, force)

    def hold(self) -> tuple[float, float] | None:
        """Return begin and end [s] of the longest rest of x_d under a force; None without one."""
        rests = [
            (begin, begin + segment.duration)
            for begin, segment, before in zip(
                self._begins, self.segments, (self.start, *(s.position for s in self.segments)))
            if segment.force == segment.force and segment.position == before]
        return max(rests, key=lambda r: r[1] - r[0], default=None)

    @property
    def desired_force(self) -> float:
        """F_d of the hold [N]; NaN where no force is prescribed."""
        return next((s.force for s in self.segments if s.force == s.force), nan)
