# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""An ideal robot at a wall, under a session that gets false stamps, calls and parameters."""

from math import nan
from typing import Any, NamedTuple

from contact_estimation.exceptions import ContactEstimationError
from contact_estimation.parameters import build
from contact_estimation.pipeline.events import set_location
from contact_estimation.pipeline.parameters import EstimationParameters
from contact_estimation.pipeline.session import ContactSession
from contact_estimation.reference.setpoints import Desired, Reference
import numpy as np

T, PERIOD_NS = 0.002, 2_000_000
K_E, B_E = 4800.0, 200.0
BOTH = 'joint wrench'
TOPICS = (BOTH, 'joint', 'wrench')
CHANGES: dict[str, tuple[Any, ...]] = {
    'reference_law': ('eq20', 'series', 'pass_through'),
    'reference.maximum_velocity': (0.02, 0.1, 0.25, 1.0),
    'reference.maximum_depth': (nan, 0.0, 0.003, 0.02),
    'reference.fade_s': (1e-3, 0.2), 'reference.stiffness_floor': (1e-3, 500.0, 1e5),
    'reference.robot_stiffness': (1.0, 5000.0), 'reference.robot_force_tracking': (False, True),
    'force_reference': (nan, 5.0, 30.0, 1e4), 'environment.location': (0.0, -0.01, 0.01, nan),
    'estimator': ('multiple_model', 'kalman', 'rls', 'rls_adaptive', 'mrac'),
    'robot.compliance': (0.0, 1e-4),
    'synchronisation.time_jump_s': (0.05, 0.5, 10.0), 'synchronisation.offset': (0.0, 0.004),
}


class Event(NamedTuple):
    """What happens at one instant: a kind, its value, and the topics concerned."""

    kind: str
    value: Any = None
    topics: str = BOTH


class HostileLoop:
    """A robot that is where x_r wants it, and a wall of K_E and B_E at 0."""

    def __init__(self, seed: int = 0) -> None:
        self.session = ContactSession(build(EstimationParameters, {
            'reference.maximum_depth': 0.02, 'force_reference': 30.0}))
        self.violations: list[str] = []  # of rate and reach, over the true time of the robot
        self._random = np.random.default_rng(seed)
        self._k, self._clock_ns = 0, 1_795_300_000 * 10**9
        self._x_r: Reference = Reference(-0.002, 0.0, 0.0)
        self._started = False
        self._waiting: list[Any] = []  # messages that are withheld
        self._withheld = 0

        self._add_desired(Desired(0.01, 0.0, 0.0, 30.0))
        self.run([Event('plain')] * 60)  # touches the wall

    @property
    def now_ns(self) -> int:
        """Return the true stamp of the last instant."""
        return self._clock_ns + self._k * PERIOD_NS

    def run(self, events: list[Event]) -> list[str]:
        """Let all events happen; return the violations so far."""
        for event in events:
            self._instant(event)
        return self.violations

    def _instant(self, event: Event) -> None:
        self._k += 1
        self._serve(event)
        self._waiting.append(self._messages(event))
        if self._withheld > 0:
            self._withheld -= 1
            return
        count, newest = len(self._waiting), None
        for kind, stamp_ns, values in (m for instant in self._waiting for m in instant):
            add = self.session.add_motion if kind == 'joint' else self.session.add_wrench
            for result in add(stamp_ns, *values):
                newest = result.reference
        self._waiting = []
        if newest is not None:
            self._check(newest, count)
            self._x_r, self._started = newest, True

    def _messages(self, event: Event) -> list[tuple[str, Any, tuple[float, ...]]]:
        kind, value, topics = event
        x, v = self._x_r[:2]
        force = min(0.0, -(K_E * x + B_E * v)) if x > 0.0 else 0.0
        force += float(self._random.normal(0.0, 0.3))
        messages: list[tuple[str, Any, tuple[float, ...]]] = []
        for topic, values in (('joint', (x, v)), ('wrench', (force,))):
            stamp_ns: Any = self.now_ns
            if topic in topics:
                if kind == 'drop':
                    continue
                if kind == 'stamp':
                    stamp_ns = value
                elif kind == 'shift':
                    stamp_ns += round(value * 1e9)
            messages += [(topic, stamp_ns, values)] * (2 if kind == 'twice' else 1)
        return messages[::-1] if self._random.random() < 0.1 else messages

    def _serve(self, event: Event) -> None:
        kind, value, _ = event
        session = self.session
        if kind == 'clock':
            self._clock_ns += round(value * 1e9)
        elif kind == 'withhold':
            self._withheld = value
        elif kind == 'desired':
            self._add_desired(value)
        elif kind in ('reset', 'tare'):
            getattr(session, kind)()
        elif kind == 'set_location':
            session.change_parameters(set_location(session)[2])
        elif kind == 'change':
            try:
                session.change_parameters(dict([value]))
            except ContactEstimationError:
                pass  # series together with force tracking

    def _add_desired(self, desired: Desired) -> None:
        self.session.add_desired(self.now_ns, desired)

    def _check(self, now: Reference, instants: int) -> None:
        """Check what the robot follows from one instant to the next, and on until a third."""
        p, last = self.session.parameters, self._x_r
        speed = p.reference.maximum_velocity * (1.0 + 1e-9) + 1e-12
        deepest = max(p.environment.location + p.reference.maximum_depth, last.position)
        rate = abs(now.position - last.position) / (instants * T) if self._started else 0.0
        rates = max(abs(now.velocity), abs(now.velocity + T * now.acceleration))
        end = now.position + T * (now.velocity + 0.5 * T * now.acceleration)
        for what, value, limit in (
                ('rate', rate, speed), ('velocity', rates, speed),
                ('reach', now.position, deepest + 1e-12),
                ('end of parabola', end, max(deepest, now.position) + 1e-12)):
            if not value <= limit and limit == limit:
                self.violations.append(f'{what} {value:.3g} at {self._k}, limit {limit:.3g}')
