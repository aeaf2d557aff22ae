# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The reference that accompanies each sample, from the planner's setpoints and the estimate."""

from bisect import bisect_left, insort
from collections import Counter, deque
from math import inf, isfinite, isnan, nan

from .parameters import add_robot_compliance, EstimationParameters, include_joint_compliance
from ..estimators.estimate import Estimate, EstimateStatus
from ..reference.reference_generator import ReferenceGenerator
from ..reference.setpoints import Desired, Reference
from ..signals.contact_sample import ContactSample
from ..signals.stamp_screen import BEFORE_ANY

_MAX_SETPOINTS = 100_000  # that no sample has reached yet; older ones are dropped beyond
_FREE = EstimateStatus.FREE  # an enumeration takes long to look up
_WINDOW = 40  # instants: 80 ms at 500 Hz
_FALSE = 4  # of them whose spacing may be false, a tenth


class ExperiencedTime:
    """
    The time in which the robot can move between references, whatever their stamps say.

    The references of the samples that one message completes form a group: the robot gets them at
    one instant, as it does further groups until wrench and joints have both advanced. From one
    such instant to the next at most the advance of the wrench stamps or of the joint stamps has
    passed, whichever is less, and a false stamp may exaggerate both. So an instant counts as one
    period at most: the nominal one of the samples if a tenth of the last advances are longer and a
    tenth shorter, else that decile of them. Streams slower or faster than the nominal rate, or in
    bursts, then need no parameter, and up to a tenth of false stamps do not lengthen the period.
    Since every instant takes messages, stamps can make x_r slower, but not faster than its limit.

    nominal_s: nominal time between samples [s]
    period_s: most that the groups of an instant may take [s]
    """

    def __init__(self, nominal_s: float) -> None:
        self.nominal_s = self.period_s = nominal_s
        self._newest: tuple[int, int] | None = None  # of the last group
        self._begin = 0, 0  # of the first group of its instant
        self._rest_s = 0.0
        self._spacings: deque[float] = deque()
        self._sorted: list[float] = []

    def change_clock(self) -> None:
        """Expect stamps of another clock; a period has surely passed until its first group."""
        self._newest = None

    def arrive(self, newest: tuple[int, int]) -> None:
        """
        Begin a group of references.

        newest: last stamps of both topics [ns]
        """
        before, self._newest, begin = self._newest, newest, self._begin
        if before is None:
            self._rest_s, self._begin = self.period_s, newest
            return
        if newest[0] <= before[0] or newest[1] <= before[1]:
            return  # still the same instant
        self._begin = newest
        wrench, joints = newest[0] - begin[0], newest[1] - begin[1]
        passed = (wrench if wrench < joints else joints) * 1e-9
        if passed < 0.0:  # the clock of the joints was set back
            passed = 0.0
        spacings, ordered = self._spacings, self._sorted
        insort(ordered, passed)
        spacings.append(passed)
        longest, least = ordered[-1], 0.0  # before the window is full, it can only shorten
        if len(spacings) > _WINDOW:
            del ordered[bisect_left(ordered, spacings.popleft())]
            longest, least = ordered[-1 - _FALSE], ordered[_FALSE]
        period = self.nominal_s
        if period < least:
            period = least
        self.period_s = period = period if period < longest else longest
        self._rest_s = passed if passed < period else period

    def take(self, elapsed_s: float) -> float:
        """
        Return for how long a reference of the group may move.

        elapsed_s: time since the reference before, by their stamps [s]
        """
        rest = self._rest_s
        taken = 0.0 if not elapsed_s > 0.0 else elapsed_s if elapsed_s < rest else rest
        self._rest_s = rest - taken
        return taken


class ReferenceStream:
    """
    Compute one reference per sample from the setpoints.

    The first one is the position of the robot. From there x_r never steps: clock jumps, resets,
    changes of parameters and estimates without a number do not set it anew, and stamps move it by
    no more than the time that the robot surely experiences, see `ExperiencedTime`. A robot that
    is found more than `reference.limits.lead` away from x_r after its clock was set back has been
    moved by others: x_r then returns to it at `reference.maximum_velocity` and rests there until
    the planner or a force law asks for something else.

    arrive: begins the samples that one message completes, whose references the robot gets together
    """

    def __init__(self, parameters: EstimationParameters, rejected: Counter[str]) -> None:
        self._rejected = rejected
        self._generator = ReferenceGenerator(parameters.reference_law, parameters.reference)
        self._time = ExperiencedTime(1.0 / parameters.sample_rate)
        self.arrive = self._time.arrive
        self._reference: Reference | None = None
        self._configured = self._location = nan  # x_e as configured, and as the limit knows it
        self._setpoints: deque[tuple[int, Desired]] = deque(maxlen=_MAX_SETPOINTS)
        self._default_force = parameters.force_reference
        # Where x_r rests without a setpoint, and the setpoint in force.
        self._resting = self._wanted = Desired(nan, 0.0, 0.0, self._default_force)
        self.configure(parameters)
        self.change_clock()

    def configure(self, parameters: EstimationParameters) -> None:
        """Set new parameters while running; x_r stays continuous."""
        self._generator.configure(
            parameters.reference_law, parameters.reference, 1.0 / parameters.sample_rate
        )
        self._time.nominal_s = 1.0 / parameters.sample_rate
        self._lead = parameters.reference.limits.lead
        self._maximum_depth = parameters.reference.maximum_depth
        configured = parameters.environment.location
        if not (isnan(configured) and isnan(self._configured)):  # else x_e stays as taken
            self._location = configured
        self._configured, self._takes_location = configured, isnan(configured)
        self._deepest = self._location + self._maximum_depth
        self._timeout_s = parameters.synchronisation.timeout_s
        default = parameters.force_reference
        if repr(default) != repr(self._default_force):  # NaN is not equal to itself
            self._default_force, self._resting = default, self._resting._replace(force=default)
        self._robot = include_joint_compliance(parameters.robot, parameters.physics)
        self.period_ns = round(1e9 / parameters.sample_rate)

    def change_clock(self) -> None:
        """
        Expect the next sample on another clock, as after a backward jump; x_r goes on.

        The setpoint in force remains until the planner has another one on that clock.
        """
        self._start_ns = self._last_ns = BEFORE_ANY
        self._resting = self._wanted._replace(velocity=0.0, acceleration=0.0)
        self._time.change_clock()

    def reset(self) -> None:
        """Forget where the surface was found, of which the reach depends; x_r goes on."""
        if self._takes_location:
            self._location = self._deepest = nan

    def add(self, stamp_ns: int, desired: Desired) -> None:
        """
        Add a setpoint of the planner.

        stamp_ns: instant from which it holds [ns]
        desired: position with derivatives and force. A position that is not finite is rejected; a
        force <= 0 counts as none, derivatives that are not finite as 0.
        """
        if not isfinite(desired.position):
            self._rejected['desired_not_finite'] += 1
            return
        force = desired.force
        if not 0.0 < force < inf:
            if force == force and force != 0.0:  # NaN and 0 mean that no force is desired
                self._rejected['desired_force_not_positive'] += 1
            force = nan
        v, a = (rate if isfinite(rate) else 0.0 for rate in desired[1:3])
        if self._setpoints and stamp_ns < self._setpoints[-1][0]:
            self._setpoints.clear()  # the clock jumped back, or the planner has replanned
        self._setpoints.append((stamp_ns, Desired(desired.position, v, a, force)))

    def step(self, sample: ContactSample, estimate: Estimate) -> Reference:
        """Compute the reference for one sample period after a sample."""
        stamp_ns, position, _, _ = sample
        period_ns, last_ns, self._last_ns = self.period_ns, self._last_ns, stamp_ns
        if last_ns == BEFORE_ANY:
            elapsed, self._start_ns = inf, stamp_ns
            self._begin(position)
        else:
            elapsed = (stamp_ns - last_ns) * 1e-9
        target_ns = stamp_ns + period_ns
        self._wanted = desired = (
            self._setpoint_at(target_ns) if self._setpoints else self._resting)
        _, K_hat, _, _, _, location, _, status, _, _ = estimate
        contact, deepest = status is not _FREE, self._deepest
        if self._takes_location:  # no force law without x_e
            contact = contact and isfinite(location)
            if isnan(self._location) and isfinite(location):
                self._location, deepest = location, location + self._maximum_depth
                self._deepest = deepest
        self._reference = self._generator.step(
            (target_ns - self._start_ns) * 1e-9, self._time.take(elapsed), desired, contact,
            location,
            add_robot_compliance(K_hat, self._robot) if self._robot.compliance else K_hat,
            deepest,
        )
        return self._reference

    def _begin(self, position: float) -> None:
        """Start at the robot; on another clock, go on from the last reference."""
        if self._reference is None:
            self._generator.start(position)
        elif abs(position - self._reference[0]) <= self._lead:
            return
        self._resting = Desired(position, 0.0, 0.0, self._default_force)

    @property
    def limited(self) -> bool:
        """Whether a limit keeps the last reference away from what it should be."""
        return self._generator.limited

    def _setpoint_at(self, stamp_ns: int) -> Desired:
        """
        Return the newest setpoint at an instant; before any, the position of the first sample.

        A setpoint older than the timeout is a position to rest at: its rates no longer apply.
        """
        setpoints = self._setpoints
        while len(setpoints) > 1 and setpoints[1][0] <= stamp_ns:
            setpoints.popleft()  # superseded; by stamps, so that a latency never loses one
        if setpoints and setpoints[0][0] <= stamp_ns:
            stamp, desired = setpoints[0]
            if (stamp_ns - stamp) * 1e-9 <= self._timeout_s:
                return desired
            return Desired(desired.position, 0.0, 0.0, desired.force)
        return self._resting
