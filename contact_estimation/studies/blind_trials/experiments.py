# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Randomised experiments: touches of a wall, and motions of what is attached."""

from math import pi
from typing import Callable, Mapping, NamedTuple

from numpy.random import Generator

from ...physics.prior import log_uniform
from ...reference.experiment import (
    Excitation, Experiment, Multisine, PseudoRandomBinary, Segment, Sine)
from ...reference.reference_generator import quintic

_FADE_S = 0.3
_MAX_SPEED = 0.2  # of x_r; faster approaches end in an impact [m/s]


class Stage(NamedTuple):
    """Geometry of an experiment."""

    surface: float  # x_e [m]
    rest: float  # position between touches [m]
    reach: float  # distance of x_r beyond the surface at level 1 [m]


class Faded(Excitation):
    """An excitation that is faded in smoothly from `begin` on, and out until `end` [s]."""

    def __init__(self, signal: Excitation, begin: float, end: float) -> None:
        self._signal, self._begin, self._end = signal, begin, end

    def _window(self, t: float) -> tuple[float, float, float]:
        if t < 0.5 * (self._begin + self._end):
            return quintic(0.0, 1.0, _FADE_S, t - self._begin)
        return quintic(1.0, 0.0, _FADE_S, t - self._end + _FADE_S)

    def value(self, t: float) -> float:
        return self._window(t)[0] * self._signal.value(t)

    def rates(self, t: float) -> tuple[float, float]:
        w, w_dot, w_ddot = self._window(t)
        value, (first, second) = self._signal.value(t), self._signal.rates(t)
        return (w_dot * value + w * first, w_ddot * value + 2.0 * w_dot * first + w * second)


class Builder:
    """Build an experiment segment by segment, from rest at the rest position."""

    def __init__(self, stage: Stage) -> None:
        self._stage = stage
        self._segments: list[Segment] = []
        self._t, self._x = 0.0, stage.rest

    def wait(self, duration: float) -> None:
        """Stay in place for a duration [s]."""
        self.go(self._x, duration)

    def go(self, position: float, duration: float, excitation: Excitation | None = None) -> None:
        """Move to a position [m] along a quintic within a duration [s], but at most at 0.2 m/s."""
        duration = max(duration, 1.875 * abs(position - self._x) / _MAX_SPEED)
        self._segments.append(Segment(duration, position, position_excitation=excitation))
        self._t, self._x = self._t + duration, position

    def press(self, level: float, duration: float) -> None:
        """Press into the surface to a fraction of the reach within a duration [s]."""
        self.go(self._stage.surface + level * self._stage.reach, duration)

    def hold(self, duration: float, signal: Excitation) -> None:
        """Stay in place for a duration [s] with a signal, faded unless it is binary."""
        end = self._t + duration
        if not isinstance(signal, PseudoRandomBinary):
            signal = Faded(signal, self._t, end)
        self.go(self._x, duration, signal)

    def retract(self, duration: float) -> None:
        """Move back to the rest position in a duration [s], as for `go`."""
        self.go(self._stage.rest, duration)

    def experiment(self, name: str) -> Experiment:
        """Return the experiment built so far."""
        return Experiment(name, self._stage.rest, tuple(self._segments))


def _rich(stage: Stage, rng: Generator) -> Experiment:
    """Build two or three touches of different depth and speed, each with a multisine."""
    builder = Builder(stage)
    count = int(rng.integers(2, 4))
    for level in rng.permutation([1.0, *rng.uniform(0.3, 0.9, count - 1)]).tolist():
        builder.wait(float(rng.uniform(0.5, 1.2)))
        builder.press(level, float(rng.choice([0.4, 0.8, 1.2, 1.8])))
        omegas = (2.0 * pi * rng.uniform(0.4, 9.0, int(rng.integers(3, 9)))).tolist()
        amplitude = float(rng.uniform(0.08, 0.25)) * level * stage.reach
        builder.hold(float(rng.uniform(2.0, 3.5)), Multisine(amplitude, omegas))
        builder.retract(float(rng.choice([0.5, 1.0, 2.0])))
    builder.wait(0.6)
    return builder.experiment('rich')


def _cycles(stage: Stage, rng: Generator) -> Experiment:
    """Build touches of two levels each, without excitation signal."""
    builder = Builder(stage)
    for _ in range(int(rng.integers(3, 5))):
        builder.wait(float(rng.uniform(0.4, 1.2)))
        level = float(rng.uniform(0.4, 1.0))
        builder.press(level, float(rng.choice([0.4, 0.8, 1.6])))
        builder.wait(float(rng.uniform(0.6, 1.5)))
        builder.press(level * float(rng.uniform(0.35, 0.65)), float(rng.choice([0.2, 0.5, 1.0])))
        builder.wait(float(rng.uniform(0.4, 1.0)))
        builder.retract(float(rng.choice([0.4, 0.8, 1.6])))
    builder.wait(0.6)
    return builder.experiment('cycles')


def _prbs(stage: Stage, rng: Generator) -> Experiment:
    """Build one long touch with a binary sequence."""
    signal = PseudoRandomBinary(float(rng.uniform(0.04, 0.12)) * stage.reach)
    return _single(stage, rng, 'prbs', signal)


def _paper(stage: Stage, rng: Generator) -> Experiment:
    """Build one touch with a sine, as eq. (41)."""
    amplitude = float(rng.uniform(0.05, 0.15)) * stage.reach
    return _single(stage, rng, 'paper', Sine(amplitude, float(rng.uniform(10.0, 25.0))))


def _single(stage: Stage, rng: Generator, name: str, signal: Excitation) -> Experiment:
    builder = Builder(stage)
    builder.wait(float(rng.uniform(0.5, 1.0)))
    builder.press(1.0, float(rng.uniform(1.2, 2.2)))
    builder.wait(0.4)
    builder.hold(float(rng.uniform(4.0, 7.0)), signal)
    builder.wait(0.4)
    builder.retract(float(rng.uniform(1.2, 2.2)))
    builder.wait(0.8)
    return builder.experiment(name)


_KINDS: Mapping[str, tuple[float, Callable[[Stage, Generator], Experiment]]] = {
    'rich': (0.55, _rich),
    'cycles': (0.2, _cycles),
    'prbs': (0.125, _prbs),
    'paper': (0.125, _paper),
}
"""Probability and builder by kind."""


def draw_touches(stage: Stage, rng: Generator) -> Experiment:
    """Draw an experiment of a robot at a wall."""
    weights = [weight for weight, _ in _KINDS.values()]
    kind = str(rng.choice(list(_KINDS), p=weights))
    return _KINDS[kind][1](stage, rng)


# -- what is attached -----------------------------------------------------------------------


def draw_motion(travel: float, fastest: float, rng: Generator) -> Experiment:
    """Draw a motion of seconds by a travel [m] and a highest frequency [Hz]."""
    builder = Builder(Stage(0.0, 0.0, travel))
    _MOTIONS[int(rng.integers(len(_MOTIONS)))](builder, travel, fastest, rng)
    builder.wait(0.5)
    return builder.experiment('specimen')


def _swings(builder: Builder, travel: float, fastest: float, rng: Generator) -> None:
    """Add cycles of growing and shrinking amplitude about a mean depth."""
    builder.wait(0.5)
    builder.go(0.5 * travel, 1.0)
    frequency = fastest * log_uniform(rng, 0.15, 0.6)
    for level in rng.permutation([0.15, 0.3, 0.45]).tolist():
        cycles = int(rng.integers(3, 7))
        builder.hold(max(1.5, cycles / frequency), Sine(level * travel, 2.0 * pi * frequency))
    builder.go(0.0, 1.0)


def _random(builder: Builder, travel: float, fastest: float, rng: Generator) -> None:
    """Add multisines about two mean depths."""
    for mean in rng.permutation([0.4, 0.65]).tolist():
        builder.wait(0.5)
        builder.go(mean * travel, float(rng.uniform(0.8, 2.0)))
        count = int(rng.integers(3, 8))
        omegas = (2.0 * pi * fastest * rng.uniform(0.05, 1.0, count)).tolist()
        builder.hold(float(rng.uniform(3.0, 7.0)), Multisine(0.34 * travel, omegas))
        builder.go(0.0, float(rng.uniform(0.8, 2.0)))


def _steps(builder: Builder, travel: float, fastest: float, rng: Generator) -> None:
    """Add ramps of different speed with holds between them."""
    builder.wait(0.5)
    for level in rng.permutation([0.3, 0.6, 1.0, 0.45, 0.0, 0.8]).tolist():
        builder.go(level * travel, float(rng.choice([0.4, 0.8, 1.5])))
        builder.wait(float(rng.uniform(0.8, 2.0)))
    builder.go(0.0, 1.0)


_MOTIONS = (_swings, _random, _steps)


def draw_waits(travel: float, ramp: float, rng: Generator) -> Experiment:
    """Draw ramps of the same duration [s] with long waits between them."""
    builder = Builder(Stage(0.0, 0.0, travel))
    builder.wait(5.0)
    levels = rng.permutation([0.35, 0.7, 1.0, 0.5]).tolist()
    for level in levels[:int(rng.integers(3, 5))]:
        builder.go(level * travel, ramp)
        builder.wait(float(rng.uniform(20.0, 60.0)))
    builder.go(0.0, ramp)
    builder.wait(20.0)
    return builder.experiment('slow')


def draw_to_and_fro(travel: float, frequency: float, rng: Generator) -> Experiment:
    """Draw strokes at about a frequency [Hz]."""
    builder = Builder(Stage(0.0, 0.0, travel))
    for level in rng.permutation([0.5, 1.0, 0.3, 0.8]).tolist():
        builder.wait(float(rng.uniform(0.2, 0.6)))
        builder.go(level * travel, float(rng.uniform(0.3, 1.0)) / frequency)
        if rng.uniform() < 0.5:
            omegas = (2.0 * pi * frequency * rng.uniform(0.3, 2.0, 4)).tolist()
            builder.hold(float(rng.uniform(1.5, 3.0)), Multisine(0.2 * travel, omegas))
        builder.go(0.0, float(rng.uniform(0.3, 1.0)) / frequency)
    builder.wait(0.4)
    return builder.experiment('drive')
