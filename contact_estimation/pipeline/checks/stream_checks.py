# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Checks of streams and joint states: sources, stamps, rates, a zero that steps, units."""

from typing import Mapping, Sequence

import numpy as np

from .check import Check, Window
from ...signals.stream_faults import Bursts, CLEAR, Courses, courses_of, zero_steps, ZeroStep


_COARSEST_M = 1e-4  # resolution of a robot's encoder: noise toggles between two neighbours
_KEPT = 400  # samples of free flight before the present window
_RATE_OFF = 0.1


class TwoForces(Check):
    """All wrenches come from one sensor."""

    name = 'two_forces'
    message = Courses(-46.0, 0.0).text('force', 'wrench', 'N')
    cause = ('Two publishers on the topic, a recording that is played while the sensor is live, '
             'or a driver that publishes zeros between its measurements.')
    remedy = 'Stop or remap the other publisher, or repair the driver.'
    invalidates = True

    def judge(self, seen: Window) -> str | None:
        """Look for two signals in the force."""
        found = courses_of(seen.force, CLEAR * seen.configured_noise)
        return found.text('force', 'wrench', 'N') if found else ''


class TwoPositions(Check):
    """All positions of the joint come from one driver."""

    name = 'two_positions'
    message = Courses(0.0051, 0.0).text('position', 'joint_states', 'm')
    cause = 'Two publishers of the joint, or a driver that publishes zeros in between.'
    remedy = TwoForces.remedy
    invalidates = True

    def judge(self, seen: Window) -> str | None:
        """Look for two signals in the position."""
        least = max(CLEAR * seen.parameters.contact.position_noise, _COARSEST_M)
        found = courses_of(seen.x, least)
        return found.text('position', 'joint_states', 'm') if found else ''


class StampBursts(Check):
    """Stamps of the wrench come one by one."""

    name = 'stamp_bursts'
    message = Bursts(5.0, 0.01).text
    cause = ('The driver stamps on arrival, and a latency timer (USB: 16 ms) or a network hands '
             'over several measurements at once; damping is then wrong.')
    remedy = ('Let the driver stamp by the clock or the counter of the sensor; shorten the '
              'latency timer.')
    invalidates = True

    def judge(self, seen: Window) -> str | None:
        """Look at the stamps of all wrenches."""
        return seen.bursts.text if seen.bursts else ''


class ZeroSteps(Check):
    """The zero of the force sensor stays."""

    name = 'zero_step'
    message = ('the zero of the force sensor stepped by -2 N between 4.8 and 4.94 s; call ~/tare '
               'in free flight, and let nothing zero the sensor while the node runs')
    cause = 'The driver zeroes the sensor, or the sensor was overloaded or has slipped.'
    remedy = ('Call `~/tare` out of contact; zero the sensor before the node starts, and not '
              'afterwards; of a sensor that drifts, `force_sensor.zero: tracked`.')

    def judge(self, seen: Window) -> str | None:
        """Compare the levels of free flight; a step is told until a tare."""
        steps = self._noted(seen)
        bias, told = seen.memory.get('zero_steps', (seen.bias, []))
        if bias != seen.bias:
            bias, told = seen.bias, []
            steps = []
        known = [(one.begin, one.end) for one in told]
        told = told + [one for one in steps
                       if all(one.begin > end or one.end < begin for begin, end in known)]
        seen.memory['zero_steps'] = bias, told
        if not told:
            return ''
        times = ' and '.join(
            f'by {one.size:+.2g} N {_when(one, seen.period)}' for one in told[-3:])
        return (f'the zero of the force sensor stepped {times}; call ~/tare in free flight, and '
                'let nothing zero the sensor while the node runs')

    @staticmethod
    def _noted(seen: Window) -> list[ZeroStep]:
        """Add the samples of free flight to those before, and return the steps in them."""
        free = seen.free | (seen.x < seen.location - seen.state.margin)
        t, force = seen.start_s + seen.t[free], seen.force[free]
        bias, before_t, before = seen.memory.get('free_flight', (seen.bias, t[:0], force[:0]))
        old = before_t < (t[0] if len(t) else np.inf)
        if bias == seen.bias:
            t, force = np.append(before_t[old], t), np.append(before[old], force)
        until = int(np.searchsorted(t, seen.start_s + 0.25 * (seen.end_s - seen.start_s)))
        first = max(until - _KEPT, 0)
        seen.memory['free_flight'] = seen.bias, t[first:], force[first:]
        return zero_steps(t, force, seen.configured_noise, not seen.may_be_weight)


def _when(step: ZeroStep, period: float) -> str:
    if step.end - step.begin < 2.5 * period:
        return f'at {step.end:.3f} s'
    return f'between {step.begin:.2f} and {step.end:.2f} s'


class SampleRate(Check):
    """Samples come at `sample_rate`."""

    name = 'sample_rate'
    message = 'samples come at 1000 Hz, but sample_rate is 500; correct it'
    cause = '`sample_rate` is not the rate of the wrench, or samples are lost.'
    remedy = ('Set `sample_rate`: filters and relations are built for it. Where the sensor does '
              'send at this rate, find what drops samples: a machine or network that is too slow.')
    of_state = True

    def judge(self, seen: Window) -> str:
        """Compare the spacing of the stamps with the nominal one."""
        rate, period = seen.parameters.sample_rate, seen.state.period_s
        if (period <= 0.0 or abs(period * rate - 1.0) < _RATE_OFF
                or not seen.state.has_rows):  # it measures the rate
            return ''
        dropped = ', or find why samples are dropped' if period * rate > 1.0 else ''
        return (f'samples come at {1.0 / period:.4g} Hz, but sample_rate is {rate:g}; correct '
                f'it{dropped}')


def graph_warnings(
    publishers: Mapping[str, Sequence[str]], node: str, nodes: Sequence[str]
) -> dict[str, str]:
    """
    Return what the graph of ROS shows, texts by name, the most important first.

    Of publishers, the nodes of each topic that needs exactly one; of nodes, all full names, one as
    often as there are nodes of it.
    """
    found = {}
    for topic, names in publishers.items():
        if len(names) > 1:
            found[f'several_publishers_{topic.rsplit("/", 1)[-1]}'] = (
                f'{len(names)} publishers on the topic {topic} ({", ".join(sorted(names))}): '
                'their samples mix; stop or remap all but one')
    same = sum(name == node for name in nodes)
    if same > 1:
        found['node_name'] = (
            f'{same} nodes are called {node}: their outputs mix, and services and parameters '
            'reach any of them; start the others as -r __node:=NAME, or stop them')
    return found


_FASTEST = 10.0  # of any arm [m/s]
_DEEPEST = 0.5  # of any contact [m]
_STEP_S, _STEP = 0.02, 10  # at least, over which positions and velocities are compared; samples
# Steps over those of a tenth of the time: 10 of a motion, 3.2 of a random walk, 1 of white noise.
_MOVES = 5.0
_FACTOR = 2.0  # between measured velocities and those of the positions
_SURE = 3.0  # standard deviations of that factor
_BEYOND = 0.5  # of the range of a joint, beyond its limits: the controller would stop it earlier


class JointStill(Check):
    """The joint of the contact axis moves."""

    name = 'joint_still'
    message = ("position of joint 'gripper' has not changed since the start while the force "
               'changed by 20 N; set joint to that of the contact axis')
    cause = 'Another joint was chosen, or its driver repeats one position.'
    remedy = 'Set `joint` and start again, or repair the driver; for an arm, see `kinematics.*`.'
    invalidates = True

    def judge(self, seen: Window) -> str | None:
        """Compare the travel since the start with the change of the force."""
        if seen.travel > 0.0:
            return ''
        if seen.spread < CLEAR * seen.noise:
            return None
        if seen.is_arm:
            which, remedy = 'the tip of the arm', ('check that joint_states come from the driver, '
                                                   'and kinematics.base and kinematics.tip')
        else:
            joint = seen.parameters.joints[seen.axis]
            which = f'joint {joint!r}' if joint else 'the joint'
            remedy = 'set joint to that of the contact axis'
        return (f'position of {which} has not changed since the start while the force changed by '
                f'{seen.spread:.3g} N; {remedy}')


class JointUnits(Check):
    """Joints of an arm turn within the limits of its description."""

    name = 'joint_units'
    message = ("joint 'elbow' is at 97 rad, where the robot description allows -3.1 to 3.1 rad: "
               'are these degrees? Publish joint states in radians')
    cause = 'The driver publishes degrees, or names the joints in another order.'
    remedy = 'Publish positions in radians and velocities in radians per second.'
    invalidates = True
    confirmations = 3

    def judge(self, seen: Window) -> str | None:
        """Compare the present positions with the limits."""
        for place, (name, low, high) in seen.limits.items():
            if place >= len(seen.joints):
                return None
            q, slack = seen.joints[place], _BEYOND * (high - low)
            if not low - slack <= q <= high + slack:
                return (f'joint {name!r} is at {q:.3g} rad, where the robot description allows '
                        f'{low:.3g} to {high:.3g} rad: are these degrees? Publish joint states in '
                        'radians')
        return ''


class PositionUnit(Check):
    """Positions are in metres."""

    name = 'position_unit'
    message = ('the contact axis moves at up to 80 m/s, 12 m into the wall: no robot does; '
               'publish positions in metres')
    cause = 'Positions come in millimetres, or a revolute joint is taken for the contact axis.'
    remedy = ('Publish positions in metres and velocities in metres per second, of an arm in '
              'radians; for an arm set `kinematics.*` and `contact.normal`.')
    invalidates = True

    def judge(self, seen: Window) -> str | None:
        """Compare speed and penetration with those of any robot."""
        x, t = seen.x, seen.t
        if len(x) < 3:
            return None
        speeds = np.abs(x[2:] - x[:-2]) / np.maximum(t[2:] - t[:-2], 0.1 * seen.period)
        fast = int(0.95 * len(speeds))
        speed = float(np.partition(speeds, fast)[fast])
        depth = float(np.max(seen.x[seen.contact] - seen.location, initial=0.0))
        if not (speed > _FASTEST or depth > _DEEPEST and not seen.state.surface_text):
            return ''
        unit = 'joint states in radians' if seen.is_arm else 'positions in metres'
        return (f'the contact axis moves at up to {speed:.3g} m/s, {depth:.3g} m into the wall: '
                f'no robot does; publish {unit}')


class JointVelocity(Check):
    """Measured velocities are the rates of the positions."""

    name = 'joint_velocity'
    message = ('velocities of the joint states are 57 times the rate of their positions; publish '
               'them in the units of the positions, or leave them empty')
    cause = 'The driver publishes zeros, other units, or the wrong sign.'
    remedy = ('Repair the driver, or leave `velocity` empty: it is then taken from the '
              'positions.')
    invalidates = True

    def judge(self, seen: Window) -> str | None:
        """Compare what velocities add up to with the steps of the positions."""
        if not np.isfinite(seen.v).all() or not seen.joint_rate > 0.0 or seen.bursts:
            return None
        t, x, v, short = seen.t, seen.x, seen.v, seen.stride
        count = max(_STEP * short, round(min(_STEP_S / seen.period, float(len(t)))))
        if len(x) < 2 * count:
            return None
        path = np.append(0.0, np.cumsum(0.5 * (v[1:] + v[:-1]) * np.diff(t)))
        whole = t[count:] - t[:-count] < 2.0 * count * seen.period  # no gap between samples
        steps, added = ((one[count:] - one[:-count])[whole] for one in (x, path))
        power = float(steps @ steps)
        at_once = float(np.mean(np.square(x[short:] - x[:-short])))
        if not power > _MOVES**2 * at_once * len(steps) or not power > 0.0:
            return None
        factor = float(steps @ added) / power
        rest = added - factor * steps
        std = (count * float(rest @ rest) / len(steps) / power)**0.5  # steps overlap
        if 1.0 / _FACTOR < factor < _FACTOR:
            return ''
        if not (factor - _SURE * std > _FACTOR or factor + _SURE * std < 1.0 / _FACTOR):
            return None
        return (f'velocities of the joint states are {factor:.2g} times the rate of their '
                'positions; publish them in the units of the positions, or leave them empty')
