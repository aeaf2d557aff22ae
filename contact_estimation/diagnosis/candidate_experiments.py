# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Candidates for the next experiment, all within the reach of the recordings."""

from typing import NamedTuple, Sequence

from ..reference.experiment import Experiment, Segment

_PEAK = 1.875  # greatest over mean speed of a quintic
_REST_S = 0.6  # in free flight, where the noise is measured, and after a swing
_SWUNG_S = 3.0
_TOUCHES = 3  # so that one can be held out


class Reach(NamedTuple):
    """The reach of the recordings."""

    # location, gap: surface of the wall, and greatest distance of the tool before it [m]
    location: float
    gap: float
    depth: float  # penetration [m]
    gain: float  # x_d beyond the surface per penetration at rest: 1 + K_e / K_t
    # speed, touch_down_speed: greatest, and typical at touch-down [m/s]
    speed: float
    touch_down_speed: float

    @property
    def start(self) -> float:
        """Start of a touch [m]: a quarter of the stroke before the wall, within reach."""
        return self.location - max(0.25 * self.depth, min(self.gap, 0.25 * self.gain * self.depth))

    def position(self, depth: float) -> float:
        """Return the x_d [m] that presses to a depth [m]."""
        return self.location + self.gain * depth

    def duration(self, depth: float, speed: float) -> float:
        """Return the duration [s] of a quintic to a depth [m] within a speed [m/s]."""
        return _PEAK * (self.position(depth) - self.start) / speed


class Candidate(NamedTuple):
    """An experiment that could come next."""

    words: str  # what to do, as an imperative within a sentence
    experiment: Experiment  # one touch

    def repeated(self) -> Experiment:
        """Return several touches, so that one can be held out."""
        once = self.experiment
        return Experiment(once.name, once.start, once.segments * _TOUCHES)


def candidates(reach: Reach) -> list[Candidate]:
    """List the candidates."""
    made = [
        press(reach, share, pace, dwell)
        for share, pace, dwell in (
            (1.0, 1.0, 1.0), (1.0, 0.3, 8.0), (0.4, 1.0, 1.0), (0.4, 0.1, 1.0))]
    made += [swing(reach, (frequency,), 0.6, 0.35) for frequency in (1.0, 5.0, 12.0)]
    made += [swing(reach, (2.0,), 0.35, 0.6), swing(reach, (1.0, 2.0, 4.0, 8.0, 14.0), 0.6, 0.35)]
    return made


def press(reach: Reach, share: float, pace: float, dwell: float) -> Candidate:
    """Press, hold, withdraw."""
    depth, speed = share * reach.depth, pace * reach.speed
    words = (f'press {1e3 * depth:.2g} mm deep at up to {speed:.2g} m/s and hold for '
             f'{dwell:g} s')
    return Candidate(words, _touch(reach, 'press', depth, speed, [_hold(reach, depth, dwell)]))


def _hold(reach: Reach, depth: float, dwell: float) -> Segment:
    return Segment(dwell, reach.position(depth))


def swing(reach: Reach, frequencies: Sequence[float], share: float, width: float) -> Candidate:
    """Swing about a depth, back and forth by quintics: a sine would begin with a jerk."""
    depth, swings, widest = share * reach.depth, [], 0.0
    into = 0.5 / frequencies[0]  # time to the next swing, which may be narrower
    for frequency in frequencies:
        half = 0.5 / frequency
        amplitude = min(width * reach.depth, 0.5 * half * reach.speed / _PEAK)
        widest = max(widest, amplitude)
        count = 2 * max(2, round(frequency * _SWUNG_S / len(frequencies)))
        ends = [reach.position(depth + amplitude * (-1.0) ** k) for k in range(count)]
        swings += [Segment(into, ends[0]), *(Segment(half, end) for end in ends[1:])]
        into = half
    at = ' to '.join(f'{f:g}' for f in dict.fromkeys((frequencies[0], frequencies[-1])))
    words = (f'press {1e3 * depth:.2g} mm deep and swing x_d about there by up to '
             f'{1e3 * reach.gain * widest:.2g} mm at {at} Hz')
    return Candidate(words, _touch(reach, 'swing', depth, 0.3 * reach.speed, swings))


def _touch(
    reach: Reach, name: str, depth: float, speed: float, held: Sequence[Segment]
) -> Experiment:
    """Approach, execute the segments at depth, withdraw; x_d never jumps."""
    travel, deep = reach.duration(depth, speed), reach.position(depth)
    last = held[-1].position
    back = [Segment(_REST_S, deep)] if last != deep else []
    return Experiment(name, reach.start, (
        Segment(_REST_S, reach.start),
        Segment(travel, deep),
        *held,
        *back,
        Segment(travel, reach.start),
        Segment(_REST_S, reach.start)))


def scaling_test(reach: Reach) -> Candidate:
    """Touch at two depths and two speeds, to find what the unknown physics scale with."""
    depths = (reach.depth, 0.5 * reach.depth)
    speeds = (0.5 * reach.touch_down_speed, 2.0 * reach.touch_down_speed)
    words = (
        f'Press {1e3 * depths[0]:.2g} and {1e3 * depths[1]:.2g} mm deep, each at up to '
        f'{speeds[0]:.2g} and {speeds[1]:.2g} m/s (half and twice the speed of the present '
        'touch-downs): residuals that grow with depth point to the spring, with speed to damping '
        'or sensor timing, with neither to friction or an offset.')
    touches = [_touch(reach, '', depth, speed, [_hold(reach, depth, 1.0)]).segments
               for depth in depths for speed in speeds]
    segments = tuple(segment for touch in touches for segment in touch)
    return Candidate(words, Experiment('two depths at two speeds', reach.start, segments))
